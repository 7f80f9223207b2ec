"""A property that is judged for each id, in C: a table of ids with monitors of their own, without a heap.

What a file has of it, or of instances that messages open, and what is refused of both.
"""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.backends.c.code import lines
from ltlc.backends.c.instances import OpenTable, compared
from ltlc.backends.c.monitors import PropertyWriter
from ltlc.backends.c.types import type_name
from ltlc.backends.spelling import NotInTargetError
from ltlc.backends.statements import Do, conjunction, disjunction
from ltlc.backends.trees import INDENT, Text
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.program.as_new import states_as_new
from ltlc.program.lowering import read
from ltlc.program.types import Scalar, type_of
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import Instances, Slicing, Specification, topics, topics_of

MOST = 1 << 24
"""How many ids a table has places for, at most, and how many instances are open."""

_NAMES = """
ids ids_advance ids_init ids_next_deadline ids_share ids_step ids_verdict left_out_of size slice slice_of
"""


@dataclass(frozen=True)
class Table:
    """The table of at most `limit` ids of type `key`, each with the monitors of one property.

    A slice in one of the states `as_new` is dropped. Samples have messages of a slice where one of `own` holds, and of
    all slices where one of `shared` does.
    """

    limit: int
    key: str
    as_new: tuple[int, ...]
    own: Sequence[Text]
    shared: Sequence[Text]
    writer: PropertyWriter

    stem = "ids"
    """What the names of its functions begin with, after the prefix."""
    names = _NAMES.split()
    """What is declared for it, after the prefix."""

    @property
    def places(self) -> int:
        """How many there are: half of them are free, so that a search ends."""
        return 2 * self.limit

    @property
    def is_shared(self) -> bool:
        """Whether something may come that all ids get."""
        return bool(self.shared)

    def text(self) -> list[str]:
        """All that is particular of it, in C."""
        flags = (code.text for code in (*self.own, *self.shared))
        return [self.key, *map(str, (self.limit, *self.as_new)), *flags]

    def source(self) -> dict[str, object]:
        """What its functions are made of."""
        own, shared = ("".join(f"{code.text} || " for code in of) for of in (self.own, self.shared))
        return {
            "name": self.writer.name,
            "own": own,
            "foreign": shared,
            "as_new": self._as_new() if self.as_new else [],
        }

    def _as_new(self) -> list[str]:
        """Whether the next message does what a first one does: nothing is owed, no clock runs."""
        member, constant = f"monitors->{self.writer.name}", self.writer.helpers.prefix.upper()
        parts = [compared(f"{member}.verdict", "==", f"{constant}_PRESUMABLY_SATISFIED")]
        parts += [compared(f"{member}.due", "==", f"{constant}_NEVER")] if self.writer.clock_step else []
        parts.append(disjunction([compared(f"{member}.state", "==", str(state)) for state in self.as_new]))
        return lines([Do("return ", conjunction(parts))], INDENT)


def names_taken(compiled: Sequence[Compiled]) -> Sequence[str]:
    """What is declared for ids or instances, after the prefix."""
    match compiled[0].specification.slicing if compiled else None:
        case Slicing():
            return Table.names
        case Instances():
            return OpenTable.names
        case None:
            return ()


def table_of(properties: Sequence[PropertyWriter]) -> Table | OpenTable | None:
    """The table of ids or of instances, if the only property has one."""
    match properties[0].specification.slicing if properties else None:
        case Slicing() as slicing:
            return _of_ids(properties[0], slicing)
        case Instances() as instances:
            return OpenTable(instances, properties[0])
        case None:
            return None


def _of_ids(one: PropertyWriter, slicing: Slicing) -> Table:
    assert slicing.limit is not None
    samples = one.signals.given
    return Table(
        slicing.limit,
        type_name(_scalar(slicing.keys)),
        tuple(sorted(states_as_new(one.machine, one.specification, slicing))),
        samples.news(slicing.topics),
        samples.news(shared_topics(one.compiled, slicing)),
        one,
    )


def shared_topics(compiled: Compiled, slicing: Slicing) -> list[str]:
    """The topics whose messages all slices get."""
    return [topic for topic in topics(compiled.specification) if topic not in slicing.topics]


def require_a_table(compiled: Sequence[Compiled], specification: Specification) -> None:
    """Raise NotInTargetError if a property is judged for each id or message, and a table cannot be all it needs."""
    for each in compiled:
        slicing = each.specification.slicing
        if slicing is None:
            continue
        form, what = ("`each`", "ids") if isinstance(slicing, Slicing) else ("`each new`", "messages")
        if slicing.limit is None:
            raise NotInTargetError(
                f"{form} without a limit", instead=f"write `limit N`: memory is reserved for N {what}"
            )
        if slicing.limit > MOST:
            raise NotInTargetError(f"`limit {slicing.limit}`, more than {MOST} {what}")
        if len(compiled) > 1:
            raise NotInTargetError(f"{form} beside other properties: it needs a file of its own")
        if specification.rate is not None or specification.timeout is not None:
            raise NotInTargetError(f"{form} with `_rate_` or `_timeout_`")
        if isinstance(slicing, Slicing):
            _ = _scalar(slicing.keys)
            _require_readable(each, slicing)


def _scalar(keys: Sequence[Signal]) -> Scalar:
    """The type of ids that are integers. Raises NotInTargetError of others."""
    scalars = {type_of(key).scalar for key in keys}
    if other := next((key for key in keys if type_of(key).scalar.bits == 0), None):
        raise NotInTargetError(f"`each` of `{other.name}`, whose ids are not integers")
    if len(scalars) == 1:
        return scalars.pop()
    if Scalar.UINT64 in scalars:
        raise NotInTargetError("`each` of ids that are uint64 and of others of another type")
    return Scalar.INT64


def _require_readable(compiled: Compiled, slicing: Slicing) -> None:
    """Raise NotInTargetError of what a slice knows and no message says, and of a slice that others might begin."""
    inputs = compiled.specification.inputs()
    made = next((i.signal.name for i in inputs if i.signal.name in slicing.made), None)
    if made == slicing.variable:
        raise NotInTargetError(f"`{made}`, an id that is read as a value")
    if made is not None:
        raise NotInTargetError(f"`{made}`")
    shared = shared_topics(compiled, slicing)
    ages = any(clock.age is not None for clock in compiled.machine.clocks)
    waited = (i.signal for i in inputs if read(i) in compiled.machine.waits_for)
    waits = any(not slicing.topics.isdisjoint(topics_of(signal)) for signal in waited)
    if shared and (ages or not waits):
        raise NotInTargetError(
            f"`each` with ages, or that waits for no value with an id, beside {shared[0]}, which has none"
        )
