"""Names in a specification of another tool, and the signals of the language that they become."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import field
from enum import Enum

from ltlc.dataclass import dataclass
from ltlc.frontend.starter import names as starter


class Kind(Enum):
    """What values a name has, by the type of the message that is declared for it."""

    NUMBER = "std_msgs/Float64.data"
    INTEGER = "std_msgs/Int64.data"
    BOOLEAN = "std_msgs/Bool.data"
    STRING = "std_msgs/String.data"
    NUMBERS = "std_msgs/Float64MultiArray.data"
    UNKNOWN = ""


PREDICATES = frozenset((Kind.BOOLEAN,))


@dataclass
class Signals:
    """The signals of a file, by the names that it has for them, and what else its names stand for.

    A name is declared where a property that is imported reads it: `declarations` takes the properties.
    """

    kinds: dict[str, Kind] = field(default_factory=dict)
    places: dict[str, str] = field(default_factory=dict)
    """What a declaration has behind the name, if the file says it: topic and type."""
    constants: dict[str, str] = field(default_factory=dict)
    """Words that are values: `idle` is `"idle"`."""
    definitions: dict[str, str] = field(default_factory=dict)
    """Names of expressions, and these."""
    unknown: set[str] = field(default_factory=set)
    """Definitions whose values the file does not have."""
    _names: dict[str, str] = field(default_factory=dict)
    _taken: starter.Names = field(default_factory=starter.Names)

    def name(self, written: str) -> str:
        """What the signal that is `written` so is called here."""
        if written not in self._names:
            self._names[written] = self._taken.new(starter.name_of(written).replace("topic_", "signal_", 1))
        return self._names[written]

    def keep(self, name: str) -> None:
        """Let a name of the language be the signal that is called so."""
        self._names.setdefault(name, self._taken.new(name))

    def label(self, written: str) -> str:
        """A label of a property, or another name that is new, for what is called so."""
        name = starter.name_of(written)
        return self._taken.new(re.sub(r"\Atopic(?:_|\Z)", "property_", name).rstrip("_"))

    def kind(self, written: str) -> Kind:
        """The kind of values that are known to be those of a name."""
        return self.kinds.get(written, Kind.UNKNOWN)

    def use(self, written: str, kind: Kind) -> None:
        """Note what kind of values a name must have, unless that is known."""
        if self.kind(written) is Kind.UNKNOWN:
            self.kinds[written] = kind

    def declarations(self, text: str) -> Iterator[str]:
        """The declarations and definitions that the properties in `text` need."""
        needed = set(re.findall(r"\w+", text))
        used = {}
        for written, expression in reversed(self.definitions.items()):
            if self._names[written] in needed:
                remark = "  # a constant of its message: write its value" if written in self.unknown else ""
                used[written] = f"{self._names[written]} = {expression}{remark}"
                needed |= set(re.findall(r"\w+", expression))
        for written, name in self._names.items():
            if name in needed and written not in self.definitions:
                remark = "" if written == name or written in self.places else f"  # {written}"
                yield f"decl {name} {self._place(written)}{remark}"
        yield from reversed(used.values())

    def _place(self, written: str) -> str:
        """Topic and type: where the file does not say it, the topic is called as the signal."""
        kind = self.kind(written)
        known = Kind.NUMBER if kind is Kind.UNKNOWN else kind
        topic = re.sub(r"\W+", "_", written).strip("_") or "unnamed"
        return self.places.get(written) or f"/{topic if topic[0].isalpha() else f'signal_{topic}'} {known.value}"
