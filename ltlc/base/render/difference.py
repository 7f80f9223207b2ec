"""What changes in a text, as a unified diff, which `patch` and `git apply` take."""

from __future__ import annotations

from difflib import unified_diff
from io import StringIO


def difference(name: str, before: str, after: str) -> str:
    """The diff from one text of the file `name` to another; empty if they are the same."""
    one, other = ([*StringIO(text, newline="\n")] for text in (before, after))
    lines = unified_diff(one, other, name, name)
    return "".join(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines)
