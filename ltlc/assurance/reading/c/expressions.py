"""Expressions of emitted C as terms, with their types: where C would round or convert otherwise, they are refused."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.assurance.reading.c.text import Definitions, conjuncts, shown, type_text
from ltlc.assurance.reading.c.types import (
    INT,
    INTEGERS,
    NUMBERS,
    SIGNED_64,
    TEXT,
    UNSIGNED,
    UNSIGNED_64,
    Typed,
    are_comparable,
    holds,
)
from ltlc.assurance.reading.language import (
    NEVER,
    NONE,
    Apply,
    Attribute,
    Choice,
    Constant,
    Elements,
    NotUnderstoodError,
    Term,
    Variable,
)
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.wire import SINGLES

_RELATIONS = frozenset({"<", "<=", ">", ">=", "==", "!="})
_OF_DOUBLES = {"least": "least", "greatest": "greatest", "gap": "gap", "sqrt": "square_root", "fabs": "abs"}
_OF_THE_LIBRARY = ("sqrt", "fabs", "fabsf")
_OF_COMPONENTS = {"norm": "norm", "roll": "roll", "pitch": "pitch", "yaw": "yaw", "angle": "angle"}
_OF_ARRAYS = {"smallest": "smallest", "largest": "largest", "sum": "sum_of", "median": "median_of"}
_ORDERS = {
    "order_signed": (SIGNED_64, "double"),
    "order_unsigned": (UNSIGNED_64, "double"),
    "order_integers": (SIGNED_64, UNSIGNED_64),
}


def not_understood(node: Node) -> NotUnderstoodError:
    """That a part of the text has no form in the small language."""
    return NotUnderstoodError(f"`{shown(node)}` is nothing that step functions consist of")


@dataclass(frozen=True)
class Scope:
    """What names stand for in a function: variables, members of `self`, other places that are read, by their text."""

    definitions: Definitions
    variables: Mapping[str, Typed]
    members: Mapping[str, str]
    readings: Mapping[str, Typed]

    def with_variable(self, name: str, value: Typed) -> Scope:
        """The scope in which one more variable has been declared. Raises NotUnderstoodError if it was already."""
        if name in self.variables or name == "self":
            raise NotUnderstoodError(f"`{name}` is declared twice")
        return replace(self, variables={**self.variables, name: value})

    def condition(self, node: Node) -> Term:
        """An expression that is true or false."""
        return self._of_type("bool", node)

    def double(self, node: Node) -> Term:
        """An expression of the type `double`."""
        return self._of_type("double", node)

    def _of_type(self, type_: str, node: Node) -> Term:
        found = self.typed(node)
        if found.type != type_:
            raise NotUnderstoodError(f"`{shown(node)}` is no {type_}")
        return found.term

    def typed(self, node: Node) -> Typed:
        """An expression with its type. Raises NotUnderstoodError."""
        if self.readings and (found := self.readings.get(shown(node))):
            return found
        match node:
            case c_ast.Constant():
                return _literal(node)
            case c_ast.ID():
                return self._named(node)
            case c_ast.StructRef(type="->") if _is_id(node.name, "self") and node.field.name in self.members:
                return Typed(Attribute(node.field.name), self.members[node.field.name])
            case c_ast.UnaryOp(op="!"):
                return Typed(Apply("not", (self.condition(node.expr),)), "bool")
            case c_ast.UnaryOp(op="-"):
                return self._negative(node)
            case c_ast.Cast():
                return self._cast(node)
            case c_ast.BinaryOp(op="&&" | "||"):
                parts = (self.condition(node.left), self.condition(node.right))
                return Typed(Apply("and" if node.op == "&&" else "or", parts), "bool")
            case c_ast.BinaryOp(op=op) if op in _RELATIONS:
                return Typed(self._compared(node), "bool")
            case c_ast.BinaryOp(op="+" | "-" | "*" | "/"):
                return self._calculated(node)
            case c_ast.TernaryOp():
                return self._choice(node)
            case c_ast.FuncCall(name=c_ast.ID(), args=c_ast.ExprList()):
                return self._called(node, node.name.name, node.args.exprs)
            case _:
                raise not_understood(node)

    def _named(self, node: c_ast.ID) -> Typed:
        name = node.name
        if name in self.variables:
            return self.variables[name]
        constant = f"{self.definitions.prefix.upper()}_"
        if name == f"{constant}NEVER":
            return Typed(NEVER, SIGNED_64)
        if name.startswith(constant) and name.removeprefix(constant) in Verdict.__members__:
            return Typed(Constant(Verdict[name.removeprefix(constant)]), "verdict")
        if name in ("true", "false"):
            return Typed(Constant(name == "true"), "bool")
        if name in ("INFINITY", "NAN"):
            return Typed(Constant(math.inf if name == "INFINITY" else math.nan), "float")
        if found := re.fullmatch(r"INT(32|64)_(MIN|MAX)", name):
            type_ = f"int{found[1]}_t"
            return Typed(Constant(INTEGERS[type_][found[2] == "MAX"]), type_)
        raise not_understood(node)

    def _negative(self, node: c_ast.UnaryOp) -> Typed:
        found = self.typed(node.expr)
        match found.term:
            case Constant(int() | float() as value) if found.type in (*NUMBERS, INT, SIGNED_64):
                return Typed(Constant(-value), found.type)
        if found.type not in NUMBERS:
            raise not_understood(node)
        return Typed(Apply("negative", (found.term,)), found.type)

    def _cast(self, node: c_ast.Cast) -> Typed:
        type_ = type_text(node.to_type)
        match node.expr:
            case c_ast.StructRef(type=".", name=array, field=c_ast.ID(name="length")) if type_ == "double":
                return Typed(Apply("length_of", (self._any_array(array).term,)), type_)
        found = self.typed(node.expr)
        if type_ == "double" and found.type in NUMBERS and isinstance(found.term, Constant):
            return Typed(found.term, type_)
        if type_ == "double" and (found.type in NUMBERS or found.is_integer):
            return Typed(Apply("double", (found.term,)), type_)
        if type_ in INTEGERS and found.is_integer and all(holds(type_, end) for end in found.within):
            return Typed(found.term, type_)
        raise not_understood(node)

    def _compared(self, node: c_ast.BinaryOp) -> Term:
        match node:
            case c_ast.BinaryOp(left=c_ast.FuncCall(name=c_ast.ID(name=function), args=c_ast.ExprList() as given)):
                if function in _ORDERS and shown(node.right) == "0.0":
                    return self._ordered(node.op, node.left, function, given.exprs)
            case _:
                pass
        left, right = self.typed(node.left), self.typed(node.right)
        if not are_comparable(left, right):
            raise NotUnderstoodError(f"`{shown(node)}` compares two kinds of things")
        return Apply(node.op, (left.term, right.term))

    def _ordered(self, relation: str, node: Node, function: str, arguments: Sequence[Node]) -> Term:
        """An integer and another number, compared exactly by a function, which gives NaN for NaN."""
        if not self.definitions.is_known(function):
            raise not_understood(node)
        left, right = (self._of_type(type_, each) for type_, each in zip(_ORDERS[function], arguments, strict=True))
        return Apply(relation, (left, right))

    def _calculated(self, node: c_ast.BinaryOp) -> Typed:
        left, right = self.typed(node.left), self.typed(node.right)
        is_time = left.type == SIGNED_64 and right.type in (SIGNED_64, INT) and isinstance(right.term, Constant)
        if is_time and node.op in "+-" and isinstance(left.term, Attribute | Variable | Apply):
            return Typed(Apply(node.op, (left.term, right.term)), SIGNED_64)
        if left.type != "double" or right.type != "double":
            raise NotUnderstoodError(f"`{shown(node)}` is not calculated in doubles")
        return Typed(Apply(node.op, (left.term, right.term)), "double")

    def _choice(self, node: c_ast.TernaryOp) -> Typed:
        then, otherwise = self.typed(node.iftrue), self.typed(node.iffalse)
        if then.type != otherwise.type:
            raise not_understood(node)
        return Typed(Choice(self.condition(node.cond), then.term, otherwise.term), then.type)

    def _called(self, node: Node, function: str, arguments: Sequence[Node]) -> Typed:
        if function in ("INT64_C", "UINT64_C"):
            return _wide(node, function, arguments)
        if function in self.variables or (function in self.definitions) == (function in _OF_THE_LIBRARY):
            raise NotUnderstoodError(f"`{function}` is not what it should be")
        if re.fullmatch(r"(any|count)_\d+", function):
            return self._counted(function, arguments)
        if function not in _OF_THE_LIBRARY and not self.definitions.is_known(function):
            raise not_understood(node)
        if function in _OF_DOUBLES:
            return Typed(Apply(_OF_DOUBLES[function], tuple(map(self.double, arguments))), "double")
        if function in _OF_COMPONENTS:
            return Typed(Apply(_OF_COMPONENTS[function], self._components(node, function, arguments)), "double")
        match function.rpartition("_")[0], arguments:
            case "slice", [array, start, stop]:
                return self._slice(function, array, start, stop)
            case of, [array] if of in _OF_ARRAYS:
                return Typed(Apply(_OF_ARRAYS[of], (self._array(function, array).term,)), "double")
            case _:
                pass
        match function, [self.typed(each) for each in arguments]:
            case "fabsf", [Typed(value, "float")]:
                return Typed(Apply("abs", (value,)), "float")
            case "same_text", [Typed(left, type_), Typed(right, other)] if type_ == other == TEXT:
                return Typed(Apply("==", (left, right)), "bool")
            case "sooner", [Typed(left, type_), Typed(right, other)] if type_ == other == SIGNED_64:
                return Typed(Apply("min", (left, right)), SIGNED_64)
        raise not_understood(node)

    def _components(self, node: Node, function: str, arguments: Sequence[Node]) -> tuple[Term, ...]:
        """The doubles in the array that a function is given, with how many these are if there can be any number."""
        match arguments:
            case [c_ast.CompoundLiteral(init=c_ast.InitList(exprs=exprs)) as array, *rest]:
                count = [str(len(exprs))] if function == "norm" else []
                right = len(exprs) == {"angle": 8, "norm": len(exprs)}.get(function, 4)
                if type_text(array.type) == "double[]" and right and [*map(shown, rest)] == count:
                    return tuple(map(self.double, exprs))
            case _:
                pass
        raise not_understood(node)

    def _array(self, function: str, node: Node) -> Typed:
        """An array of the elements that `function` is for."""
        found = self.typed(node)
        if found.type != f"{self.definitions.prefix}_{function.rpartition('_')[2]}":
            raise NotUnderstoodError(f"`{function}` is given another array")
        return found

    def _any_array(self, node: Node) -> Typed:
        found = self.typed(node)
        if not found.type.startswith(f"{self.definitions.prefix}_"):
            raise not_understood(node)
        return found

    def _slice(self, function: str, array: Node, start: Node, stop: Node) -> Typed:
        found = self._array(function, array)
        first, last = self.typed(start), self.typed(stop)
        if not (isinstance(first.term, Constant) and isinstance(last.term, Constant)):
            raise NotUnderstoodError(f"`{shown(start)}` is no index")
        ends = (first.term, NONE if last.term == Constant(2**63 - 1) else last.term)
        return Typed(Apply("slice", (found.term, *ends)), found.type)

    def _counted(self, function: str, arguments: Sequence[Node]) -> Typed:
        """A function that goes through the elements of arrays."""
        definition = self.definitions.function(function)
        given = {}
        for parameter, argument in zip(parameters(definition), arguments, strict=True):
            given[parameter.name] = self.typed(argument)
            if given[parameter.name].type != type_text(parameter):
                raise NotUnderstoodError(f"`{function}` is given another kind of thing")
        inner = Scope(self.definitions, given, {}, {})
        return inner.elements(function, list(definition.body.block_items))

    def elements(self, function: str, statements: list[Node]) -> Typed:
        """What the body of a function that goes through elements returns."""
        is_any, scope = function.startswith("any"), self
        arrays: dict[str, str] = {}
        while isinstance(statements[0], c_ast.Decl) and shown(statements[0]) != "double found = 0.0":
            declared = statements.pop(0)
            scope = scope.with_variable(declared.name, _declared(declared, scope.typed(declared.init)))
        while isinstance(statements[0], c_ast.Cast):
            statements.pop(0)
        if not is_any and shown(statements.pop(0)) != "double found = 0.0":
            raise NotUnderstoodError(f"`{function}` does not begin at 0")
        match statements:
            case [c_ast.For(stmt=c_ast.Compound(block_items=[*inside, c_ast.If(iffalse=None) as guard])) as loop, last]:
                tests = conjuncts(loop.cond)
                lengths = [test.removeprefix("i < ").removesuffix(".length") for test in tests]
                head = f"for (size_t i = 0; {shown(loop.cond)}; i++)"
                ends = ("return true;", "return false") if is_any else ("found += 1.0;", "return found")
                is_right = shown(loop).startswith(f"{head} {{") and shown(last).rstrip(";") == ends[1]
                is_right = is_right and tests == [f"i < {array}.length" for array in lengths]
                if not is_right or shown(guard.iftrue) != f"{{ {ends[0]} }}":
                    raise NotUnderstoodError(f"`{function}` does not go through elements")
                for declared in inside:
                    scope = scope.with_variable(*_element(declared, lengths, scope))
                    arrays[declared.name] = shown(declared.init).removesuffix(".elements[i]")
                return scope.found(arrays, lengths, guard.cond, is_any)
            case _:
                raise NotUnderstoodError(f"`{function}` does not go through elements")

    def found(self, arrays: Mapping[str, str], lengths: Sequence[str], guard: Node, is_any: bool) -> Typed:
        """How many elements, called as in `arrays`, satisfy `guard`, or whether there is one."""
        unread = [array for array in lengths if array not in arrays.values()]
        names = (*arrays, *(f"an element of {array}" for array in unread))
        read = tuple(self.variables[array].term for array in (*arrays.values(), *unread))
        count = Elements(names, read, self.condition(guard))
        return Typed(Apply(">=", (count, Constant(1.0))), "bool") if is_any else Typed(count, "double")


def parameters(definition: c_ast.FuncDef) -> list[c_ast.Decl]:
    """What a function is given."""
    given = definition.decl.type.args
    return list(given.params) if given else []


def _element(declared: Node, arrays: Sequence[str], scope: Scope) -> tuple[str, Typed]:
    """A variable that has the element of an array."""
    match declared:
        case c_ast.Decl(name=name, init=c_ast.ArrayRef() as read):
            array = shown(read).removesuffix(".elements[i]")
            if array in arrays and array in scope.variables and shown(read) == f"{array}.elements[i]":
                struct = scope.definitions.type(scope.variables[array].type)
                (elements, *_) = struct.decls
                if type_text(elements) == f"{type_text(declared)} *":
                    return name, Typed(Variable(name), type_text(declared))
        case _:
            pass
    raise not_understood(declared)


def _declared(declared: c_ast.Decl, value: Typed) -> Typed:
    if type_text(declared) != value.type:
        raise NotUnderstoodError(f"`{declared.name}` is of another type than its value")
    return value


def _is_id(node: Node, name: str) -> bool:
    return isinstance(node, c_ast.ID) and node.name == name


def _wide(node: Node, function: str, arguments: Sequence[Node]) -> Typed:
    type_ = SIGNED_64 if function == "INT64_C" else UNSIGNED_64
    match [shown(each) for each in arguments]:
        case [digits] if re.fullmatch(r"-?\d+", digits) and holds(type_, int(digits)):
            return Typed(Constant(int(digits)), type_)
        case _:
            raise not_understood(node)


def _literal(node: c_ast.Constant) -> Typed:
    text = node.value
    kinds: Sequence[tuple[str, Callable[[], Typed]]] = (
        (r"0|[1-9]\d*", lambda: Typed(Constant(int(text)), INT)),
        (r"(?:0|[1-9]\d*)u", lambda: Typed(Constant(int(text[:-1])), UNSIGNED)),
        (r"\d+\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+", lambda: Typed(Constant(float(text)), "double")),
        (r"(?:\d+\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+)f", lambda: Typed(Constant(float(text[:-1])), "float")),
        (r'"(?:[ -!#-\[\]-~]|\\["\\?]|\\[0-3][0-7]{2})*"', lambda: Typed(Constant(_string(text)), TEXT)),
    )
    for pattern, made in kinds:
        if re.fullmatch(pattern, text):
            found = made()
            if _is_exact(found):
                return found
    raise not_understood(node)


def _is_exact(found: Typed) -> bool:
    """Whether a literal has the value that is written, which for a single is one of its own."""
    value = found.term.value if isinstance(found.term, Constant) else None
    if found.is_integer:
        assert isinstance(value, int)
        return holds(found.type, value)
    return found.type != "float" or (isinstance(value, float) and SINGLES.nearest(value) == value)


def _string(text: str) -> str:
    inside = re.sub(
        r"\\([0-3][0-7]{2})|\\(.)", lambda found: chr(int(found[1], 8)) if found[1] else found[2], text[1:-1]
    )
    try:
        return inside.encode("latin-1").decode()
    except UnicodeDecodeError:
        raise NotUnderstoodError(f"`{text}` is no text") from None
