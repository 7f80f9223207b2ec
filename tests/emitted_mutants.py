"""Changes of emitted files, one at a time, all over them: what comparing them with what ltlc emits has to refuse."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import Any

from ltlc.assurance.reading.c.lexing import Token, tokens

_OTHERS: dict[type[ast.AST], type[ast.AST]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.And: ast.Or, ast.Or: ast.And,
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Not: ast.UAdd, ast.USub: ast.UAdd,
}  # fmt: skip
_OPERATORS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&", "+": "-", "-": "+",
    "*": "/", "/": "*", "!": "", "++": "--", "--": "++", "+=": "-=", "-=": "+=", "&": "", "->": ".",
}  # fmt: skip


def is_python(text: str) -> bool:
    """Whether a change is still Python."""
    try:
        ast.parse(text)
    except SyntaxError:
        return False
    return True


def bare(text: str) -> str:
    """A module as a tree, without docstrings: what a change has to change."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            if isinstance(node, ast.Module) and "__doc__" in text:
                continue
            node.body = node.body[1:]
    return ast.dump(tree)


def python_mutants(text: str, share: float = 1.0) -> Iterator[str]:
    """The module with one statement left out, one operator, operand, name or constant changed, over and over.

    Of all changes a `share`, spread over the file.
    """
    tree, passed = ast.parse(text), 0.0
    for node in ast.walk(tree):
        for undo in _changed(node):
            passed += share
            if passed >= 1:
                passed -= 1
                yield ast.unparse(tree)
            undo()


def _changed(node: Any) -> Iterator[Any]:
    """Each change of a node, made; what is given takes it back."""

    def put(owner: Any, name: str, value: Any) -> Any:
        before = getattr(owner, name)
        setattr(owner, name, value)
        return lambda: setattr(owner, name, before)

    for name, value in ast.iter_fields(node):
        match value:
            case [ast.stmt(), *_]:
                for number in range(len(value)):
                    yield put(node, name, [*value[:number], *value[number + 1 :]] or [ast.Pass()])
                    yield put(node, name, [*value[: number + 1], *value[number:]])
            case [ast.expr(), ast.expr(), *_]:
                yield put(node, name, [value[1], value[0], *value[2:]])
                yield put(node, name, value[1:])
            case [ast.cmpop() as operator, *rest]:
                yield put(node, name, [_OTHERS[type(operator)](), *rest])
            case ast.operator() | ast.boolop() | ast.unaryop() if type(value) in _OTHERS:
                yield put(node, name, _OTHERS[type(value)]())
            case bool():
                yield put(node, name, not value)
            case int() | float() if isinstance(node, ast.Constant):
                yield put(node, name, value + 1)
                yield put(node, name, type(value)(value * 2 + 1))
            case str() if isinstance(node, ast.Constant | ast.Name | ast.Attribute | ast.arg | ast.keyword):
                yield put(node, name, f"{value}x")
            case ast.IfExp(body=body):
                yield put(node, name, body)
            case _:
                pass


def c_mutants(text: str) -> Iterator[str]:
    """The file with one token or statement left out or changed, or two parentheses set or taken away, over and over."""
    found = [token for token in tokens(text) if token.text != "\n"]
    places = list(_places(text, found))
    for number, (token, place) in enumerate(zip(found, places, strict=True)):
        end = place + len(token.text)
        for other in _of_c(token):
            yield text[:place] + other + text[end:]
        if token.text == ";":
            begins = next((k for k in range(number - 1, -1, -1) if found[k].text in "{};" or found[k].directive), -1)
            yield text[: places[begins] + len(found[begins].text)] + text[end:]
        if token.text == "(":
            close = _closing(found, number)
            inner = text[end : places[close]]
            yield text[:place] + f" {inner} " + text[places[close] + 1 :]
            yield text[:place] + f"(({inner}))" + text[places[close] + 1 :]


def rust_mutants(text: str) -> Iterator[str]:
    """The file with one token left out or changed, over and over."""
    for found in re.finditer(r"//[^\n]*|\w+|[^\s\w]", text):
        if not found[0].startswith("//"):
            for other in ("", f"{found[0]} {found[0]}", _OPERATORS.get(found[0], f"{found[0]}1")):
                yield text[: found.start()] + other + text[found.end() :]


def regrouped(text: str) -> Iterator[str]:
    """The file with parentheses around two or more operands of each line that has several, over and over."""
    for found in re.finditer(r"(?<![\w\])])[\w.>-]+(?: (?:&&|\|\||[<>=!]=?|==|[-+*/]) [!\w.>-]+)+", text):
        words = list(re.finditer(r"\S+", found[0]))
        for first in range(0, len(words), 2):
            for last in range(first, len(words), 2):
                begin, end = found.start() + words[first].start(), found.start() + words[last].end()
                yield f"{text[:begin]}({text[begin:end]}){text[end:]}"


def _places(text: str, found: list[Token]) -> Iterator[int]:
    place, comment = 0, re.compile(r"(?:\s|/\*.*?\*/|//[^\n]*)*", re.S)
    for token in found:
        skipped = comment.match(text, place)
        place = skipped.end() if skipped else place
        assert text.startswith(token.text, place)
        yield place
        place += len(token.text)


def _of_c(token: Token) -> Iterator[str]:
    yield ""
    if token.text in _OPERATORS:
        yield _OPERATORS[token.text]
    elif re.fullmatch(r"\d+[uU]?", token.text):
        yield f"{int(token.text.rstrip('uU')) + 1}"
    elif re.fullmatch(r"\d[\w.]*", token.text):
        yield f"1{token.text}"
    elif re.fullmatch(r"\w+", token.text):
        yield f"{token.text}_x"
    elif token.text.startswith('"'):
        yield f'"x{token.text[1:]}'


def _closing(found: list[Token], number: int) -> int:
    depth = 0
    for place in range(number, len(found)):
        depth += {"(": 1, ")": -1}.get(found[place].text, 0)
        if not depth:
            return place
    raise AssertionError("an open parenthesis")
