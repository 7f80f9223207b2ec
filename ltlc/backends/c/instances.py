"""A property that is judged from each message on, in C: an array of monitors, one for each message that is open."""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.backends.c.code import lines
from ltlc.backends.c.monitors import PropertyWriter
from ltlc.backends.c.signals import Named
from ltlc.backends.statements import Do, conjunction, disjunction
from ltlc.backends.trees import INDENT, Call, Chain, Code, Text
from ltlc.dataclass import dataclass
from ltlc.program.types import Scalar
from ltlc.specification.specification import Instances, topics_of

_NAMES = """
instance instances instances_advance instances_begin instances_init instances_next_deadline instances_step
instances_verdict size violation
"""


@dataclass(frozen=True)
class OpenTable:
    """The instances that messages open, at most as many as `of` allows, each with the monitors of one property."""

    of: Instances
    writer: PropertyWriter

    stem = "instances"
    """What the names of its functions begin with, after the prefix."""
    names = _NAMES.split()
    """What is declared for it, after the prefix."""
    is_shared = True
    """Whether something may come that all get."""

    @property
    def limit(self) -> int:
        """How many are open at most."""
        assert self.of.limit is not None
        return self.of.limit

    @property
    def news(self) -> list[Text]:
        """The samples have a message that opens one where one of these holds."""
        return self.writer.signals.given.news(topics_of(self.of.signal))

    def text(self) -> list[str]:
        """All that is particular of it, in C."""
        return [str(self.limit), *(code.text for code in self.news), *self._alike(), *self._changed()]

    def source(self) -> dict[str, object]:
        """What its functions are made of."""
        return {
            "name": self.writer.name,
            "mark": self.writer.signals.heard[self.of.mark.name].name,
            "opening": " || ".join(code.text for code in self.news),
            "alike": self._alike(),
            "kept": [f"{INDENT * 2}const {declared};" for declared in self._kept()],
            "changed": self._changed(),
        }

    def _alike(self) -> list[str]:
        """Whether two have the same clocks, as few have, and the same state and values at openings."""
        found = [compared(f"one->{due}", "==", f"other->{due}") for due in self.writer.dues]
        found.append(compared("one->state", "==", "other->state"))
        for named in self._openings:
            one, other = f"one->{named.text}", f"other->{named.text}"
            if named.type.scalar is Scalar.TEXT and not named.type.is_array:
                found.append(Call("same_text", (Text(one), Text(other))))
            else:
                found += _parts(named, one, "==", other)
        return lines([Do("return ", conjunction(found))], INDENT)

    def _kept(self) -> Iterator[str]:
        """What distinguishes instances, as it was before something came."""
        yield from (f"int64_t old_{due} = own->{due}" for due in self.writer.dues)
        yield f"{self.writer.state_type} old_state = own->state"
        for named in self._openings:
            declared = self.writer.helpers.declared(named.type, f"old_{named.text}").removeprefix("const ")
            yield f"{declared} = own->{named.text}"

    def _changed(self) -> list[str]:
        """Whether any of that has changed; a string is the same where it stands in the same place."""
        found: list[Code] = [Text("has_changed")]
        found += [compared(f"old_{due}", "!=", f"own->{due}") for due in self.writer.dues]
        found.append(compared("old_state", "!=", "own->state"))
        for named in self._openings:
            found += _parts(named, f"old_{named.text}", "!=", f"own->{named.text}")
        return lines([Do("has_changed = ", disjunction(found))], INDENT * 2)

    @property
    def _openings(self) -> list[Named]:
        return list(self.writer.openings.values())


def _parts(named: Named, one: str, operator: str, other: str) -> Iterator[Code]:
    """Comparisons of two values; of an array, of where it stands, and its length."""
    for part in (".elements", ".length") if named.type.is_array else ("",):
        yield compared(f"{one}{part}", operator, f"{other}{part}")


def compared(one: str, operator: str, other: str) -> Code:
    """Two that are compared."""
    return Chain((Text(one), Text(other)), (operator,))
