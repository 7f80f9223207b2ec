"""Emitted Python in the small language of step functions, by `ast`: what it consists of, not what it means."""

from __future__ import annotations

import ast
import math
from collections.abc import Sequence
from typing import TypeGuard

from ltlc.assurance.reading.names import FileNames
from ltlc.assurance.reading.trees import (
    Ago,
    Apply,
    Assign,
    Attribute,
    Block,
    Choice,
    Constant,
    Do,
    Elements,
    If,
    Method,
    NotUnderstoodError,
    Part,
    Push,
    Return,
    Statement,
    StepClass,
    Tree,
    Unpack,
    Variable,
    While,
)
from ltlc.dataclass import dataclass

_OPERATORS: dict[type[ast.AST], str] = {
    **dict(zip((ast.Add, ast.Sub, ast.Mult, ast.Div, ast.USub), "+-*/-", strict=True)),
    **dict(zip((ast.And, ast.Or, ast.Not), ("and", "or", "not"), strict=True)),
    **dict(zip((ast.Lt, ast.LtE, ast.Gt, ast.GtE), ("<", "<=", ">", ">="), strict=True)),
    **dict(zip((ast.Eq, ast.NotEq, ast.Is, ast.IsNot), ("==", "!=", "==", "!="), strict=True)),
}
_BUILTINS = frozenset({"abs", "min", "len", "float"})


class PythonFile:
    """An emitted file of Python. Raises NotUnderstoodError if it is not Python."""

    def __init__(self, text: str) -> None:
        try:
            self.tree = ast.parse(text)
        except (SyntaxError, ValueError, RecursionError) as error:
            raise NotUnderstoodError(f"the file is not Python: {error}") from None
        self.names = FileNames(self.tree, text)

    def step_class(self, name: str) -> StepClass:
        """The class called `name`. Raises NotUnderstoodError."""
        definition = self.names.only(name)
        if not isinstance(definition, ast.ClassDef):
            raise NotUnderstoodError(f"`{name}` is not a class")
        if definition.bases or definition.keywords or definition.decorator_list:
            raise NotUnderstoodError(f"the class `{name}` contains more than its methods")
        functions: dict[str, ast.FunctionDef] = {}
        for part in without_docstring(definition.body):
            if _slots(part) is not None:
                continue
            if not isinstance(part, ast.FunctionDef) or part.name in functions:
                raise not_understood(part)
            functions[part.name] = part
        if not functions.keys() >= {"__init__", "step"}:
            raise NotUnderstoodError(f"the class `{name}` has no step")
        return self._of_functions(name, functions)

    def require_slots(self, name: str) -> None:
        """Raise NotUnderstoodError unless the class called `name` has slots for what it sets, and for nothing else."""
        definition = self.names.only(name)
        assert isinstance(definition, ast.ClassDef)
        said = [slots for part in definition.body if (slots := _slots(part)) is not None]
        if said != [sorted({repr(each.attr) for each in ast.walk(definition) if _is_set(each)})]:
            raise NotUnderstoodError(f"the slots of `{name}` are not the attributes that it sets")

    def _of_functions(self, name: str, functions: dict[str, ast.FunctionDef]) -> StepClass:
        start = functions.pop("__init__")
        kept, histories, rest = [], [], []
        for statement in without_docstring(start.body):
            match statement:
                case ast.AnnAssign(ast.Attribute(ast.Name("self"), attribute), _, None):
                    kept.append(attribute)
                case ast.AnnAssign(ast.Attribute(ast.Name("self"), attribute), _, ast.Call() as made):
                    histories.append((attribute, self._samples(made)))
                case _:
                    rest.append(statement)
        methods = {key: self._method(function, function.body) for key, function in functions.items()}
        methods["start"] = self._method(start, rest)
        return StepClass(name, methods, tuple(kept), tuple(histories))

    def _samples(self, made: ast.Call) -> int:
        """How many samples a history holds."""
        match made:
            case ast.Call(ast.Name("deque"), [], [ast.keyword("maxlen", ast.Constant(int(most)))]):
                self.names.imported("deque")
                return most
            case _:
                raise not_understood(made)

    def function(self, name: str) -> Method:
        """The function called `name`, not a method. Raises NotUnderstoodError."""
        definition = self.names.only(name)
        if not isinstance(definition, ast.FunctionDef):
            raise NotUnderstoodError(f"`{name}` is not a function")
        return self._method(definition, definition.body, ())

    def _method(self, function: ast.FunctionDef, body: Sequence[ast.stmt], own: tuple[str, ...] = ("self",)) -> Method:
        given = function.args
        others = (given.posonlyargs, given.kwonlyargs, given.defaults, given.kw_defaults, function.decorator_list)
        names = tuple(argument.arg for argument in given.args)
        if any(others) or given.vararg or given.kwarg or names[: len(own)] != own:
            raise NotUnderstoodError(f"the parameters of `{function.name}` are not plain")
        body = without_docstring(body)
        if function.name == "expire":
            body = _after_the_refusal(body)
        parameters = names[len(own) :]
        stored = (node.id for node in ast.walk(function) if isinstance(node, ast.Name) and not _is_read(node))
        return Method(parameters, _Scope(self.names, frozenset({*parameters, *stored})).block(body))


_REFUSAL = ast.dump(
    ast.parse("if self.due >= NEVER: raise ValueError('times are before 2**62 ns, the year 2116')").body[0]
)


def _after_the_refusal(body: Sequence[ast.stmt]) -> Sequence[ast.stmt]:
    """What a clock step does where one is due; at times that no run has, it is refused, or steps would never end."""
    if not body or ast.dump(body[0]) != _REFUSAL:
        raise NotUnderstoodError("a clock step is taken where none is due")
    return body[1:]


@dataclass(frozen=True)
class _Scope:
    """A method, or a comprehension in it, with the names that are its own."""

    names: FileNames
    variables: frozenset[str]

    def block(self, statements: Sequence[ast.stmt]) -> Block:
        return tuple(map(self.statement, statements))

    def statement(self, node: ast.stmt) -> Statement:
        match node:
            case ast.If(
                ast.Compare(ast.Call(ast.Name("type"), [ast.Name(name)], []), [ast.IsNot()], [ast.Name("float")]),
                [ast.Assign([ast.Name(target)], ast.Call(ast.Name("number"), [ast.Name(given)], [])) as made],
                [],
            ) if name == target == given:  # `number` of a float is that float
                self._builtin("type", "float")
                return self._assigned(made.targets[0], made.value)
            case ast.If(test, body, orelse):
                return If(self.tree(test), self.block(body), self.block(orelse))
            case ast.While(test, body, []):
                return While(self.tree(test), self.block(body))
            case ast.Assign([target], value):
                return self._assigned(target, value)
            case ast.AugAssign(target, ast.Add(), value):
                place = self._target(target)
                return Assign(place, Apply("+", (place, self.tree(value))))
            case ast.Return(ast.Call(ast.Attribute(ast.Name("self"))) as call):
                return Return(self._call(call))
            case ast.Return(ast.expr() as value):
                return Return(self.tree(value))
            case ast.Expr(ast.Call(ast.Attribute(ast.Attribute(ast.Name("self"), history), "append"), [value], [])):
                return Push(history, self.tree(value))
            case ast.Expr(ast.Call() as call):
                return self._call(call)
            case _:
                raise not_understood(node)

    def _assigned(self, target: ast.expr, value: ast.expr) -> Statement:
        match target:
            case ast.Tuple(elts):
                names = tuple(each.id for each in elts if isinstance(each, ast.Name))
                if len(names) == len(elts):
                    return Unpack(names, self.tree(value))
            case _:
                pass
        return Assign(self._target(target), self.tree(value))

    def _target(self, node: ast.expr) -> Variable | Attribute:
        match node:
            case ast.Name(name):
                return Variable(name)
            case ast.Attribute(ast.Name("self"), name):
                return Attribute(name)
            case _:
                raise not_understood(node)

    def _call(self, node: ast.Call) -> Do:
        match node:
            case ast.Call(ast.Attribute(ast.Name("self"), method), arguments, []):
                return Do(method, tuple(map(self.tree, arguments)))
            case _:
                raise not_understood(node)

    def tree(self, node: ast.expr) -> Tree:
        """An expression."""
        match node:
            case ast.Constant(bool() | int() | float() | str() as value):
                return Constant(value)
            case ast.Name(name):
                return Variable(name) if name in self.variables else self.names.value(name)
            case ast.Attribute(ast.Name("self"), name):
                return Attribute(name)
            case ast.Attribute(ast.Name("math"), "inf" | "nan" as name) if "math" not in self.variables:
                self.names.imported("math")
                return Constant(math.inf if name == "inf" else math.nan)
            case ast.UnaryOp(operator, operand) if type(operator) in _OPERATORS:
                return Apply(_OPERATORS[type(operator)], (self.tree(operand),))
            case ast.BinOp(left, operator, right) if type(operator) in _OPERATORS:
                return Apply(_OPERATORS[type(operator)], (self.tree(left), self.tree(right)))
            case ast.BoolOp(operator, values):
                return Apply(_OPERATORS[type(operator)], tuple(map(self.tree, values)))
            case ast.Compare(left, operators, others):
                return self._compared(node, [left, *others], operators)
            case ast.IfExp(test, then, otherwise):
                return Choice(*map(self.tree, (test, then, otherwise)))
            case ast.Tuple(elts):
                return Apply("tuple", tuple(map(self.tree, elts)))
            case ast.Call(ast.Name(function), arguments, []) if function not in self.variables:
                return self._applied(node, function, arguments)
            case ast.Subscript(
                ast.Attribute(ast.Name("self"), history), ast.UnaryOp(ast.USub(), ast.Constant(int(place)))
            ):
                return Ago(history, place - 1)
            case ast.Subscript(
                ast.Call(ast.Name("tuple"), [ast.Attribute(ast.Name("self"), history)], []),
                ast.Slice(ast.UnaryOp(ast.USub(), ast.Constant(int(place))), None, None),
            ) if "tuple" not in self.variables:
                return Ago(history, place - 1, all=True)
            case ast.Subscript(array, ast.Slice(start, stop, None)):
                return Part(self.tree(array), _index(start), _index(stop))
            case _:
                raise not_understood(node)

    def _compared(self, node: ast.expr, operands: Sequence[ast.expr], operators: Sequence[ast.cmpop]) -> Tree:
        """`a < b <= c` is `a < b and b <= c`; `q in (1, 2)` is `q == 1 or q == 2`."""
        match operators, operands:
            case [ast.In()], [first, ast.Tuple([_, *_] as several)]:
                asked = self.tree(first)
                return Apply("or", tuple(Apply("==", (asked, self.tree(each))) for each in several))
            case [ast.LtE()], [first, ast.Name("INFINITY")] if "INFINITY" not in self.variables:
                self.names.value("INFINITY")
                return Apply("measured", (self.tree(first),))
            case [ast.Is()], [ast.Name() as first, ast.Constant(None)]:
                return Apply("missing", (self.tree(first),))
            case _:
                pass
        if not all(type(operator) in _OPERATORS for operator in operators):
            raise not_understood(node)
        found = list(map(self.tree, operands))
        if any(isinstance(each, ast.Is | ast.IsNot) for each in operators) and not _is_verdict(found[-1]):
            raise not_understood(node)
        pairs = zip(operators, found, found[1:], strict=False)
        parts = tuple(Apply(_OPERATORS[type(operator)], (left, right)) for operator, left, right in pairs)
        return parts[0] if len(parts) == 1 else Apply("and", parts)

    def _applied(self, node: ast.expr, function: str, arguments: Sequence[ast.expr]) -> Tree:
        match function, arguments:
            case "any", [ast.GeneratorExp(ast.Constant(True)) as each]:
                self._builtin("any")
                return self._elements(each, is_any=True)
            case "float", [ast.Call(ast.Name("sum"), [ast.GeneratorExp(ast.Constant(1)) as each], [])]:
                self._builtin("float", "sum")
                return self._elements(each, is_any=False)
            case _:
                pass
        if not self.names.is_runtime_function(function):
            if function not in _BUILTINS:
                raise not_understood(node)
            self._builtin(function)
        return Apply(function, tuple(map(self.tree, arguments)))

    def _builtin(self, *names: str) -> None:
        for name in names:
            if name in self.variables or not self.names.builtin(name):
                raise NotUnderstoodError(f"`{name}` is not Python's own")

    def _elements(self, node: ast.GeneratorExp, is_any: bool) -> Elements:
        *first, last = node.generators
        targets = [t.elts if isinstance(t := loop.target, ast.Tuple) else [t] for loop in node.generators]
        arrays = [self._side_by_side(loop.iter) for loop in node.generators]
        is_loop = not any(loop.is_async or loop.ifs for loop in first) and not last.is_async and len(last.ifs) == 1
        fits = all(len(names) == len(items) for names, items in zip(targets, arrays, strict=True))
        inner = tuple(each.id for names in targets for each in names if isinstance(each, ast.Name))
        if not is_loop or not fits or len(set(inner)) < sum(map(len, targets)):
            raise not_understood(node)
        scope = _Scope(self.names, self.variables | set(inner))
        read = tuple(self.tree(array) for items in arrays for array in items)
        return Elements(inner, read, scope.tree(last.ifs[0]), is_any, tuple(map(len, arrays)))

    def _side_by_side(self, items: ast.expr) -> Sequence[ast.expr]:
        match items:
            case ast.Call(ast.Name("zip"), arrays, [ast.keyword("strict", ast.Constant(False))]):
                self._builtin("zip")
                return arrays
            case _:
                return [items]


def _slots(part: ast.stmt) -> list[str] | None:
    """The names of slots, in quotes, if a part of a class is those."""
    match part:
        case ast.Assign([ast.Name("__slots__")], ast.Tuple(names)):
            return sorted(map(ast.unparse, names))
        case _:
            return None


def _index(node: ast.expr | None) -> int | None:
    match node:
        case None:
            return None
        case ast.Constant(int(value)):
            return value
        case ast.UnaryOp(ast.USub(), ast.Constant(int(value))):
            return -value
        case _:
            raise not_understood(node)


def _is_verdict(tree: Tree) -> bool:
    return isinstance(tree, Constant) and not isinstance(tree.value, bool | int | float | str)


def _is_set(node: ast.AST) -> TypeGuard[ast.Attribute]:
    return isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)


def _is_read(name: ast.Name) -> bool:
    return isinstance(name.ctx, ast.Load)


def without_docstring(body: Sequence[ast.stmt]) -> Sequence[ast.stmt]:
    """What a definition does."""
    match body:
        case [ast.Expr(ast.Constant(str())), *rest]:
            return rest
        case _:
            return body


def not_understood(node: ast.AST) -> NotUnderstoodError:
    """That a part of the text has no form in the small language."""
    line = getattr(node, "lineno", None)
    where = "" if line is None else f" in line {line}"
    return NotUnderstoodError(f"`{' '.join(ast.unparse(node).split())}`{where} does not occur in emitted functions")
