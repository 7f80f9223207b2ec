"""What the names of a specification stand for: declarations, models, objects and associations."""

from __future__ import annotations

from dataclasses import field

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Help, Label, Severity
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.language.signals import SIMULATORS, Thing
from ltlc.frontend.language.values import Value
from ltlc.frontend.syntax import tree as syntax
from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.semantics.encodings import Encoding
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import DefinitionKind


class Sort:
    """What a node of the syntax tree is, before types are known."""

    VALUE = "value"
    STATE = "state predicate"
    TEMPORAL = "temporal property"


@dataclass(frozen=True, slots=True)
class Associated:
    """An association: the tree it stands for, how large it is with all associations in it, and its value if it has one.

    `sound` is false if an error in it has been reported.
    """

    node: syntax.Node
    kind: str
    size: int
    depth: int
    value: Value | None = None
    sound: bool = True


@dataclass(frozen=True, slots=True)
class ModelAttribute:
    """An attribute of a model: None where an error in it has been reported."""

    value: Value | None
    span: Span


@dataclass(frozen=True, slots=True)
class Simulator:
    """Where objects come from that are not declared: a topic with `{name}` in it, and its message type."""

    topic: str = SIMULATORS["odometry"][0]
    message: str = SIMULATORS["odometry"][1]


@dataclass
class Names:
    """The names defined so far, and those that some part of the file defines, for 'used before definition'.

    `undeclared` has the uses of objects that nothing declares, `ids` the keys of the variables of `each`. For each of
    the `topics` with declared values, there is the full name of its type, and where it is declared first.
    """

    everywhere: dict[str, Span] = field(default_factory=dict)
    definitions: list[tuple[DefinitionKind, syntax.Word]] = field(default_factory=list)
    declarations: dict[str, Value | None] = field(default_factory=dict)
    associations: dict[str, Associated] = field(default_factory=dict)
    models: dict[str, dict[str, ModelAttribute]] = field(default_factory=dict)
    objects: dict[str, Thing | None] = field(default_factory=dict)
    simulator: Simulator = field(default_factory=Simulator)
    undeclared: dict[str, list[Span]] = field(default_factory=dict)
    ids: dict[str, tuple[Signal, Span]] = field(default_factory=dict)
    topics: dict[str, tuple[str, Span]] = field(default_factory=dict)

    def visible(self) -> list[str]:
        """All names that can be used."""
        return [*self.declarations, *self.associations, *self.models, *self.objects]


@dataclass
class Checker:
    """What the functions of the resolver share: the text, the message types, the names, and the findings so far.

    By `encoding` the properties are to be read, `margin` and `rate` are those of the file. What is `elementwise` stands
    in `any`, `all` or `count`, where an array is each of its elements. It `gave_up` if it did not look at all of the
    file.
    """

    source: Source
    types: MessageTypes
    encoding: Encoding
    lost: frozenset[str] = frozenset()
    margin: float = 0.0
    rate: float | None = None
    elementwise: bool = False
    gave_up: bool = False
    names: Names = field(default_factory=Names)
    diagnostics: list[Diagnostic] = field(default_factory=list)
    _reported: set[tuple[str, Span]] = field(default_factory=set)

    @property
    def has_failed(self) -> bool:
        """Whether there is no specification."""
        return self.gave_up or any(d.severity is Severity.ERROR for d in self.diagnostics)

    def report(
        self, code: str, place: Span, message: str, *secondary: Label, label: str = "", help: str | Help = ""
    ) -> None:
        """Collect a diagnostic, the first of its code at its place."""
        if (code, place) not in self._reported:
            self._reported.add((code, place))
            found = diagnostic(code, self.source, place, message, label=label, secondary=secondary, help=help)
            self.diagnostics.append(found)

    def written(self, node: syntax.Node) -> str:
        """The text of `node`."""
        return self.source.excerpt(node.span)
