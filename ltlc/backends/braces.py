"""Statements as languages with braces write them, laid out."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from ltlc.backends.operators import layout
from ltlc.backends.statements import Do, If, Statement
from ltlc.backends.trees import INDENT


class Braces(NamedTuple):
    """How a language writes the head of an `if`: around its condition, and a remark behind it."""

    before: str
    after: str
    remark: str

    def lines(self, statements: Iterable[Statement], indent: str = INDENT * 2) -> list[str]:
        """The statements as text."""
        return [line for statement in statements for line in self._lines(statement, indent)]

    def _lines(self, statement: Statement, indent: str) -> list[str]:
        match statement:
            case If():
                return [*self._if(statement, f"{indent}if ", indent), f"{indent}}}"]
            case Do(prefix, code):
                return layout(indent + prefix, code, ";")
            case str():
                return [f"{indent}{statement};"]

    def _if(self, statement: If, head: str, indent: str) -> list[str]:
        after = f"{self.after} {self.remark.format(statement.remark)}" if statement.remark else self.after
        text = layout(head + self.before, statement.guard, after) + self.lines(statement.then, indent + INDENT)
        match statement.otherwise:
            case ():
                return text
            case (If() as further,):
                return text + self._if(further, f"{indent}}} else if ", indent)
            case _:
                return [*text, f"{indent}}} else {{", *self.lines(statement.otherwise, indent + INDENT)]
