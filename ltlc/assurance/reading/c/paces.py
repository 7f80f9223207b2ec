"""What emitted C does at one moment: it keeps samples, and steps the properties that these are for."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.c.expressions import not_understood
from ltlc.assurance.reading.c.text import Definitions, conjuncts, shown
from ltlc.assurance.reading.language import NotUnderstoodError


@dataclass(frozen=True)
class Taken:
    """A step of a property: what it is given after the struct, or None if it does nothing."""

    arguments: list[Node] | None


class Pace:
    """The function `judge` with a `suffix`, which steps some of the properties called `names`.

    What it keeps is in the member `signals` of the monitors. Raises NotUnderstoodError.
    """

    def __init__(self, definitions: Definitions, suffix: str, names: Sequence[str]) -> None:
        self.function = f"judge{suffix}"
        self.signals = f"signals{suffix}"
        own, *rest = definitions.function(self.function).body.block_items
        if shown(own) != f"{definitions.prefix}_{self.signals} * const signals = &monitors->{self.signals}":
            raise not_understood(own)
        places = [n for n, node in enumerate(rest) if isinstance(node, c_ast.Decl) and node.name == "together"]
        if len(places) != 1:
            raise NotUnderstoodError("`judge` does not say whether all comes together")
        self.statements, (declared, counted, *rest) = rest[: places[0]], rest[places[0] :]
        self.together = set(conjuncts(declared.init))
        self.all_flags = self._all()
        if shown(counted) != "signals->together += (together) ? (1u) : (0u)":
            raise not_understood(counted)
        if not {"signals->has_started", "all"} <= self.together:
            raise NotUnderstoodError("`together` does not ask whether all have started")
        self.taken = self._steps(rest, names)
        started = f".verdict != {definitions.prefix.upper()}_NOT_STARTED"
        known = {f"monitors->{name}{started}" for name in names}
        if not rest or not {f"monitors->{name}{started}" for name in self.taken} <= _started(rest[0]) <= known:
            raise NotUnderstoodError("`judge` does not say when all have started")
        for node in rest[1:]:
            if "monitors->end" not in shown(node) or any(f"monitors->{name}." in _sets(node) for name in names):
                raise not_understood(node)

    def knows_some(self, news: set[str]) -> bool:
        """Whether, where all samples come at once, some of `news` is."""
        return any(set(part.strip("()").split(" || ")) <= news for part in self.together)

    def _all(self) -> set[str]:
        """The flags of the samples that all come where they do."""
        declared = [n for n in self.statements if isinstance(n, c_ast.Decl) and n.name == "all"]
        if len(declared) != 1:
            raise NotUnderstoodError("`judge` does not say whether all samples come")
        parts = set(conjuncts(declared[0].init)) - {"true"}
        if any(not re.fullmatch(r"samples->\w+", part) for part in parts):
            raise not_understood(declared[0])
        return {part.removeprefix("samples->") for part in parts}

    def _steps(self, rest: list[Node], names: Iterable[str]) -> dict[str, Taken]:
        """How steps are taken of which properties, at the beginning of `rest`, from which they are removed."""
        found: dict[str, Taken] = {}
        while rest and (step := _step(rest[0])):
            name, taken = step
            if name not in names or name in found:
                raise not_understood(rest[0])
            found[name] = taken
            rest.pop(0)
        return found


def _step(node: Node) -> tuple[str, Taken] | None:
    """The property that a statement steps."""
    match node:
        case c_ast.If(iftrue=c_ast.Compound(block_items=[c_ast.FuncCall() as call]), iffalse=None):
            name = call.name.name.removesuffix("_step")
            first, *arguments = call.args.exprs
            asked = f"together || {name}_is_due(monitors, time, samples)"
            if shown(node.cond) == asked and shown(first) == f"&monitors->{name}":
                return name, Taken(arguments)
        case c_ast.If(cond=c_ast.UnaryOp(), iftrue=c_ast.Compound(block_items=[c_ast.Cast() as only])):
            name = (re.findall(r"(\w+)_is_due", shown(only)) or [""])[0]
            right = f"if (!together) {{ (void) {name}_is_due(monitors, time, samples); }}"
            if shown(node) == right:
                return name, Taken(None)
        case _:
            pass
    return None


def _started(node: Node) -> set[str]:
    """What `signals->has_started` becomes, unless it is true: the parts that all have to hold."""
    match node:
        case c_ast.If(iftrue=c_ast.Compound(block_items=[c_ast.Assignment(op="=") as set_]), iffalse=None):
            if shown(node.cond) == "!signals->has_started" and shown(set_.lvalue) == "signals->has_started":
                return set(conjuncts(set_.rvalue))
        case _:
            pass
    return set()


def _sets(node: Node) -> str:
    """What is set in an `if`, as text."""
    return shown(node.iftrue) if isinstance(node, c_ast.If) else shown(node)
