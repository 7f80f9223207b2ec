"""Functions of a library, as they are written into a file that calls them."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping


def needed(definitions: Mapping[str, str], code: str, called: Callable[[str], set[str]]) -> list[str]:
    """Those of `definitions` that `code` calls, and that these call, in their order."""
    found: set[str] = set()
    todo = [code]
    while todo:
        new = (called(todo.pop()) & definitions.keys()) - found
        found |= new
        todo += (definitions[name] for name in new)
    return [text for name, text in definitions.items() if name in found]


def called_in(code: str) -> set[str]:
    """The functions that code in C or Rust calls, comments and strings aside."""
    bare = re.sub(r'"(?:[^"\\]|\\.)*"|//.*|/\*(?s:.*?)\*/', "", code)
    return set(re.findall(r"(?<![.\w])(\w+)\(", bare))
