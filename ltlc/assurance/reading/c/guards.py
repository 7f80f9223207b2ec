"""Where the guard in a source file of C rests, read back to its program: decisions, and what they ask."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.c.definitions import Definitions, shaped, statements
from ltlc.assurance.reading.c.files import readings
from ltlc.assurance.reading.c.front import C, Named, Scope, rounded
from ltlc.assurance.reading.c.members import Members, Pace, Property
from ltlc.assurance.reading.c.parsing import parsed, shown
from ltlc.assurance.reading.expressions import Reader
from ltlc.assurance.reading.outcomes import Difference
from ltlc.assurance.reading.trees import Apply, Constant, NotUnderstoodError, Tree, Variable
from ltlc.program.expressions import Expression, Literal
from ltlc.program.guards import GuardProgram
from ltlc.program.lowering import lowered, read
from ltlc.program.normal import normal
from ltlc.program.resting import Held
from ltlc.runtime.guard_plans import Asked, Asks
from ltlc.specification.text import text


class Texts(NamedTuple):
    """The files of monitors, and those of the guard beside them."""

    header: str
    source: str
    guard_header: str
    guard_source: str


def difference(texts: Texts, program: GuardProgram, properties: Sequence[Property]) -> Difference | None:
    """What files of a guard say otherwise than its program, None: nothing; `properties` are all that are monitored."""
    try:
        with shaped():
            return _Read(texts, program, properties).difference()
    except NotUnderstoodError as error:
        return Difference(str(error))


class _Read:
    def __init__(self, texts: Texts, program: GuardProgram, properties: Sequence[Property]) -> None:
        self.program = program
        self.definitions = Definitions(texts.header, texts.source)
        self.members = Members(self.definitions, properties, is_rated=False, is_grouped=True)
        self.pace: Pace = self.members.paces[0]
        types = parsed(texts.guard_header, parsed(texts.header).types).types
        self.rests = self.definitions.know(texts.guard_source, types)["rests"]
        inputs = list(dict.fromkeys(i for held in program.resting.conditions for i in held.inputs))
        values = {kept.ago(): Named(Variable(kept.name), "double") for kept in self.pace.values.values()}
        self.scope = Scope(self.definitions, {}, {**readings(self.definitions, self.pace, inputs), **values})
        named: dict[str, Expression] = {text(i): read(i) for i in inputs}
        named |= {kept.name: normal(lowered(part)) for part, kept in self.pace.values.items()}
        self.reader = Reader(C, named, {})

    def difference(self) -> Difference | None:
        resting = self.program.resting
        root, decisions = self._decisions()
        if root != resting.root or len(decisions) != len(resting.decisions):
            return Difference("`rests` has other decisions")
        for number, ((node, yes, no), right) in enumerate(zip(decisions, resting.decisions, strict=True)):
            asked = resting.questions[right.atom]
            if (no, yes) != (right.low, right.high) or not self._asks(node, asked):
                return Difference(f"the decision {~number} of `rests` is another one: `{shown(node)}`")
        return None

    def _decisions(self) -> tuple[int, list[tuple[Node, int, int]]]:
        """Where `rests` begins, and what it asks, each with where it leads if so, and if not."""
        *before, loop, end = statements(self.rests)
        (root,) = (node for node in before if isinstance(node, c_ast.Decl) and node.name == "target")
        (switch,) = loop.stmt.block_items
        *cases, other = switch.stmt.block_items
        found = []
        for number, case in enumerate(cases):
            assigned, _ = case.stmts
            asked = assigned.rvalue
            if _number(case.expr) != ~number or shown(assigned.lvalue) != "target":
                raise NotUnderstoodError(f"`{shown(case)}` is not a decision of `rests`")
            found.append((asked.cond, _number(asked.iftrue), _number(asked.iffalse)))
        said = shown(loop.cond), shown(switch.cond), shown(end.expr), shown(other.stmts[0])
        if said != ("target < 0", "target", "target == 1", "target = 0"):
            raise NotUnderstoodError("`rests` does not follow its decisions")
        return _number(root.init), found

    def _asks(self, node: Node, asked: Asked) -> bool:
        """Whether a condition is this question."""
        asks, of, number = asked
        match asks:
            case Asks.SILENT:
                return self._is(node, "run->is_silent")
            case Asks.SENT:
                return self._is(node, f"run->sent[{of}] == {number}u")
            case Asks.WAITS:
                return self._is(node, f"{self._member(of)}.verdict == {self._not_started}")
            case Asks.STANDS:
                begun = f"{self._member(of)}.verdict != {self._not_started}"
                return self._is(node, f"{begun} && {self._member(of)}.state == {number}u")
            case Asks.KNOWN:
                return self._is_known(node, self.program.resting.conditions[of])
            case Asks.HOLDS:
                return self._expression(node) == rounded(self.program.resting.conditions[of].holds)

    @property
    def _not_started(self) -> str:
        return f"{self.definitions.prefix.upper()}_NOT_STARTED"

    def _member(self, part: int) -> str:
        return f"monitors->{self.members.structs[self.program.parts[part]].name}"

    def _is(self, node: Node, right: str) -> bool:
        (said,) = self.definitions.places([right])
        return shown(node) == said

    def _expression(self, node: Node) -> Expression:
        return self.reader.expression(self.scope.tree(node))

    def _is_known(self, node: Node, held: Held) -> bool:
        """Whether it is that all values are there, none of them NaN."""
        there = set(self.definitions.places(self.pace.ready(self.members.given, held.inputs)))
        parts = list(_conjoined(node))
        rest: list[Tree] = [self.scope.tree(part) for part in parts if shown(part) not in there]
        if {shown(part) for part in parts} < there or len(parts) != len(rest) + len(there):
            return False
        if not rest:
            return isinstance(held.known, Literal)
        measured = rest[0] if len(rest) == 1 else Apply("and", tuple(rest))
        return measured == Constant(True) or self.reader.expression(measured) == rounded(held.known)


def _conjoined(node: Node) -> Iterator[Node]:
    match node:
        case c_ast.BinaryOp(op="&&", left=left, right=right):
            yield from _conjoined(left)
            yield from _conjoined(right)
        case _:
            yield node


def _number(node: Node) -> int:
    match node:
        case c_ast.UnaryOp(op="-", expr=inner):
            return -_number(inner)
        case c_ast.Constant(type="int", value=value):
            return int(value)
        case _:
            raise NotUnderstoodError(f"`{shown(node)}` is not a number")
