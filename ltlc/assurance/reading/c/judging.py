"""What emitted C does around the steps of its properties: when these are taken, and how a run and a session begin."""

from __future__ import annotations

import re

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.c.expressions import not_understood
from ltlc.assurance.reading.c.paces import Pace
from ltlc.assurance.reading.c.text import Definitions, disjuncts, shown
from ltlc.assurance.reading.language import NotUnderstoodError


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
        self._holding = [name for name in definitions.functions if re.fullmatch(r"hold(|_\d+)", name)]
        self._held = self._loops(definitions)
        self._heard = self._hearing(definitions)
        suffixes = (re.fullmatch(r"judge(|_\d+)", function) for function in definitions.functions)
        self.paces = [Pace(definitions, found[1], self.names) for found in suffixes if found]
        if len([name for pace in self.paces for name in pace.taken]) > len({n for p in self.paces for n in p.taken}):
            raise NotUnderstoodError("a property is judged twice")
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

    def pace(self, name: str) -> Pace:
        """Where the property `name` is stepped; if it is nowhere, the first."""
        return next((pace for pace in self.paces if name in pace.taken), self.paces[0])

    def heard(self, name: str) -> list[str]:
        """Of which topics the property `name` is told messages as they come, by the flags that are kept of these."""
        return self._heard.get(name, [])

    def _check_others(self, definitions: Definitions) -> None:
        """No other function does anything to a property."""
        of_all = "|".join(map(re.escape, self.names))
        touched = rf"monitors->(?:{of_all})\b|\b(?:{of_all})_(?:{'|'.join(_OWN)})\("
        own = {f"{name}_{what}" for name in self.names for what in _OWN}
        known = {"begin_session", "first_steps", *own, *self._holding, *(pace.function for pace in self.paces)}
        known |= {f"{definitions.prefix}_{what}" for what in ("init", "step", "next_deadline", *_SHOWN)}
        for name in definitions.functions:
            if name not in known and definitions.mentions(name, touched):
                raise NotUnderstoodError(f"`{name}` does something to a property")
        calls = rf"(?:{of_all})_hear\(.*\)"
        for node in definitions.function(f"{definitions.prefix}_step").body.block_items:
            if re.search(touched, shown(node)) and not re.fullmatch(calls, shown(node)):
                raise not_understood(node)
        if any(re.search(touched, shown(node)) for pace in self.paces for node in pace.statements):
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
                case _:
                    pass
            text = shown(node).replace(f"{definitions.prefix}_", "").replace(f"{definitions.prefix.upper()}_", "")
            text = re.sub(r"\bsignals_\d+\b", "signals", text)
            if text.rstrip(";") not in around:
                raise not_understood(node)
        return found

    def _loops(self, definitions: Definitions) -> list[str]:
        found: list[str] = []
        for node in (each for name in self._holding for each in definitions.function(name).body.block_items or ()):
            name = (re.findall(r"(\w+)_expire", shown(node)) or [""])[0]
            right = f"while (time > monitors->{name}.due) {{ {name}_expire(&monitors->{name}); }}"
            if name not in self.names or name in found or shown(node) != right:
                raise not_understood(node)
            found.append(name)
        return found

    def _hearing(self, definitions: Definitions) -> dict[str, list[str]]:
        """The properties that are told of messages as they come: of which topics, by the flags that keep these."""
        flags: dict[str, str] = {}
        heard: dict[str, list[str]] = {}
        for node in definitions.function(f"{definitions.prefix}_step").body.block_items:
            match node:
                case c_ast.Assignment(op="=", lvalue=target, rvalue=came) if not heard:
                    parts = [part for part in disjuncts(came) if part != shown(target)]
                    flags[" || ".join(sorted(parts))] = re.sub(r"monitors->signals(_\d+)?\.", "", shown(target))
                case c_ast.FuncCall(name=c_ast.ID(name=function), args=c_ast.ExprList(exprs=[of, time, *told])):
                    name = function.removesuffix("_hear")
                    if name == function or name in heard:
                        continue
                    if (shown(of), shown(time)) != (f"&monitors->{name}", "time"):
                        raise not_understood(node)
                    heard[name] = [flags.get(" || ".join(sorted(disjuncts(each))), "") for each in told]
                case _:
                    pass
        return heard


_OWN = ("is_due", "step", "expire", "schedule", "hear")
_SHOWN = ("verdict_of", "steps_of", "invalid_of", "since_of")
_AT_START = frozenset({"*monitors = (monitors){0}", "monitors->time = INT64_MIN", "monitors->end = NEVER"})
_AT_THE_SESSION = frozenset(
    {
        "if (monitors->has_session) { return false; }",
        "monitors->has_session = true",
        "monitors->signals.ticks.have_begun = true",
        "monitors->signals.ticks.next = time",
        "(void) time",
        "return true",
    }
)
