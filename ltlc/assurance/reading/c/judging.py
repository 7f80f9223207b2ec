"""What emitted C does around the steps of its properties: when these are taken, and how a run and a session begin."""

from __future__ import annotations

import re
from dataclasses import dataclass

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.c.expressions import not_understood
from ltlc.assurance.reading.c.text import Definitions, conjuncts, disjuncts, shown
from ltlc.assurance.reading.language import NotUnderstoodError


@dataclass(frozen=True)
class Taken:
    """A step of a property: what it is given after the struct, or None if it does nothing."""

    arguments: list[Node] | None


class Judging:
    """The functions that a file has once for all its properties. Raises NotUnderstoodError."""

    def __init__(self, definitions: Definitions, count: int) -> None:
        prefix = definitions.prefix
        members = definitions.type(f"{prefix}_monitors").decls
        self.names = [each.name for each in members if re.search(rf"\b{prefix}_{re.escape(each.name)}\b", shown(each))][
            :count
        ]
        self.is_rated = "tick" in definitions
        self._begun = self._dues(definitions, f"{prefix}_init", _AT_START)
        session = "begin_session" in definitions
        self._sessions = self._dues(definitions, "begin_session", _AT_THE_SESSION) if session else {}
        self._held = self._loops(definitions) if "hold" in definitions else []
        self._flags, self._heard = self._hearing(definitions)
        self._taken: dict[str, Taken] = {}
        self.statements: list[Node] = []
        self._judged(definitions)
        self._check_others(definitions)

    def starts(self, name: str) -> dict[str, Node]:
        """What is set of the property `name` before a run, but for what is 0."""
        return self._begun.get(name, {})

    def sessions(self, name: str) -> dict[str, Node]:
        """What is set of the property `name` when the session begins."""
        return self._sessions.get(name, {})

    def holds(self, name: str) -> bool:
        """Whether clock steps of the property `name` that are due are taken."""
        return name in self._held

    def heard(self, name: str) -> list[str]:
        """Of which topics the property `name` is told messages as they come, by the flags that are kept of these."""
        return self._heard.get(name, [])

    def taken(self, name: str) -> Taken | None:
        """How a step of the property `name` is taken; None if none is."""
        return self._taken.get(name)

    def knows_some(self, news: set[str]) -> bool:
        """Whether, where all samples come at once, some of `news` is."""
        return any(set(part.strip("()").split(" || ")) <= news for part in self.together)

    def _check_others(self, definitions: Definitions) -> None:
        """No other function does anything to a property."""
        of_all = "|".join(map(re.escape, self.names))
        touched = rf"monitors->(?:{of_all})\b|\b(?:{of_all})_(?:{'|'.join(_OWN)})\("
        own = {f"{name}_{what}" for name in self.names for what in _OWN}
        known = {"judge", "hold", "begin_session", "first_steps", *own}
        known |= {f"{definitions.prefix}_{what}" for what in ("init", "step", "next_deadline", *_SHOWN)}
        for name in definitions.functions:
            if name not in known and definitions.mentions(name, touched):
                raise NotUnderstoodError(f"`{name}` does something to a property")
        calls = rf"(?:{of_all})_hear\(.*\)"
        for node in definitions.function(f"{definitions.prefix}_step").body.block_items:
            if re.search(touched, shown(node)) and not re.fullmatch(calls, shown(node)):
                raise not_understood(node)
        if any(re.search(touched, shown(node)) for node in self.statements):
            raise NotUnderstoodError("samples are kept where the property has its state")

    def _dues(self, definitions: Definitions, function: str, around: frozenset[str]) -> dict[str, dict[str, Node]]:
        """What a function sets of properties; all else that it does is in `around`."""
        found: dict[str, dict[str, Node]] = {}
        for node in definitions.function(function).body.block_items:
            match node:
                case c_ast.Assignment(op="=", lvalue=c_ast.StructRef(name=c_ast.StructRef() as of, field=field)):
                    if shown(of) == f"monitors->{of.field.name}" and of.field.name in self.names:
                        members = found.setdefault(of.field.name, {})
                        if field.name in members:
                            raise not_understood(node)
                        members[field.name] = node.rvalue
                        continue
            text = shown(node).replace(f"{definitions.prefix}_", "").replace(f"{definitions.prefix.upper()}_", "")
            if text.rstrip(";") not in around:
                raise not_understood(node)
        return found

    def _loops(self, definitions: Definitions) -> list[str]:
        found = []
        for node in definitions.function("hold").body.block_items or ():
            name = (re.findall(r"(\w+)_expire", shown(node)) or [""])[0]
            right = f"while (time > monitors->{name}.due) {{ {name}_expire(&monitors->{name}); }}"
            if name not in self.names or name in found or shown(node) != right:
                raise not_understood(node)
            found.append(name)
        return found

    def _hearing(self, definitions: Definitions) -> tuple[dict[str, str], dict[str, list[str]]]:
        """The flags that say of which topics messages come, by what tells it; and who is told, of which of these."""
        flags: dict[str, str] = {}
        heard: dict[str, list[str]] = {}
        for node in definitions.function(f"{definitions.prefix}_step").body.block_items:
            match node:
                case c_ast.Assignment(op="=", lvalue=target, rvalue=came) if not heard:
                    name = shown(target).removeprefix("monitors->signals.")
                    parts = [part for part in disjuncts(came) if part != shown(target)]
                    flags[" || ".join(sorted(parts))] = name
                case c_ast.FuncCall(name=c_ast.ID(name=function), args=c_ast.ExprList(exprs=[of, time, *told])):
                    name = function.removesuffix("_hear")
                    if name == function or name in heard:
                        continue
                    if (shown(of), shown(time)) != (f"&monitors->{name}", "time"):
                        raise not_understood(node)
                    heard[name] = [flags.get(" || ".join(sorted(disjuncts(each))), "") for each in told]
        return flags, heard

    def _judged(self, definitions: Definitions) -> None:
        """How steps are taken in `judge`; what comes before keeps samples."""
        rest = list(definitions.function("judge").body.block_items)
        places = [n for n, node in enumerate(rest) if isinstance(node, c_ast.Decl) and node.name == "together"]
        if len(places) != 1:
            raise NotUnderstoodError("`judge` does not say whether all comes together")
        self.statements, (declared, counted, *rest) = rest[: places[0]], rest[places[0] :]
        self.together = set(conjuncts(declared.init))
        self.all_flags = self._all()
        if shown(counted) != "monitors->together += (together) ? (1u) : (0u)":
            raise not_understood(counted)
        if not {"monitors->has_started", "all"} <= self.together:
            raise NotUnderstoodError("`together` does not ask whether all have started")
        last = [f"(monitors->{name}.verdict != {definitions.prefix.upper()}_NOT_STARTED)" for name in self.names]
        while rest and (found := self._step(rest[0])):
            name, taken = found
            if name not in self.names or name in self._taken:
                raise not_understood(rest[0])
            self._taken[name] = taken
            rest.pop(0)
        started = " && ".join(last) if len(last) > 1 else "".join(last)[1:-1]
        right = f"if (!monitors->has_started) {{ monitors->has_started = {started}; }}"
        if not rest or _plain(shown(rest[0])) != _plain(right):
            raise NotUnderstoodError("`judge` does not say when all have started")
        for node in rest[1:]:
            if "monitors->end" not in shown(node) or any(f"monitors->{name}." in _sets(node) for name in self.names):
                raise not_understood(node)

    def _all(self) -> set[str]:
        """The flags of the samples that all come where they do."""
        declared = [n for n in self.statements if isinstance(n, c_ast.Decl) and n.name == "all"]
        if len(declared) != 1:
            raise NotUnderstoodError("`judge` does not say whether all samples come")
        parts = set(conjuncts(declared[0].init)) - {"true"}
        if any(not re.fullmatch(r"samples->\w+", part) for part in parts):
            raise not_understood(declared[0])
        return {part.removeprefix("samples->") for part in parts}

    def _step(self, node: Node) -> tuple[str, Taken] | None:
        """The property that a statement steps."""
        match node:
            case c_ast.If(iftrue=c_ast.Compound(block_items=[c_ast.FuncCall() as call]), iffalse=None):
                name = call.name.name.removesuffix("_step")
                first, *arguments = call.args.exprs
                asked = f"together || {name}_is_due(monitors, time, samples)"
                if _plain(shown(node.cond)) == asked and shown(first) == f"&monitors->{name}":
                    return name, Taken(arguments)
            case c_ast.If(cond=c_ast.UnaryOp(), iftrue=c_ast.Compound(block_items=[c_ast.Cast() as only])):
                name = (re.findall(r"(\w+)_is_due", shown(only)) or [""])[0]
                right = f"if (!together) {{ (void) {name}_is_due(monitors, time, samples); }}"
                if shown(node) == right:
                    return name, Taken(None)
        return None


_OWN = ("is_due", "step", "expire", "schedule", "hear")
_SHOWN = ("verdict_of", "steps_of", "invalid_of", "since_of")
_AT_START = frozenset({"*monitors = (monitors){0}", "monitors->time = INT64_MIN", "monitors->end = NEVER"})
_AT_THE_SESSION = frozenset(
    {
        "if (monitors->has_session) { return false; }",
        "monitors->has_session = true",
        "monitors->is_ticking = true",
        "monitors->tick = time",
        "(void) time",
        "return true",
    }
)


def _plain(text: str) -> str:
    return text.replace("(", "").replace(")", "") if "is_due" not in text else text


def _sets(node: Node) -> str:
    """What is set in an `if`, as text."""
    return shown(node.iftrue) if isinstance(node, c_ast.If) else shown(node)
