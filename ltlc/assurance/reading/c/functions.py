"""Functions of emitted C as blocks of the small language."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.c.expressions import Scope, not_understood, parameters
from ltlc.assurance.reading.c.text import Definitions, shown, type_text
from ltlc.assurance.reading.c.types import SIGNED_64, Typed, holds
from ltlc.assurance.reading.language import (
    Apply,
    Assign,
    Attribute,
    Block,
    Constant,
    Do,
    If,
    Method,
    NotUnderstoodError,
    Return,
    Statement,
    Term,
    Variable,
)

VERDICT = Attribute("verdict")
_NOT_JUDGED = frozenset({"self->apart++", "self->since = time"})
"""What counts steps, and notes when verdicts come: replayed, not read back."""


@dataclass(frozen=True)
class Struct:
    """The struct of a property with the types of its members, in order."""

    name: str
    members: Mapping[str, str]
    bits: frozenset[str]

    @classmethod
    def of(cls, definitions: Definitions, name: str) -> Struct:
        """The struct called `name`. Raises NotUnderstoodError."""
        declared = definitions.type(name).decls or []
        found = {each.name: type_text(each) for each in declared}
        if found.get("state") not in ("uint8_t", "uint16_t", "uint32_t") or found.get("verdict") != "uint8_t":
            raise NotUnderstoodError(f"`{name}` has no state and verdict")
        return cls(name, found | {"verdict": "verdict"}, frozenset(each.name for each in declared if each.bitsize))

    def kept(self, dues: Sequence[str]) -> tuple[str, ...]:
        """The members that hold values taken at openings; of each, `NAME_next` is what may be taken next."""
        own = {"since", "invalid", "apart", "state", "verdict", "due", *dues, *self.bits}
        return tuple(name for name in self.members if name not in own and not self._is_next(name))

    def _is_next(self, name: str) -> bool:
        of = name.removesuffix("_next")
        return of != name and of in self.members


@dataclass(frozen=True)
class Functions:
    """The functions of the property whose struct this is."""

    definitions: Definitions
    struct: Struct

    def method(self, name: str) -> Method:
        """A function that is given the struct and what a decision hands on."""
        declared = parameters(self.definitions.function(name))
        return Method(tuple(each.name for each in declared[1:]), self.body(name))

    def given(self, name: str) -> list[tuple[str, str]]:
        """What a function is given after the struct, with the types of it. Raises NotUnderstoodError."""
        first, *others = parameters(self.definitions.function(name)) or [None]
        if first is None or first.name != "self" or type_text(first) != f"{self.struct.name} *":
            raise NotUnderstoodError(f"`{name}` is not given what the property remembers")
        return [(each.name, type_text(each)) for each in others]

    def body(self, name: str) -> Block:
        """What a function does. Raises NotUnderstoodError."""
        variables = {parameter: Typed(Variable(parameter), type_) for parameter, type_ in self.given(name)}
        scope = Scope(self.definitions, variables, self.struct.members, {})
        return self.block(self.definitions.function(name).body, scope)

    def block(self, node: Node | None, scope: Scope) -> Block:
        """The statements of a block."""
        if node is not None and not isinstance(node, c_ast.Compound):
            raise not_understood(node)
        return self.statements(list(node.block_items or []) if node is not None else [], scope)

    def statements(self, nodes: Sequence[Node], scope: Scope) -> Block:
        """Statements one after the other, of which each may declare a variable."""
        found: list[Statement] = []
        for node in nodes:
            match node:
                case c_ast.Cast(expr=c_ast.ID()) if type_text(node.to_type) == "void":
                    continue
                case c_ast.Decl(name=name, init=init) if init is not None and node.quals + node.type.quals:
                    value = scope.typed(init)
                    type_ = "int64_t" if value.type == SIGNED_64 else value.type
                    if not _declares(type_text(node), type_, value):
                        raise NotUnderstoodError(f"`{name}` is of another type than its value")
                    scope = scope.with_variable(name, Typed(Variable(name), type_text(node)))
                    found.append(Assign(Variable(name), value.term))
                case _ if shown(node) in _NOT_JUDGED:
                    continue
                case _:
                    found.append(self._statement(node, scope))
        return tuple(found)

    def _statement(self, node: Node, scope: Scope) -> Statement:
        match node:
            case c_ast.If():
                guard = scope.condition(node.cond)
                otherwise = self._otherwise(node.iffalse, scope)
                return If(guard, self.block(node.iftrue, scope), otherwise)
            case c_ast.Assignment(lvalue=c_ast.StructRef() as target, rvalue=value):
                return self._assigned(node, target, value, scope)
            case c_ast.UnaryOp(op="p++") if shown(node) == "self->invalid++":
                invalid = Attribute("invalid")
                return Assign(invalid, Apply("+", (invalid, Constant(1))))
            case c_ast.Return(expr=None):
                return Return(VERDICT)
            case c_ast.FuncCall(name=c_ast.ID(name=function), args=c_ast.ExprList(exprs=[first, *rest])):
                if shown(first) == "self" and function in self.definitions:
                    return Do(function, self._handed_on(node, function, rest, scope))
            case _:
                pass
        raise not_understood(node)

    def _otherwise(self, node: Node | None, scope: Scope) -> Block:
        return (self._statement(node, scope),) if isinstance(node, c_ast.If) else self.block(node, scope)

    def _assigned(self, node: Node, target: c_ast.StructRef, value: Node, scope: Scope) -> Statement:
        place = scope.typed(target)
        name = target.field.name
        if not isinstance(place.term, Attribute) or name in ("since", "apart", "invalid"):
            raise not_understood(node)
        found = scope.typed(value)
        if node.op == "+=" and place.type == found.type == SIGNED_64:
            return Assign(place.term, Apply("+", (place.term, found.term)))
        is_state = name == "state" and isinstance(found.term, Constant) and _fits(place.type, found.term)
        if node.op != "=" or not (is_state or (place.type == found.type and name != "state")):
            raise not_understood(node)
        return Assign(place.term, found.term)

    def _handed_on(self, node: Node, function: str, arguments: Sequence[Node], scope: Scope) -> tuple[Term, ...]:
        given = [scope.typed(each) for each in arguments]
        if [each.type for each in given] != [type_ for _, type_ in self.given(function)]:
            raise not_understood(node)
        return tuple(each.term for each in given)


def _declares(type_: str, wanted: str, value: Typed) -> bool:
    """Whether a variable of a type has the value as it is; a state may be widened."""
    return type_ == wanted or (type_ == "unsigned" and value.term == Attribute("state"))


def _fits(type_: str, term: Constant) -> bool:
    return isinstance(term.value, int) and not isinstance(term.value, bool) and holds(type_, term.value)


def called(block: Block) -> set[str]:
    """The functions that statements call."""
    found: set[str] = set()
    for each in block:
        match each:
            case If(_, then, otherwise):
                found |= called(then) | called(otherwise)
            case Do(method):
                found.add(method)
            case _:
                pass
    return found
