"""Functions of emitted C that are given what a property remembers, as methods of the small language."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.beginnings import INVALID
from ltlc.assurance.reading.c.definitions import Definitions, parameters, statements, type_text
from ltlc.assurance.reading.c.front import Named, Scope, not_understood
from ltlc.assurance.reading.c.parsing import shown
from ltlc.assurance.reading.trees import (
    TIME,
    VERDICT,
    Apply,
    Assign,
    Attribute,
    Block,
    Constant,
    Do,
    If,
    Method,
    NotUnderstoodError,
    Push,
    Return,
    Statement,
    Variable,
)

CLOCK = {"time": Named(TIME, "int64_t")}


def method(definitions: Definitions, name: str, struct: str, scope: Scope, is_timed: bool = True) -> Method:
    """The function `name`, given the `struct`; what it is handed on is called as in `scope`.

    If the property is not timed, the time only says when verdicts came. Raises NotUnderstoodError.
    """
    given = given_to(definitions, name, struct)
    handed = [scope.names[each] for each, _ in given if each in scope.names]
    if [each.type for each in handed] != [type_ for _, type_ in given]:
        raise NotUnderstoodError(f"`{name}` is passed a different value")
    names = {each: scope.names[each] for each, _ in given}
    inner = Scope(definitions, names, {})
    taken = [each.tree for each in handed if is_timed or each.tree != TIME]
    parameters_ = tuple(each.name for each in taken if isinstance(each, Variable))
    return Method(parameters_, block(statements(definitions.function(name)), inner, is_timed))


def given_to(definitions: Definitions, name: str, struct: str) -> list[tuple[str, str]]:
    """What a function is given after the struct, with the types of it. Raises NotUnderstoodError."""
    first, *others = parameters(definitions.function(name)) or [None]
    if first is None or first.name != "self" or type_text(first) != f"{struct} *":
        raise NotUnderstoodError(f"`{name}` does not receive what the property stores")
    return [(each.name, type_text(each)) for each in others]


def block(nodes: Sequence[Node], scope: Scope, is_timed: bool = True) -> Block:
    """Statements one after the other, of which each may declare a variable. Raises NotUnderstoodError."""
    found: list[Statement] = []
    rest = list(nodes)
    while rest:
        node = rest.pop(0)
        match node:
            case c_ast.Decl(name=name, init=init) if init is not None:
                value = scope.tree(init)
                if name != "state":
                    _require_type(node, scope)
                    scope = scope.with_name(name, Named(Variable(name), type_text(node)))
                elif type_text(node) != "unsigned":
                    raise not_understood(node)
                else:
                    scope = scope.with_state()
                found.append(Assign(Variable(name), value))
            case c_ast.If(cond=c_ast.FuncCall(name=c_ast.ID(name="occurred")) as noted, iffalse=None):
                found += _occurred(noted, block(node.iftrue.block_items or [], scope, is_timed))
            case _:
                found.append(statement(node, scope, is_timed))
        is_verdict = isinstance(found[-1], Assign) and found[-1].target == VERDICT
        if is_verdict and (not rest or shown(rest.pop(0)) != "self->since = time"):
            raise NotUnderstoodError(f"after `{shown(node)}`, the time of the verdict is not recorded")
        found[-1] = _settled(found[-1])
    return tuple(found)


def _occurred(node: c_ast.FuncCall, full: Block) -> Block:
    """Something is noted with its time, and when there are as many times, more is done."""
    written = re.fullmatch(r"occurred\(self->(\w+), &self->\1_count, (\d+)u, time\)", shown(node) or "")
    if written is None:
        raise not_understood(node)
    count = Apply("len", (Attribute(written[1]),))
    return Push(written[1], TIME), If(Apply("==", (count, Constant(int(written[2])))), full)


def _settled(found: Statement) -> Statement:
    """The assignment of a verdict, which is behind a test for a change if its time is kept."""
    match found:
        case If(Apply("!=", (Attribute("verdict"), before)), (Assign(Attribute("verdict"), verdict) as set_,), ()):
            return set_ if before == verdict else found
        case _:
            return found


def _require_type(node: c_ast.Decl, scope: Scope) -> None:
    """A variable has the type of its value: of one at an opening that of the latest, else it is a double or a time."""
    latest = node.init.iftrue if isinstance(node.init, c_ast.TernaryOp) else node.init
    right = scope.names[latest.name].type if isinstance(latest, c_ast.ID) else "double"
    if type_text(node) != (right if node.name != "time" else "int64_t"):
        raise NotUnderstoodError(f"`{node.name}` is of another type than its value")


def statement(node: Node, scope: Scope, is_timed: bool) -> Statement:
    """One statement. Raises NotUnderstoodError."""
    match node:
        case c_ast.If(cond=guard, iftrue=c_ast.Compound(block_items=then), iffalse=otherwise):
            sides = [block(then or [], scope, is_timed), ()]
            match otherwise:
                case None:
                    pass
                case c_ast.If():
                    sides[1] = (statement(otherwise, scope, is_timed),)
                case c_ast.Compound(block_items=items):
                    sides[1] = block(items or [], scope, is_timed)
                case _:
                    raise not_understood(otherwise)
            return If(scope.tree(guard), *sides)
        case c_ast.Assignment(op="=", lvalue=target, rvalue=value) if isinstance(at := scope.tree(target), Attribute):
            return Assign(at, scope.tree(value))
        case c_ast.Assignment(op="+=", lvalue=target, rvalue=value) if isinstance(at := scope.tree(target), Attribute):
            return Assign(at, Apply("+", (at, scope.tree(value))))
        case c_ast.UnaryOp(op="p++") if shown(node) == "self->invalid++":
            return INVALID
        case c_ast.Return(expr=None):
            return Return(VERDICT)
        case c_ast.FuncCall(name=c_ast.ID(name=function), args=c_ast.ExprList(exprs=[first, *rest])):
            if shown(first) == "self":
                handed = (scope.tree(each) for each in rest)
                return Do(function, tuple(each for each in handed if is_timed or each != TIME))
        case _:
            pass
    raise not_understood(node)


def called(blocks: Iterable[Block]) -> set[str]:
    """The functions that statements call."""
    found: set[str] = set()
    for statement_ in (each for block_ in blocks for each in block_):
        match statement_:
            case If(_, then, otherwise):
                found |= called([then, otherwise])
            case Do(method_):
                found.add(method_)
            case _:
                pass
    return found
