"""The runtime's functions as text: those that emitted code calls, with what they need, in their order."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterable

from ltlc.runtime import functions


def function_texts(wanted: Iterable[str]) -> list[str]:
    """The definitions of the functions called `wanted` and of those that they call."""
    source = inspect.getsource(functions)
    definitions = {node.name: node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)}
    needed: set[str] = set()

    def need(name: str) -> None:
        if name in definitions and name not in needed:
            needed.add(name)
            for node in ast.walk(definitions[name]):
                if isinstance(node, ast.Name):
                    need(node.id)

    for name in wanted:
        need(name)
    return [ast.get_source_segment(source, node) or "" for name, node in definitions.items() if name in needed]


def names_used(texts: Iterable[str]) -> set[str]:
    """Every name that these texts mention, to find the imports that they need."""
    trees = map(ast.parse, texts)
    return {node.id for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Name)}
