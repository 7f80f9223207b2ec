"""What types of emitted C are called in Rust, and what their values are at first."""

from __future__ import annotations

from collections.abc import Mapping

from pycparser.c_ast import ArrayDecl, Constant, Decl, IdentifierType, Node, PtrDecl, TypeDecl

from ltlc.backends.c.types import type_name
from ltlc.backends.rust.names import spelled, struct_name
from ltlc.backends.rust.trees import Trees
from ltlc.program.types import Scalar, Type

_NAMES = {Scalar.BOOL: "bool", Scalar.SINGLE: "f32", Scalar.DOUBLE: "f64"}


def scalar_text(scalar: Scalar, lifetime: str = "") -> str:
    """How the type of one value is written; a string lives as long as `lifetime`."""
    if scalar is Scalar.TEXT:
        return f"&{lifetime}str"
    return _NAMES.get(scalar) or f"{'u' if scalar.is_unsigned else 'i'}{scalar.bits}"


def type_text(type_: Type, lifetime: str = "'a ") -> str:
    """How a type is written; what lies elsewhere lives as long as `lifetime`."""
    name = scalar_text(type_.scalar, lifetime)
    return f"&{lifetime}[{name}]" if type_.is_array else name


SCALARS = {type_name(scalar): scalar for scalar in Scalar if scalar is not Scalar.INTEGER}
"""The types of single values, by how C writes them."""

ARRAYS = {("texts" if s is Scalar.TEXT else f"{name.removesuffix('_t')}s"): s for name, s in SCALARS.items()}
"""What C calls arrays, with the types of their elements."""


class Types:
    """The types of a file, in which properties are called as in `names`, by the names of their structs."""

    def __init__(self, trees: Trees, names: Mapping[str, str]) -> None:
        self._trees, self._names = trees, names
        self._known: dict[str, bool] = {}

    def struct(self, name: str) -> str:
        """The name of a struct."""
        return self._names.get(name) or struct_name(name)

    def borrows(self, name: str) -> bool:
        """Whether values of a struct have parts that lie elsewhere."""
        if name not in self._known:
            self._known[name] = any(map(self._borrows, self._trees.structs[name].decls))
        return self._known[name]

    def _borrows(self, node: Node) -> bool:
        match node:
            case Decl(type=inner) | ArrayDecl(type=inner) | TypeDecl(type=inner):
                return self._borrows(inner)
            case IdentifierType(names=[name]):
                short = self._trees.short(name)
                return short in ARRAYS or (short in self._trees.structs and self.borrows(short))
            case _:
                return isinstance(node, PtrDecl)

    def lifetime(self, name: str) -> str:
        """What stands behind the name of a struct: for how long the parts live that lie elsewhere."""
        return "<'a>" if self.borrows(name) else ""

    def text(self, node: Node, lifetime: str = "'a ") -> str:
        """How a type is written; what lies elsewhere lives as long as `lifetime`."""
        match node:
            case Decl(name="verdict"):
                return "Verdict"
            case Decl(type=inner) | TypeDecl(type=inner):
                return self.text(inner, lifetime)
            case ArrayDecl(type=inner, dim=dim):
                return f"[{self.text(inner, lifetime)}; {self._count(dim)}]"
            case PtrDecl(type=TypeDecl(type=IdentifierType(names=[name]))) if self._is_struct(name):
                return f"&{self.text(node.type, lifetime)}"
            case PtrDecl():
                return scalar_text(Scalar.TEXT, lifetime)
            case IdentifierType(names=[name]):
                short = self._trees.short(name)
                if short == "verdict":
                    return "Verdict"
                if short in ARRAYS:
                    return type_text(Type(ARRAYS[short], is_array=True), lifetime)
                if short in self._trees.structs:
                    return f"{self.struct(short)}{self.lifetime(short)}"
                return "usize" if name == "size_t" else scalar_text(SCALARS[name])
            case _:
                raise TypeError(node)

    def _is_struct(self, name: str) -> bool:
        return self._trees.short(name) in self._trees.structs

    def _count(self, dim: Node) -> str:
        """How many elements an array has."""
        return dim.value if isinstance(dim, Constant) else f"{self._trees.constant(dim.name)} as usize"

    def first(self, node: Node) -> str:
        """The value that C has for 0."""
        match node:
            case Decl(name="verdict"):
                return "Verdict::NotStarted"
            case Decl(type=inner) | TypeDecl(type=inner):
                return self.first(inner)
            case ArrayDecl(type=inner, dim=dim):
                return f"[{self.first(inner)}; {self._count(dim)}]"
            case PtrDecl():
                return '""'
            case IdentifierType(names=[name]):
                short = self._trees.short(name)
                if short == "samples":
                    return self.nothing()
                if short in self._trees.structs:
                    return f"{self.struct(short)}::NEW"
                scalar = SCALARS.get(name)
                simple = {None: "&[]", Scalar.BOOL: "false", Scalar.SINGLE: "0.0", Scalar.DOUBLE: "0.0"}
                return simple.get(scalar, "0")
            case _:
                raise TypeError(node)

    def nothing(self) -> str:
        """Samples of which nothing has come."""
        given = self._trees.files.samples
        flags = (heard.name for heard in given.heard.values() if heard.has_flag)
        members = [*(f"{spelled(n)}: None" for n in given.fields.values()), *(f"{spelled(n)}: false" for n in flags)]
        return f"Samples {{ {', '.join(members)} }}"
