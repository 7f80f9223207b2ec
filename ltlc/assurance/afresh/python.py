"""Python compared as trees: whatever Python does not see, and docstrings that nothing reads, makes no difference."""

from __future__ import annotations

import ast
import codecs
import re
import warnings
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from ltlc.assurance.afresh.outcomes import Equal, Unequal, instead

_DEFINITIONS = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
_COOKIE = re.compile(r"^[ \t\f]*#.*?coding[:=][ \t]*([-\w.]+)", re.A)


class NotPythonError(Exception):
    """A text is not Python, or nested more deeply than Python reads; the message says which."""


def parsed(text: str) -> ast.Module:
    """The tree of `text`. Raises NotPythonError."""
    for line in text.split("\n")[:2]:
        cookie = _COOKIE.match(line)
        if cookie and not _is_utf8(cookie[1]):
            raise NotPythonError(f"Python would read it as {cookie[1]}, not as UTF-8")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text)
    except (SyntaxError, ValueError) as error:
        line = f" in line {error.lineno}" if isinstance(error, SyntaxError) and error.lineno else ""
        raise NotPythonError(f"it is not Python{line}: {getattr(error, 'msg', error)}") from None
    except (MemoryError, RecursionError):
        raise NotPythonError("it is nested too deeply") from None


def _is_utf8(name: str) -> bool:
    try:
        return codecs.lookup(name).name == "utf-8"
    except LookupError:
        return False


def compare(found: str, emitted: str) -> Equal | Unequal:
    """Whether the two are the same program."""
    try:
        tree = parsed(found)
    except NotPythonError as error:
        return Unequal(str(error))
    right = parsed(emitted)
    place = _Comparison(_reads_docstring(right)).difference(tree, right)
    if place is None:
        return Equal("as a tree", tuple(_functions(right)), "comments and docstrings")
    return _unequal(place, found, emitted)


def _reads_docstring(tree: ast.Module) -> bool:
    return any(isinstance(node, ast.Name) and node.id == "__doc__" for node in ast.walk(tree))


def _functions(tree: ast.Module | ast.ClassDef, prefix: str = "") -> Iterator[str]:
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            yield from _functions(node, f"{prefix}{node.name}.") if _methods(node) else [prefix + node.name]
        elif isinstance(node, _DEFINITIONS):
            yield prefix + node.name


def _methods(node: ast.ClassDef) -> bool:
    return any(isinstance(each, _DEFINITIONS) for each in node.body)


@dataclass(frozen=True, slots=True)
class _Place:
    """Where two trees differ: the innermost node with a line in each, None after the last, and the function."""

    found: ast.AST | None = None
    emitted: ast.AST | None = None
    function: str = ""


@dataclass(frozen=True, slots=True)
class _Comparison:
    """Two trees side by side; `with_docstring`: that of the module is read by the program itself."""

    with_docstring: bool

    def difference(self, found: ast.AST, emitted: ast.AST) -> _Place | None:
        """The first place where they differ. Nothing here goes deeper than the stack, however the trees are nested."""
        todo: list[tuple[Any, Any, _Place]] = [(found, emitted, _Place())]
        while todo:
            left, right, place = todo.pop()
            if type(left) is not type(right):
                return _at(left, right, place)
            if isinstance(left, ast.AST):
                place = _at(left, right, place)
                pairs = [(getattr(left, f, None), getattr(right, f, None)) for f in left._fields]
                if isinstance(left, (ast.Module, *_DEFINITIONS)):
                    pairs = [(self._said(left, one), self._said(right, other)) for one, other in pairs]
                todo += [(one, other, place) for one, other in reversed(pairs)]
            elif isinstance(left, list):
                if len(left) != len(right):
                    shorter = min(len(left), len(right))
                    todo.append((_Item(left, shorter), _Item(right, shorter), place))
                todo += [(one, other, place) for one, other in reversed(list(zip(left, right, strict=False)))]
            elif isinstance(left, _Item) or repr(left) != repr(right):
                return replace(place, found=left.node, emitted=right.node) if isinstance(left, _Item) else place
        return None

    def _said(self, node: Any, value: Any) -> Any:
        """What a definition consists of, without its docstring."""
        if isinstance(node, ast.Module) and self.with_docstring:
            return value
        match value:
            case [ast.Expr(ast.Constant(str())), *rest] if value is getattr(node, "body", None):
                return rest
        return value


class _Item:
    """What stands in one of two lists only."""

    def __init__(self, items: Sequence[Any], number: int) -> None:
        self.node = items[number] if number < len(items) and isinstance(items[number], ast.AST) else None


def _at(found: Any, emitted: Any, place: _Place) -> _Place:
    if hasattr(found, "lineno"):
        place = replace(place, found=found)
    if hasattr(emitted, "lineno"):
        place = replace(place, emitted=emitted)
    if isinstance(found, _DEFINITIONS):
        place = replace(place, function=f"{place.function}.{found.name}".removeprefix("."))
    return place


def _unequal(place: _Place, found: str, emitted: str) -> Unequal:
    lines = [_line(*each) for each in ((place.found, found), (place.emitted, emitted))]
    if lines[0] == lines[1] and place.found is not None and place.emitted is not None:
        with suppress(RecursionError):
            lines = [ast.unparse(place.found), ast.unparse(place.emitted)]
    number = getattr(place.found, "lineno", found.count("\n") + 1)
    return Unequal(instead(*lines), number, place.function)


def _line(node: ast.AST | None, text: str) -> str | None:
    return None if node is None else text.split("\n")[getattr(node, "lineno", 1) - 1].strip()
