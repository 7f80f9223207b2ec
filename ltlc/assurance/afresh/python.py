"""Python compared as trees: whatever Python does not see, and docstrings that nothing reads, makes no difference."""

from __future__ import annotations

import ast
import codecs
import re
import warnings
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from typing import Any, NamedTuple

from ltlc.assurance.afresh.outcomes import Equal, Unequal, instead

_DEFINITIONS = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
_COOKIE = re.compile(r"^[ \t\f]*#.*?coding[:=][ \t]*([-\w.]+)", re.A)


class NotPythonError(Exception):
    """A text is not Python, or nested more deeply than Python reads; the message says which."""


@lru_cache(maxsize=8)
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
    with_docstring = _reads_docstring(right)
    for one, other in zip(_parts(tree, with_docstring), _parts(right, with_docstring), strict=False):
        if one.said != other.said:
            return _unequal(one, other, found, emitted)
    return Equal("as a tree", tuple(_functions(right)), "comments and docstrings")


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


class _Part(NamedTuple):
    """A part of a tree by its contents, with the innermost node around it that has a line, and the function."""

    said: object
    node: ast.AST | None
    function: str


def _parts(tree: ast.Module, with_docstring: bool) -> Iterator[_Part]:
    """What a tree consists of, in order; the parts of no other tree say the same, nor begin those of another.

    With `with_docstring`, that of the module is read by the program itself. Nothing here goes deeper than the stack.
    """
    todo: list[tuple[Any, ast.AST | None, str]] = [(tree, None, "")]
    while todo:
        each, node, function = todo.pop()
        if isinstance(each, ast.AST):
            node = each if hasattr(each, "lineno") else node
            function = f"{function}.{each.name}".removeprefix(".") if isinstance(each, _DEFINITIONS) else function
            yield _Part(type(each), node, function)
            is_bare = isinstance(each, _DEFINITIONS) or (each is tree and not with_docstring)
            inner = [_bare(value) if is_bare else value for _, value in ast.iter_fields(each)]
        elif isinstance(each, list):
            inner = [*each, _END]
        else:
            yield _Part(repr(each), None if each is _END else node, function)
            continue
        todo += [(value, node, function) for value in reversed(inner)]


_END = object()


def _bare(value: Any) -> Any:
    """What a definition consists of, without its docstring."""
    match value:
        case [ast.Expr(ast.Constant(str())), *rest]:
            return rest
        case _:
            return value


def _unequal(one: _Part, other: _Part, found: str, emitted: str) -> Unequal:
    lines = [_line(each.node, text) for each, text in ((one, found), (other, emitted))]
    if lines[0] == lines[1] and one.node is not None and other.node is not None:
        with suppress(RecursionError):
            lines = [ast.unparse(one.node), ast.unparse(other.node)]
    number = getattr(one.node, "lineno", found.count("\n") + 1)
    return Unequal(instead(*lines), number, one.function)


def _line(node: ast.AST | None, text: str) -> str | None:
    return None if node is None else text.split("\n")[getattr(node, "lineno", 1) - 1].strip()
