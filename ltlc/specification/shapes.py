"""What is equal except for names: the shape of properties, of what is made of them, and of their code.

The definitions of the language, the checker of certificates, the analyses and the runtime never ask what something is
called, only whether two are the same. So what is found of one property goes for all of its shape.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from functools import cache
from types import CodeType, FunctionType
from typing import Any

from ltlc.semantics import ltl
from ltlc.semantics.ltl import Formula
from ltlc.specification.expressions import Field, Match, Parallel, Signal
from ltlc.specification.specification import PropertySpecification

_NAMED: dict[type, str] = {ltl.Atom: "name", Signal: "name", Field: "topic", Match: "value", Parallel: "value"}
"""What has a name that may differ, and the field that it is in."""

_SHOWN = frozenset({"label", "file", "line", "text", "obligations", "whole"})
"""Fields that reports show and that decide nothing."""


@cache
def _fields(type_: Any) -> tuple[str | None, tuple[str, ...]]:
    """The field of a dataclass that is a name, and those others that decide something."""
    name = next((field for named, field in _NAMED.items() if issubclass(type_, named)), None)
    return name, tuple(f.name for f in fields(type_) if f.name != name and f.name not in _SHOWN)


class Shape:
    """A shape in the making.

    Names of atoms, signals, topics and entries, and private names of code, are numbered in the order in which they
    come. So two shapes have the same `key` only if a one-to-one change of names makes one of the other: of each of the
    `names` of one, the name with its number in the other.
    """

    def __init__(self) -> None:
        self.names: dict[str, int] = {}
        self._parts: dict[Hashable, int] = {}
        self._known: dict[int, tuple[Any, int]] = {}
        self._verbatim: set[str] = set()
        self._added: list[int] = []
        self._globals: Mapping[str, Any] = {}

    @property
    def key(self) -> Hashable:
        """What was added, and all its parts; a text that is a name elsewhere stands for itself."""
        return tuple(self._added), tuple(self._parts), frozenset(self._verbatim & self.names.keys())

    def add(self, value: Any) -> None:
        """Make `value` a part of the shape."""
        self._added.append(self._number(value))

    def add_property(self, specification: PropertySpecification, formula: Formula) -> None:
        """Make a property, what it is in core LTL, and its conditions parts of the shape."""
        self.add((formula, specification.property))
        for atom in specification.atoms:
            self.add((ltl.Atom(atom.name), atom.condition))

    def _number(self, value: Any) -> int:
        """The number of `value`, after those of all that is in it."""
        if id(value) not in self._known or isinstance(value, str):
            self._known[id(value)] = value, self._parts.setdefault(self._part(value), len(self._parts))
        return self._known[id(value)][1]

    def _name(self, text: str) -> Hashable:
        return "name", self.names.setdefault(text, len(self.names))

    def _part(self, value: Any) -> Hashable:
        match value:
            case str():
                return self._name(value) if value in self.names else self._text(value)
            case float():
                return "float", repr(value)
            case Enum():
                return type(value).__name__, value.name
            case tuple() | list():
                return "sequence", tuple(map(self._number, value))
            case dict():
                return "mapping", tuple(map(self._number, value.items()))
            case frozenset() | set():
                return "set", frozenset(map(self._number, value))
            case CodeType():
                return self._code(value, value.co_consts)
            case FunctionType(__code__=code, __defaults__=defaults, __kwdefaults__=named, __closure__=cells):
                inside = tuple(cell.cell_contents for cell in cells or ())
                self._globals = value.__globals__
                has_docstring = isinstance(value.__doc__, str)  # which is the first constant then
                values = tuple((named or {}).items()), defaults, inside
                return self._code(code, code.co_consts[has_docstring:]), has_docstring, *map(self._number, values)
            case type():
                members = ((n, v) for n, v in vars(value).items() if isinstance(v, FunctionType) or n[:2] != "__")
                return "class", tuple((self._attribute(name), self._number(member)) for name, member in members)
            case _:
                return self._data(value) if is_dataclass(value) else (type(value), value)

    def _text(self, text: str) -> Hashable:
        self._verbatim.add(text)
        return "text", text

    def _data(self, value: Any) -> Hashable:
        kind: Any = type(value)
        name, others = _fields(kind)
        inside = tuple(self._number(getattr(value, other)) for other in others)
        return kind, self._name(getattr(value, name)) if name else None, inside

    def _code(self, code: CodeType, constants: tuple[Any, ...]) -> Hashable:
        """All of a function that decides what it does: not what it and its variables are called."""
        numbers = (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_nlocals, code.co_flags)
        outside = len(code.co_cellvars), len(code.co_freevars)
        names = tuple(map(self._attribute, code.co_names))
        inside = tuple(map(self._number, constants))
        return "code", code.co_code, code.co_exceptiontable, *numbers, *outside, names, inside

    def _attribute(self, name: str) -> Hashable:
        """An attribute or global name; an attribute that is private to the code has a number."""
        is_private = name.startswith("_") and not name.startswith("__") and name not in self._globals
        return self._name(name) if is_private else ("attribute", name)


def renamed(value: Any, names: Mapping[str, str]) -> Any:
    """`value` with others for the `names` of atoms in it; what is shared in it stays shared."""
    return _renamed(value, names, {})


def _renamed(value: Any, names: Mapping[str, str], known: dict[int, tuple[Any, Any]]) -> Any:
    if id(value) not in known:
        known[id(value)] = value, _with_names(value, names, known)
    return known[id(value)][1]


def _with_names(value: Any, names: Mapping[str, str], known: dict[int, tuple[Any, Any]]) -> Any:
    match value:
        case Enum():
            return value
        case str():
            return names.get(value, value)
        case tuple():
            inside = [_renamed(each, names, known) for each in value]
            return type(value)(*inside) if hasattr(value, "_fields") else tuple(inside)
        case frozenset():
            return frozenset(_renamed(each, names, known) for each in value)
        case _:
            pass
    if not is_dataclass(value) or isinstance(value, type):
        return value
    return replace(value, **{f.name: _renamed(getattr(value, f.name), names, known) for f in fields(value)})
