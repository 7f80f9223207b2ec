"""Expressions and statements of emitted C as trees of the small language; types matter where C converts by itself."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.c.definitions import Definitions, parameters, statements, type_text
from ltlc.assurance.reading.c.parsing import difference, shown
from ltlc.assurance.reading.expressions import Target
from ltlc.assurance.reading.trees import (
    NEVER,
    Ago,
    Apply,
    Attribute,
    Choice,
    Constant,
    Elements,
    NotUnderstoodError,
    Part,
    Tree,
    Variable,
)
from ltlc.dataclass import dataclass
from ltlc.program import functions as f
from ltlc.program.expressions import Apply as Applied
from ltlc.program.expressions import Count, Expression, Literal
from ltlc.program.functions import Primitive
from ltlc.program.types import BOOL, DOUBLE, SIGNED, SINGLE, TEXT, UNSIGNED, Scalar, Type
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.wire import SINGLES, as_double

SCALARS = {f"{scalar.value}_t": scalar for scalar in Scalar if scalar.bits} | {
    "bool": Scalar.BOOL,
    "char *": Scalar.TEXT,
    "float": Scalar.SINGLE,
    "double": Scalar.DOUBLE,
}
"""The types of single values, as they are written."""

PLURALS = {("texts" if s is Scalar.TEXT else f"{name.removesuffix('_t')}s"): name for name, s in SCALARS.items()}
"""What arrays are called, with the types of their elements as they are written."""

_ENDS = {
    "INT32_MIN": Constant(-(2**31), Type(Scalar.INT32)),
    "INT64_MIN": Constant(-(2**63), SIGNED),
    "INT64_MAX": Constant(2**63 - 1, SIGNED),
}
_WORDS = {"&&": "and", "||": "or", "!": "not"}
_CASTS = ("double", "int64_t", "uint64_t")
_OF_COMPONENTS = {"norm": 0, "inside": 0, "distance": 0, "roll": 4, "pitch": 4, "yaw": 4, "angle": 8}
"""The functions of several doubles in one array, with how many there have to be; 0 if the call says how many."""


def plural(type_: Type) -> str:
    """What an array of such a type is called."""
    return next(name for name, element in PLURALS.items() if SCALARS[element] is type_.scalar)


def type_of(prefix: str, type_: Type) -> str:
    """How a type is written, without `const`."""
    return f"{prefix}_{plural(type_)}" if type_.is_array else PLURALS[plural(type_)]


def _spelling(row: f.Row, types: f.Types) -> f.Spelling | None:
    """By the table; a function of arrays has the name of their elements behind its own."""
    match row.c(types):
        case f.OfArray(name):
            return f.Function(f"{name}_{plural(types[-1])}")
        case f.OfDoubles(f.OfArray(name)):
            return f.OfDoubles(f.Function(f"{name}_{plural(types[0])}"))
        case found:
            return found


C = Target(_spelling, converts=False)


def rounded(expression: Expression) -> Expression:
    """An expression as C computes it: of integers of any size it has the doubles nearest to them, before all else."""
    match expression:
        case Applied(Primitive.TO_DOUBLE, (Applied(primitive, arguments),)) if _is_wide(arguments):
            return rounded(Applied(primitive, tuple(map(_double, arguments))))
        case Applied(primitive, arguments):
            return Applied(primitive, tuple(map(rounded, arguments)))
        case Count(_, guard):
            return replace(expression, guard=rounded(guard))
        case _:
            return expression


def _is_wide(arguments: Sequence[Expression]) -> bool:
    return any(argument.type.scalar.is_wide and not argument.type.is_array for argument in arguments)


def _double(argument: Expression) -> Expression:
    match argument:
        case Literal(int() | float() as value):
            return Literal(as_double(value), DOUBLE)
        case _:
            return argument if argument.type == DOUBLE else Applied(Primitive.TO_DOUBLE, (argument,))


def not_understood(node: Node) -> NotUnderstoodError:
    """That a part of the text has no form in the small language."""
    return NotUnderstoodError(f"`{shown(node)}` does not occur in step functions")


@dataclass(frozen=True)
class Named:
    """What a name stands for, and its type as it is written."""

    tree: Tree
    type: str


@dataclass(frozen=True)
class Scope:
    """What names stand for in a function; `readings` are other places that are read, by their text."""

    definitions: Definitions
    names: Mapping[str, Named]
    readings: Mapping[str, Named]

    def tree(self, node: Node) -> Tree:
        """An expression. Raises NotUnderstoodError."""
        if self.readings and (found := self.readings.get(shown(node) or "")):
            return found.tree
        match node:
            case c_ast.Constant():
                return _literal(node)
            case c_ast.ID(name=name) if name in self.names:
                return self.names[name].tree
            case c_ast.ID():
                return self._constant(node)
            case c_ast.StructRef(type="->", name=c_ast.ID(name="self"), field=field):
                return Attribute(field.name)
            case c_ast.ArrayRef():
                return _first(node)
            case c_ast.UnaryOp(op="!" | "-" as operator):
                return Apply(_WORDS.get(operator, operator), (self.tree(node.expr),))
            case c_ast.Cast():
                return self._cast(node)
            case c_ast.BinaryOp():
                return self._operator(node)
            case c_ast.TernaryOp():
                return Choice(self.tree(node.cond), self.tree(node.iftrue), self.tree(node.iffalse))
            case c_ast.FuncCall(name=c_ast.ID(name=name), args=c_ast.ExprList(exprs=arguments)):
                return self._called(node, name, arguments)
            case _:
                raise not_understood(node)

    def _constant(self, node: c_ast.ID) -> Tree:
        name, own = node.name, f"{self.definitions.prefix.upper()}_"
        if name in ("true", "false"):
            return Constant(name == "true", BOOL)
        if name == f"{own}NEVER":
            return NEVER
        if name.startswith(own) and name.removeprefix(own) in Verdict.__members__:
            return Constant(Verdict[name.removeprefix(own)])
        if name in _ENDS:
            return _ENDS[name]
        raise not_understood(node)

    def _cast(self, node: c_ast.Cast) -> Tree:
        type_ = type_text(node.to_type)
        match node.expr:
            case c_ast.StructRef(type=".", name=array, field=c_ast.ID(name="length")) if type_ == "double":
                return Apply("length", (self.tree(array),))
            case c_ast.ID(name="INFINITY" | "NAN" as name) if type_ == "double" and name not in self.names:
                return Constant(math.inf if name == "INFINITY" else math.nan, DOUBLE)
            case inner if type_ in _CASTS:
                return Apply(f"({type_})", (self.tree(inner),))
            case _:
                raise not_understood(node)

    def _operator(self, node: c_ast.BinaryOp) -> Tree:
        if node.op in ("!=", "==") and difference(node.left, node.right) is None:
            measured = Apply("measured", (self.tree(node.left),))
            return measured if node.op == "==" else Apply("not", (measured,))
        left, right = self.tree(node.left), self.tree(node.right)
        match left, node.op, right:
            case Apply(function), _, Constant(0.0) if function.startswith("order_"):
                return Apply(node.op, (left, Constant(0.0)))
            case Apply("(double)", (inner,)), "<=", Constant(math.inf):
                return Apply("measured", (inner,))
            case _, "<=", Constant(math.inf):
                return Apply("measured", (left,))
            case Apply(same, parts), ("&&" | "||"), _ if same == _WORDS[node.op]:
                return Apply(same, (*parts, right))
            case _, ("&&" | "||" | "<" | "<=" | ">" | ">=" | "==" | "!=" | "+" | "-" | "*" | "/"), _:
                return Apply(_WORDS.get(node.op, node.op), (left, right))
            case _:
                raise not_understood(node)

    def _called(self, node: Node, function: str, arguments: Sequence[Node]) -> Tree:
        if function in ("INT64_C", "UINT64_C"):
            return _wide(node, SIGNED if function == "INT64_C" else UNSIGNED, arguments)
        if self.definitions.is_counting(function):
            return self._counted(function, arguments)
        self.definitions.require_known(function)
        if function in _OF_COMPONENTS:
            return Apply(function, self._components(node, function, arguments))
        match function.split("_"), list(map(self.tree, arguments)):
            case ["slice", kind], [array, start, stop] if kind in PLURALS:
                return Part(
                    array, _index(node, start) or None, None if stop == _ENDS["INT64_MAX"] else _index(node, stop)
                )
            case ["sooner"], [Apply("min", times), time]:
                return Apply("min", (*times, time))
            case ["sooner"], times:
                return Apply("min", tuple(times))
            case _, given:
                return Apply(function, tuple(given))

    def _components(self, node: Node, function: str, arguments: Sequence[Node]) -> tuple[Tree, ...]:
        """The doubles in the array that a function is given, with how many these are if there can be any number."""
        match arguments:
            case [c_ast.CompoundLiteral(init=c_ast.InitList(exprs=exprs)) as array, *rest]:
                count = _OF_COMPONENTS[function]
                right = len(exprs) == count if count else [*map(shown, rest)] == [str(len(exprs))]
                if type_text(array.type) == "double[]" and right and len(rest) == (not count):
                    return tuple(map(self.tree, exprs))
            case _:
                pass
        raise not_understood(node)

    def _counted(self, function: str, arguments: Sequence[Node]) -> Tree:
        """A function that goes through the elements of arrays."""
        definition = self.definitions.functions[function]
        given = {}
        for parameter, argument in zip(parameters(definition), arguments, strict=True):
            named = self._named(argument)
            if named.type != type_text(parameter):
                raise NotUnderstoodError(f"`{function}` receives an argument of the wrong kind")
            given[parameter.name] = named
        return Scope(self.definitions, given, {}).elements(definition)

    def _named(self, node: Node) -> Named:
        if found := self.readings.get(shown(node) or ""):
            return found
        match node:
            case c_ast.ID(name=name) if name in self.names:
                return self.names[name]
            case _:
                raise not_understood(node)

    def elements(self, function: c_ast.FuncDef) -> Tree:
        """What the body of a function that goes through elements returns."""
        is_any = type_text(function.decl) == "bool"
        body = statements(function)
        arrays = [each for each in body if isinstance(each, c_ast.Decl) and each.name != "found"]
        kinds = {each.name: type_text(each).removeprefix(f"{self.definitions.prefix}_") for each in arrays}
        loops = list(_loops(body))
        right = _looping(function, self.definitions.prefix, kinds, loops, is_any)
        found = self.definitions.left_open([right])[function.decl.name]
        scope, called = self, {array: f"an element of {array}" for array in kinds}
        for loop in loops:
            for name, array in loop.read.items():
                scope = scope.with_name(name, Named(Variable(name), PLURALS[kinds[array]]))
                called[array] = name
        arrays_ = tuple(self.tree(found[f"_{array}"]) for array in kinds)
        lists = tuple(len(loop.arrays) for loop in loops)
        return Elements(tuple(called.values()), arrays_, scope.tree(found["_guard"]), is_any, lists)

    def with_name(self, name: str, value: Named) -> Scope:
        """The scope in which one more name is known. Raises NotUnderstoodError if it was already."""
        if name in self.names or name in ("self", "state"):
            raise NotUnderstoodError(f"`{name}` is declared twice")
        return replace(self, names={**self.names, name: value})

    def with_state(self) -> Scope:
        """The scope in which the state has been read. Raises NotUnderstoodError if it was already."""
        if "state" in self.names:
            raise NotUnderstoodError("`state` is read twice")
        return replace(self, names={**self.names, "state": Named(Variable("state"), "unsigned")})


def _first(node: c_ast.ArrayRef) -> Ago:
    """The first of the times at which something occurred."""
    written = re.fullmatch(r"self->(\w+)\[self->\1_count % (\d+)u\]", shown(node) or "")
    if written is None:
        raise not_understood(node)
    return Ago(written[1], int(written[2]) - 1)


@dataclass(frozen=True)
class Loop:
    """One of nested loops: the name of its index, the arrays that it goes through, and the arrays by what it reads."""

    index: str
    arrays: tuple[str, ...]
    read: Mapping[str, str]


def _loops(body: Sequence[Node]) -> Iterator[Loop]:
    """The loops in a body, the outermost first; what else they are is compared with what they have to be."""
    for node in body:
        match node:
            case c_ast.For(
                init=c_ast.DeclList(decls=[c_ast.Decl(name=index)]), cond=test, stmt=c_ast.Compound() as inner
            ):
                yield Loop(index, tuple(_tested(test)), dict(_read(inner.block_items or ())))
                yield from _loops(inner.block_items or ())
            case _:
                pass


def _tested(node: Node) -> Iterator[str]:
    """The arrays whose lengths a loop asks for."""
    match node:
        case c_ast.BinaryOp(op="&&", left=left, right=right):
            yield from (*_tested(left), *_tested(right))
        case c_ast.BinaryOp(op="<", right=c_ast.StructRef(name=c_ast.ID(name=array))):
            yield array
        case _:
            raise not_understood(node)


def _read(body: Sequence[Node]) -> Iterator[tuple[str, str]]:
    """What is declared in a loop, each an element of an array, and that array."""
    for node in body:
        match node:
            case c_ast.Decl(name=name, init=c_ast.ArrayRef(name=c_ast.StructRef(name=c_ast.ID(name=array)))):
                yield name, array
            case c_ast.Decl():
                raise not_understood(node)
            case _:
                pass


def _looping(
    function: c_ast.FuncDef, prefix: str, kinds: Mapping[str, str], loops: Sequence[Loop], is_any: bool
) -> str:
    """What the function has to be that goes through arrays of these kinds."""
    declared = [f"const {prefix}_{kind} {array} = _{array};" for array, kind in kinds.items()]
    begin, hit, end = ("", "return true", "false") if is_any else ("double found = 0.0;", "found += 1.0", "found")
    inner = f"if (_guard) {{ {hit}; }}"
    for index, arrays, read in ((loop.index, loop.arrays, loop.read) for loop in reversed(loops)):
        test = " && ".join(f"{index} < {array}.length" for array in arrays)
        types = {name: PLURALS[kinds[array]] for name, array in read.items()}
        constant = {name: f"const {type_}{'' if '*' in type_ else ' '}" for name, type_ in types.items()}
        each = [f"{constant[name]}{name} = {array}.elements[{index}];" for name, array in read.items()]
        inner = f"for (size_t {index} = 0; {test}; {index}++) {{ {' '.join(each)} {inner} }}"
    return f"{shown(function.decl)} {{ {' '.join(declared)} {begin} {inner} return {end}; }}"


def _index(node: Node, tree: Tree) -> int:
    match tree:
        case Constant(int(value)):
            return value
        case Apply("-", (Constant(int(value)),)):
            return -value
        case _:
            raise not_understood(node)


def _wide(node: Node, type_: Type, arguments: Sequence[Node]) -> Tree:
    """What a macro makes of a literal."""
    match arguments:
        case [c_ast.Constant(type="int", value=digits)] if digits.isdecimal():
            found = int(digits)
        case [c_ast.UnaryOp(op="-", expr=c_ast.Constant(type="int", value=digits))] if digits.isdecimal():
            found = -int(digits)
        case _:
            raise not_understood(node)
    if type_.scalar.integers is None or not type_.scalar.integers.has(found):
        raise not_understood(node)
    return Constant(found, type_)


def _literal(node: c_ast.Constant) -> Tree:
    """A literal that has the value that is written; a plain integer has the type of what it stands beside."""
    text: str = node.value
    match node.type:
        case "int" if text.isdecimal() and (text == "0" or text[0] != "0") and int(text) < 2**31:
            return Constant(int(text))
        case "unsigned int" if text[:-1].isdecimal() and text[-1] == "u" and int(text[:-1]) < 2**32:
            return Constant(int(text[:-1]), Type(Scalar.UINT32))
        case "double" if "x" not in text.lower():
            return Constant(float(text), DOUBLE)
        case "float" if text[-1] == "f" and SINGLES.nearest(float(text[:-1])) == float(text[:-1]):
            return Constant(float(text[:-1]), SINGLE)
        case "string" if text.startswith('"'):
            return Constant(_string(node, text[1:-1]), TEXT)
        case _:
            raise not_understood(node)


def _string(node: Node, inside: str) -> str:
    """What a string literal stands for, of which other bytes than those of plain characters are octal."""
    found = bytearray()
    rest = iter(inside)
    for character in rest:
        if character != "\\":
            found += character.encode("ascii")
            continue
        escaped = next(rest)
        if escaped in "01234567":
            found.append(int(escaped + next(rest) + next(rest), 8))
        elif escaped in '"\\?':
            found += escaped.encode()
        else:
            raise not_understood(node)
    try:
        return found.decode()
    except UnicodeDecodeError:
        raise not_understood(node) from None
