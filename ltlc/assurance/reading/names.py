"""What the names of an emitted Python file stand for: only those that are bound once, and to what they have to be."""

from __future__ import annotations

import ast
import builtins
import inspect
import math
import re
from collections.abc import Iterator, Sequence
from functools import cache

from ltlc.assurance.reading.trees import NEVER, Constant, NotUnderstoodError, Tree
from ltlc.runtime import functions
from ltlc.runtime.times import NEVER as NEVER_TIME
from ltlc.semantics.verdicts import Verdict

_IMPORTS = {"math": "math", "deque": "collections", "Fraction": "fractions", "eq": "operator"}


class FileNames:
    """The names that the statements of a file bind; those of Python itself where the file binds none."""

    def __init__(self, tree: ast.Module, text: str) -> None:
        self.bound: dict[str, list[ast.stmt]] = {}
        for statement in tree.body:
            for name in _bound(statement):
                self.bound.setdefault(name, []).append(statement)
        lines = [text.count("\n", 0, found.start()) + 1 for found in re.finditer(r"\bglobal\b", text)]
        for statement in tree.body:  # only some have the word, and to look at all parts of a node takes long
            if any(statement.lineno <= line <= (statement.end_lineno or line) for line in lines):
                self._rebound(statement)
        self._checked: set[str] = set()

    def _rebound(self, statement: ast.stmt) -> None:
        """Note what functions in `statement` bind outside of themselves."""
        for node in ast.walk(statement):
            for name in node.names if isinstance(node, ast.Global) else ():
                self.bound.setdefault(name, []).append(ast.Pass())

    def only(self, name: str) -> ast.stmt:
        """The one statement that binds `name`. Raises NotUnderstoodError if there is none, or another."""
        match self.bound.get(name, ()):
            case [statement]:
                return statement
            case []:
                raise NotUnderstoodError(f"nothing defines `{name}`")
            case _:
                raise NotUnderstoodError(f"`{name}` is defined twice")

    def builtin(self, name: str) -> bool:
        """Whether `name` is Python's own."""
        return hasattr(builtins, name) and name not in self.bound

    def value(self, name: str) -> Tree:
        """The constant that `name` stands for. Raises NotUnderstoodError if it is none of those that are known."""
        match self.only(name):
            case ast.Assign([ast.Name()], ast.Attribute(ast.Name("math"), "inf")) if name == "INFINITY":
                self.imported("math")
                return Constant(math.inf)
            case ast.Assign([ast.Name()], value) if name == "NEVER" and _integer(value) == NEVER_TIME:
                return NEVER
            case ast.Assign([ast.Tuple(elts)], ast.Name("Verdict")):
                place = [isinstance(each, ast.Name) and each.id == name for each in elts].index(True)
                return Constant(self._verdicts()[place])
            case _:
                raise NotUnderstoodError(f"`{name}` is not a constant of a monitor")

    def _verdicts(self) -> list[Verdict]:
        """The verdicts in the order in which their class has them."""
        match self.only("Verdict"):
            case ast.ClassDef(body=body):
                values = [s.value for s in body if isinstance(s, ast.Assign)]
                texts = [str(value.value) for value in values if isinstance(value, ast.Constant)]
                known = {verdict.value: verdict for verdict in Verdict}
                if set(texts) == set(known) and len(texts) == len(known):
                    return [known[text] for text in texts]
            case _:
                pass
        raise NotUnderstoodError("`Verdict` does not have the verdicts")

    def imported(self, name: str) -> None:
        """Raises NotUnderstoodError if `name` is not imported from where it has to be."""
        match self.only(name):
            case ast.Import(aliases) if _plainly(name, aliases) and _IMPORTS[name] == name:
                return
            case ast.ImportFrom(module, aliases, 0) if _plainly(name, aliases) and module == _IMPORTS[name]:
                return
        raise NotUnderstoodError(f"`{name}` is not that of the module `{_IMPORTS[name]}`")

    def is_runtime_function(self, name: str) -> bool:
        """Whether `name` is a function of the runtime.

        Raises NotUnderstoodError if the file has something else under its name, or under that of one that it calls.
        """
        known = _runtime_functions()
        if name not in known:
            return False
        if name not in self._checked:
            self._checked.add(name)
            definition = self.only(name)
            if ast.dump(definition) != known[name]:
                raise NotUnderstoodError(f"the function `{name}` is not that of the runtime")
            for used in {node.id for node in ast.walk(definition) if isinstance(node, ast.Name)}:
                if used in _IMPORTS:
                    self.imported(used)
                elif hasattr(builtins, used) and not self.builtin(used):
                    raise NotUnderstoodError(f"`{used}` is not Python's own")
                else:
                    self.is_runtime_function(used)
        return True


def recalls(name: str, called: str, words: Sequence[str]) -> bool:
    """Whether `name` is one of `words` or what is `called` so, or that with a number behind it."""
    return any(name == each or re.fullmatch(re.escape(each) + r"_\d+", name) for each in (*words, called))


@cache
def _runtime_functions() -> dict[str, str]:
    tree = ast.parse(inspect.getsource(functions))
    return {node.name: ast.dump(node) for node in tree.body if isinstance(node, ast.FunctionDef)}


def _bound(statement: ast.stmt) -> Iterator[str]:
    """The names that a statement of the file binds."""
    if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield statement.name
        return
    for node in ast.walk(statement):
        match node:
            case ast.Name(name, ast.Store() | ast.Del()):
                yield name
            case ast.alias(name, alias):
                yield alias or name.split(".")[0]
            case ast.FunctionDef(name) | ast.ClassDef(name):
                yield name
            case _:
                pass


def _plainly(name: str, aliases: list[ast.alias]) -> bool:
    return any(alias.name == name and alias.asname is None for alias in aliases)


def _integer(node: ast.expr) -> int | None:
    """The integer that a literal, or a literal shifted, is."""
    match node:
        case ast.Constant(int(value)):
            return value
        case ast.BinOp(ast.Constant(int(value)), ast.LShift(), ast.Constant(int(places))) if 0 <= places < 100:
            return value << places
    return None
