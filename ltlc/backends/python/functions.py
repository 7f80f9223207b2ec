"""The runtime's functions as text: those that emitted code calls, with what they need, in their order."""

from __future__ import annotations

import ast
import inspect
from functools import cache

from ltlc.backends.library import needed
from ltlc.runtime import functions


def function_texts(code: str) -> list[str]:
    """The definitions of the functions that `code` calls, and of those that they call."""
    return needed(_definitions(), code, names_used)


@cache
def _definitions() -> dict[str, str]:
    source = inspect.getsource(functions)
    nodes = (node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef))
    return {node.name: ast.get_source_segment(source, node) or "" for node in nodes}


def names_used(code: str) -> set[str]:
    """Every name that code mentions."""
    return {node.id for node in ast.walk(ast.parse(code)) if isinstance(node, ast.Name)}
