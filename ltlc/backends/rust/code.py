"""Rust as text: statements of emitted code, laid out, and comments that hold anything."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from ltlc.backends.operators import layout
from ltlc.backends.statements import Do, If, Statement
from ltlc.backends.trees import INDENT, LINE_LENGTH, prose


def lines(statements: Sequence[Statement], indent: str = INDENT * 2) -> list[str]:
    """The statements as text."""
    return [line for statement in statements for line in _lines(statement, indent)]


def _lines(statement: Statement, indent: str) -> list[str]:
    match statement:
        case If():
            return [*_if(statement, indent, ""), f"{indent}}}"]
        case Do(prefix, code):
            return layout(indent + prefix, code, ";")
        case str():
            return [f"{indent}{statement};"]


def _if(statement: If, indent: str, before: str) -> list[str]:
    suffix = f" {{ // {statement.remark}" if statement.remark else " {"
    text = layout(f"{indent}{before}if ", statement.guard, suffix) + lines(statement.then, indent + INDENT)
    match statement.otherwise:
        case ():
            return text
        case (If() as further,):
            return text + _if(further, indent, "} else ")
        case _:
            return [*text, f"{indent}}} else {{", *lines(statement.otherwise, indent + INDENT)]


def comment(mark: str, *paragraphs: str, indent: str = "") -> list[str]:
    """Paragraphs that may hold anything, as a comment each line of which begins with `mark`."""
    width = LINE_LENGTH - len(indent) - len(mark) - 1
    wrapped = [
        textwrap.wrap(prose(p), width, break_long_words=False, break_on_hyphens=False) or [""] for p in paragraphs
    ]
    text = [line for number, paragraph in enumerate(wrapped) for line in ([""] if number else []) + paragraph]
    return [f"{indent}{mark} {line}".rstrip() for line in text]
