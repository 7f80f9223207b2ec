"""What a header and a source file of emitted C define: types and functions, by their names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import zip_longest
from typing import Any

from pycparser.c_ast import (
    ID,
    ArrayDecl,
    Cast,
    Decl,
    FuncDecl,
    FuncDef,
    IdentifierType,
    Node,
    PtrDecl,
    TypeDecl,
    Typedef,
    Typename,
)

from ltlc.assurance.reading.c.parsing import STANDARD, Directive, Text, difference, parsed, shown
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.backends.c.library import FUNCTIONS, MATHEMATICS, OF_ARRAYS
from ltlc.runtime.times import NEVER

ELEMENTS = {f"{sign}int{bits}s": f"const {sign}int{bits}_t *" for sign in ("", "u") for bits in (8, 16, 32, 64)} | {
    "doubles": "const double *",
    "floats": "const float *",
    "bools": "const bool *",
    "texts": "const char *const *",
}
"""What arrays are called, with what leads to their elements."""

_OF_THE_LIBRARY = frozenset({"INT64_C", "UINT64_C", "INFINITY", "NAN", "true", "false", *STANDARD})
_SOONER = "static int64_t sooner(int64_t left, int64_t right) { return right < left ? right : left; }"
_HEADER = """\
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif
"""
_SOURCE = """\
#include <float.h>
#include <math.h>
#if defined(__FAST_MATH__) || defined(_M_FP_FAST)
#error "compile without -ffast-math: comparisons would not be what the properties say"
#endif
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0
#error "compile without -ffinite-math-only: a NaN would not be noticed"
#endif
#if defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || defined(__NO_SIGNED_ZEROS__)
#error "compile without -funsafe-math-optimizations: numbers would be computed otherwise than the properties say"
#endif
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error "numbers are computed in more precision than they have; for x86, use -msse2 -mfpmath=sse"
#endif
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#endif
"""


class Definitions:
    """The definitions of two texts; what files share is what it has to be. Raises NotUnderstoodError."""

    def __init__(self, header: str, source: str) -> None:
        above = parsed(header)
        below = parsed(source, above.types)
        monitors = [each for each in above.types if each.endswith("_monitors")]
        if not monitors:
            raise NotUnderstoodError("there is no type `…_monitors`")
        self.prefix = monitors[-1].removesuffix("_monitors")
        self._types = above.types
        _require_directives(above, below, self.prefix.upper())
        self.types: dict[str, Any] = {}
        self.functions: dict[str, FuncDef] = {}
        self._prototypes: list[Decl] = []
        for node in (*above.nodes, *below.nodes):
            self._enter(node)
        self._require_declared()
        self._require_shared()

    def _enter(self, node: Node) -> None:
        match node:
            case FuncDef(decl=Decl(name=name)) | Typedef(name=name) if name in _OF_THE_LIBRARY:
                raise NotUnderstoodError(f"`{name}` is that of the C library")
            case Typedef(name=name, type=type_) if name not in self.types:
                self.types[name] = type_.type
            case FuncDef(decl=decl) if decl.name not in self.functions:
                self.functions[decl.name] = node
            case FuncDef() | Typedef():
                raise NotUnderstoodError(f"`{getattr(node, 'name', None) or node.decl.name}` is defined twice")
            case Decl(type=FuncDecl()):
                self._prototypes.append(node)
            case _:
                raise NotUnderstoodError(f"`{shown(node)}` is not defined in emitted files")

    def _require_declared(self) -> None:
        """Functions are declared as they are defined, and those of others in the header."""
        for node in self._prototypes:
            if node.name not in self.functions or difference(node, self.functions[node.name].decl):
                raise NotUnderstoodError(f"`{shown(node)}` is not as it is defined")
        shared = {name for name, node in self.functions.items() if "static" not in node.decl.storage}
        if missing := shared - {node.name for node in self._prototypes}:
            raise NotUnderstoodError(f"`{min(missing)}` is not declared")

    def __contains__(self, name: str) -> bool:
        return name in self.functions or name in self.types

    def _require_shared(self) -> None:
        """Arrays, and the functions that files share, are what they are in all files."""
        arrays = [kind for kind in ELEMENTS if f"{self.prefix}_{kind}" in self.types]
        types = {f"{self.prefix}_{kind}": f"{ELEMENTS[kind]}elements; size_t length;" for kind in arrays}
        texts = {**FUNCTIONS, "sooner": _SOONER}
        for kind in arrays:
            array = f"{self.prefix}_{kind}"
            words = {"array": array, "plural": kind, "pointer": ELEMENTS[kind]}
            texts |= {f"{name}_{kind}": text.format(**words) for name, text in OF_ARRAYS.items()}
        self.shared = frozenset(texts)
        present = [name for name in self.functions if name in texts]
        for name, node in zip(present, self._parsed("\n".join(texts[name] for name in present)), strict=True):
            if difference(self.functions[name], node):
                raise NotUnderstoodError(f"the function `{name}` is not the shared one")
        self.require_types({name: f"typedef struct {{ {members} }} {name};" for name, members in types.items()})

    def know(self, source: str, types: Sequence[str]) -> Mapping[str, FuncDef]:
        """The functions of a file beside these, with its `types`; those that files share are known from now on."""
        found = {
            node.decl.name: node for node in parsed(source, (*self._types, *types)).nodes if isinstance(node, FuncDef)
        }
        self.functions = {**{name: node for name, node in found.items() if name in self.shared}, **self.functions}
        self._require_shared()
        return found

    def _parsed(self, text: str) -> list[Node]:
        return list(parsed(text, self._types).nodes)

    def is_counting(self, name: str) -> bool:
        """Whether `name` is a function that goes through the elements of arrays."""
        kind, _, number = name.rpartition("_")
        return kind in ("any", "count") and number.isdecimal() and name in self.functions

    def require_known(self, name: str) -> None:
        """Raise NotUnderstoodError unless `name` is a function that files share, or one of the C library."""
        if (name in MATHEMATICS) == (name in self) or (name not in MATHEMATICS and name not in self.shared):
            raise NotUnderstoodError(f"`{name}` is wrong")

    def function(self, name: str) -> FuncDef:
        """The function called `name`, which is none that files share. Raises NotUnderstoodError."""
        if name not in self.functions or name in self.shared:
            raise NotUnderstoodError(f"nothing defines `{name}`")
        return self.functions[name]

    def type(self, name: str) -> Any:
        """The struct or enumeration called `name`. Raises NotUnderstoodError."""
        if name not in self.types:
            raise NotUnderstoodError(f"there is no type `{name}`")
        return self.types[name]

    def places(self, texts: Sequence[str]) -> list[str]:
        """Expressions as `shown` has them."""
        (node,) = self._parsed(f"void f(void) {{ {' '.join(f'{text};' for text in texts)} }}")
        assert isinstance(node, FuncDef)
        return [shown(each) or "" for each in node.body.block_items or ()]

    def _require_type(self, name: str, right: Node) -> None:
        place = difference(self.type(name), right)
        if place:
            raise NotUnderstoodError(f"`{shown(place.found)}` in `{name}` is not `{shown(place.right)}`")

    def require_types(self, right: Mapping[str, str]) -> None:
        """Raise NotUnderstoodError unless these types, by their names, are as expected."""
        for name, node in zip(right, self._parsed(" ".join(right.values())), strict=True):
            self._require_type(name, node.type.type)

    def left_open(self, functions: Sequence[str]) -> dict[str, dict[str, Node]]:
        """What stands in each of `functions`, by its name, where that has names that begin with `_`.

        Raises NotUnderstoodError if all else is not the same; what only says that a name is not used is passed over.
        """
        found: dict[str, dict[str, Node]] = {}
        for right in self._parsed("\n".join(functions)):
            function = self.function(right.decl.name)
            nodes = found[right.decl.name] = {}
            pairs = zip_longest([function.decl, *statements(function)], [right.decl, *statements(right)])
            places = (difference(one, other, nodes) for one, other in pairs)
            if place := next(filter(None, places), None):
                said = f"`{shown(place.found)}` in `{right.decl.name}` is not `{shown(place.right)}`"
                raise NotUnderstoodError(said)
        return found


def _require_directives(above: Text, below: Text, constant: str) -> None:
    """What is said to the preprocessor stands before all definitions; what begins in a header ends there, too."""
    head = f"#ifndef {constant}_H\n#define {constant}_H\n{_HEADER}#define {constant}_NEVER INT64_C({NEVER})\n"
    tail = "#ifdef __cplusplus\n}\n#endif\n#endif\n"
    stem = next((each.words[2] for each in below.directives[:1] if len(each.words) == 3), '""')
    maths = "#include <math.h>\n"
    for text, before, after in (
        (above, head, tail),
        (below, f"#include {stem}\n{_SOURCE if _says(below, maths) else _SOURCE.replace(maths, '')}", ""),
    ):
        first, last = (parsed(part).directives for part in (before, after))
        items = text.items()
        found = [*items[: len(first)], *items[len(items) - len(last) :]]
        for item, right in zip(found, (*first, *last), strict=False):
            if not isinstance(item, Directive) or item.words != right.words:
                raise NotUnderstoodError(f"`{_said(item)}` is not a preprocessor directive of emitted files")
        if len(text.directives) != len(first) + len(last):
            raise NotUnderstoodError("the preprocessor directives differ")


def _says(text: Text, line: str) -> bool:
    return parsed(line).directives[0].words in [each.words for each in text.directives]


def _said(item: Directive | Node) -> str | None:
    return " ".join(item.words) if isinstance(item, Directive) else shown(item)


def parameters(definition: FuncDef) -> list[Decl]:
    """What a function is given."""
    given = definition.decl.type.args
    return list(given.params) if given else []


def members(struct: Any) -> dict[str, str]:
    """The members of a struct, with their types as text, in order."""
    return {each.name: type_text(each) for each in struct.decls or ()}


def type_text(declared: Node) -> str:
    """The type of what is declared, without `const`; of a function, that of what it returns."""
    match declared:
        case Decl(type=inner) | FuncDecl(type=inner) | TypeDecl(type=inner) | Typename(type=inner):
            return type_text(inner)
        case IdentifierType(names=names):
            return " ".join(names)
        case PtrDecl(type=inner):
            return f"{type_text(inner)} *"
        case ArrayDecl(type=inner, dim=dim):
            return f"{type_text(inner)}[{shown(dim) or ''}]"
        case _:
            raise NotUnderstoodError(f"`{shown(declared)}` is not a type")


def statements(function: FuncDef) -> list[Node]:
    """The body of a function, without statements that only mark a name as unused."""
    items = function.body.block_items or []
    return [node for node in items if not (isinstance(node, Cast) and isinstance(node.expr, ID))]


_FAULTS = (AssertionError, AttributeError, LookupError, RuntimeError, StopIteration, TypeError, ValueError)
"""What comes of asking a definition for parts that it has not."""


@contextmanager
def shaped() -> Iterator[None]:
    """Within, a definition that has not the parts that it is asked for is not understood."""
    try:
        yield
    except _FAULTS as error:
        raise NotUnderstoodError(f"a definition does not have the form of those in emitted files: {error}") from None
