"""The text of emitted C as definitions, each with its name: what the preprocessor would do is done here, or refused."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

from pycparser.c_ast import BinaryOp, Decl, FuncDef, Node, Typedef
from pycparser.c_generator import CGenerator
from pycparser.c_parser import CParser, ParseError

from ltlc.assurance.reading.c.lexing import tokens
from ltlc.assurance.reading.language import NotUnderstoodError
from ltlc.runtime.times import NEVER
from ltlc.specification.functions_in_c import FUNCTIONS, OF_ARRAYS

_COMMENTS = re.compile(r'("(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\')|/\*.*?\*/|//[^\n]*', re.S)
_PARTS = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|[{};]')
_DIRECTIVES = [
    re.compile(rf"^{pattern}$", re.M)
    for pattern in (
        r'#include (?:"\w[^"\n]*\.h"|<(?:float|math|stdbool|stddef|stdint)\.h>)',
        r'#if defined\(__FAST_MATH__\) \|\| defined\(_M_FP_FAST\)\n#error "[^"\n]*"\n#endif',
        r"#if defined\(__ASSOCIATIVE_MATH__\) \|\| defined\(__RECIPROCAL_MATH__\) \|\| defined\(__NO_SIGNED_ZEROS__\)"
        r'\n#error "[^"\n]*"\n#endif',
        r'#if defined\(__FINITE_MATH_ONLY__\) && __FINITE_MATH_ONLY__ != 0\n#error "[^"\n]*"\n#endif',
        r'#if defined\(FLT_EVAL_METHOD\) && FLT_EVAL_METHOD != 0\n#error "[^"\n]*"\n#endif',
        r"#ifdef __clang__\n#pragma STDC FP_CONTRACT OFF\n#endif",
        r'#ifdef __cplusplus\nextern "C" \{\n#endif',
        r"#ifdef __cplusplus\n\}\n#endif",
        rf"#define [A-Z]\w*_NEVER INT64_C\({NEVER}\)",
    )
]
"""All that is said to the preprocessor; a header says besides that it is read once."""
_GUARD = re.compile(r"\A\s*#ifndef (\w+_H)\n#define \1$(.*)^#endif\s*\Z", re.M | re.S)

STANDARD = ("bool", "size_t", *(f"{sign}int{bits}_t" for sign in ("", "u") for bits in (8, 16, 32, 64)))
"""Types of the C library that are used."""

_MACROS = frozenset({"INT64_C", "UINT64_C", "INFINITY", "NAN", "true", "false"})
_SOONER = "static int64_t sooner(int64_t left, int64_t right) { return right < left ? right : left; }"


class Definitions:
    """What a header and a source file define: types and functions. Raises NotUnderstoodError."""

    def __init__(self, header: str, source: str) -> None:
        guarded = _GUARD.search(_without_comments(header))
        if guarded is None:
            raise NotUnderstoodError("the header is not read once")
        self._texts: dict[str, str] = {}
        for text in (guarded[2], _without_comments(source)):
            for name, item in _items(_preprocessed(text)):
                if name in _MACROS:
                    raise NotUnderstoodError(f"`{name}` is that of the C library")
                if name in self._texts:
                    raise NotUnderstoodError(f"`{name}` is defined twice")
                self._texts[name] = item
        types = [name for name, text in self._texts.items() if text.startswith("typedef")]
        self.types = tuple(types)
        self._before = "".join(f"typedef int {name};" for name in (*STANDARD, *types))
        self._known = _known_functions(self._only("_monitors"))

    def _only(self, end: str) -> str:
        """What stands before `end` in the name of the one type that ends so."""
        found = [name.removesuffix(end) for name in self.types if name.endswith(end)]
        if not found:
            raise NotUnderstoodError(f"there is no type `…{end}`")
        return found[-1]

    @property
    def prefix(self) -> str:
        """What all public names begin with."""
        return self._only("_monitors")

    def __contains__(self, name: str) -> bool:
        return name in self._texts

    @property
    def functions(self) -> list[str]:
        """The names of all functions."""
        return [name for name in self._texts if name not in self.types]

    def mentions(self, name: str, pattern: str) -> bool:
        """Whether the text of a definition matches."""
        return re.search(pattern, self._texts[name]) is not None

    def is_known(self, name: str) -> bool:
        """Whether `name` is a function that files share. Raises NotUnderstoodError if it is not word for word."""
        if name not in self._known:
            return False
        if name not in self._texts or _tokens(self._texts[name]) != _tokens(self._known[name]):
            raise NotUnderstoodError(f"the function `{name}` is not that which files share")
        for other in set(re.findall(r"(\w+)\(", self._known[name])) & self._known.keys() - {name}:
            self.is_known(other)
        return True

    def function(self, name: str, of: str | None = None) -> FuncDef:
        """The function called `name`; what it does to the property `of`, as to `self`. Raises NotUnderstoodError."""
        if name not in self._texts or self.is_known(name):
            raise NotUnderstoodError(f"nothing defines `{name}`")
        found = self._parsed(name, of)
        if not isinstance(found, FuncDef):
            raise NotUnderstoodError(f"`{name}` is no function")
        return found

    def type(self, name: str) -> Any:
        """The struct or enumeration called `name`. Raises NotUnderstoodError."""
        found = self._parsed(name) if name in self._texts else None
        if not isinstance(found, Typedef):
            raise NotUnderstoodError(f"there is no type `{name}`")
        return found.type.type

    def _parsed(self, name: str, of: str | None = None) -> Node:
        before = self._before.replace(f"typedef int {name};", "")
        text = self._texts[name] if of is None else self._texts[name].replace(f"monitors->{of}.", "self->")
        try:
            return CParser().parse(before + text).ext[-1]
        except (ParseError, RecursionError) as error:
            raise NotUnderstoodError(f"`{name}` is not C: {error}") from None


def members(struct: Any) -> dict[str, str]:
    """The members of a struct, with their types as text, in order."""
    return {each.name: type_text(each) for each in struct.decls or ()}


def type_text(declared: Any) -> str:
    """The type of what is declared, without `const`."""
    generated: str = CGenerator().visit(declared.type) if isinstance(declared, Decl) else CGenerator().visit(declared)
    words = re.sub(rf"\b(?:const|{declared.name})\b" if isinstance(declared, Decl) else r"\bconst\b", "", generated)
    return " ".join(words.replace("*", " * ").split()).replace(" [", "[")


def shown(node: Node) -> str:
    """`node` in one line."""
    return " ".join(CGenerator().visit(node).split())


@contextmanager
def shaped() -> Iterator[None]:
    """Within, a definition that has not the parts that it is asked for is not understood."""
    try:
        yield
    except (AssertionError, AttributeError, IndexError, KeyError, RecursionError, TypeError, ValueError) as error:
        raise NotUnderstoodError(f"a definition has another shape than those that files have: {error}") from None


def conjuncts(node: Node) -> list[str]:
    """The parts of an `&&`, as text."""
    return _parts(node, "&&")


def disjuncts(node: Node) -> list[str]:
    """The parts of an `||`, as text."""
    return _parts(node, "||")


def _parts(node: Node, operator: str) -> list[str]:
    if isinstance(node, BinaryOp) and node.op == operator:
        return [*_parts(node.left, operator), *_parts(node.right, operator)]
    return [shown(node)]


def _without_comments(text: str) -> str:
    if "??" in text or "\\\n" in text or "%:" in text:
        raise NotUnderstoodError("trigraphs, digraphs and lines that go on are not read")
    return _COMMENTS.sub(lambda found: found[1] or " " + "\n" * found[0].count("\n"), text)


def _preprocessed(text: str) -> str:
    text = re.sub(r"[ \t]+$", "", text, flags=re.M)
    for directive in _DIRECTIVES:
        text = directive.sub("", text)
    left = re.search(r"^\s*#.*|.*\b_Pragma\b.*", text, re.M)
    if left:
        raise NotUnderstoodError(f"`{left[0].strip()}` is nothing that files say to the preprocessor")
    return text


def _items(text: str) -> Iterator[tuple[str, str]]:
    """Each definition with its name; prototypes, which define nothing, are left out."""
    depth = begin = 0
    for found in _PARTS.finditer(text):
        depth += {"{": 1, "}": -1}.get(found[0], 0)
        item = text[begin : found.end()].strip()
        is_function = found[0] == "}" and not item.startswith("typedef")
        if depth or not (found[0] == ";" or is_function):
            continue
        begin = found.end()
        if item.startswith("typedef"):
            yield re.findall(r"\w+", item)[-1], item
        elif is_function:
            yield (re.findall(r"(\w+)\s*\(", item) or [""])[0], item
        elif not re.fullmatch(r"(?:static )?\w[\w\s*]*\([^(){}=]*\)\s*;", item):
            raise NotUnderstoodError(f"`{item}` is nothing that files define")
    if text[begin:].strip():
        raise NotUnderstoodError(f"`{text[begin:].strip()[:40]}` is nothing that files define")


def _tokens(text: str) -> list[str]:
    return [token.text for token in tokens(text)]


@lru_cache(maxsize=8)
def _known_functions(prefix: str) -> Mapping[str, str]:
    """The functions that files share, of arrays of whatever elements."""
    plurals = [f"{sign}int{bits}s" for sign in ("", "u") for bits in (8, 16, 32, 64)]
    of_arrays = {
        f"{name}_{plural}": text.format(array=f"{prefix}_{plural}", plural=plural)
        for name, text in OF_ARRAYS.items()
        for plural in ("doubles", "floats", "bools", "texts", *plurals)
    }
    return {n: _without_comments(t) for n, t in {**FUNCTIONS, **of_arrays, "sooner": _SOONER}.items()}
