"""Emitted C as trees, from which Rust is printed: what it defines, and the comments beside that."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property

from pycparser.c_ast import Decl, FuncDef, Node, PtrDecl, Struct, Typedef
from pycparser.c_parser import CParser

from ltlc.backends.c import Files
from ltlc.dataclass import dataclass
from ltlc.program.types import Scalar

_TYPES = ("bool", "size_t", *(f"{scalar.value}_t" for scalar in Scalar if scalar.bits))
_ASIDE = re.compile(
    r'("(?:\\.|[^"\\])*")|/\*.*?\*/|^#ifdef __cplusplus.*?^#endif|^#[^\n]*', re.S | re.M
)  # strings stay, which may hold anything
_REMARK = re.compile(r"/\* (.*) \*/$")


@dataclass(frozen=True)
class Trees:
    """The trees of a header and its source file."""

    files: Files

    @cached_property
    def _lines(self) -> list[str]:
        return (self.files.header + self.files.source).split("\n")

    @cached_property
    def nodes(self) -> list[Node]:
        """All that they define."""
        bare = _ASIDE.sub(lambda found: found[1] or "\n" * found[0].count("\n"), "\n".join(self._lines))
        known = "".join(f"typedef int {name};" for name in _TYPES)
        nodes: list[Node] = CParser().parse(known + bare).ext[len(_TYPES) :]
        return nodes

    @cached_property
    def structs(self) -> dict[str, Struct]:
        """The structs, by the names of their types without the prefix; arrays are none."""
        found = {n.name: n.type.type for n in self.nodes if isinstance(n, Typedef) and isinstance(n.type.type, Struct)}
        return {self.short(name): struct for name, struct in found.items() if not _is_array(struct)}

    @cached_property
    def sizes(self) -> dict[str, str]:
        """How many of something there are at most, by the names of constants without the prefix."""
        found = (n.type.type for n in self.nodes if isinstance(n, Typedef) and self.short(n.name) == "size")
        return {self.constant(each.name): each.value.value for enum in found for each in enum.values.enumerators}

    @cached_property
    def functions(self) -> dict[str, FuncDef]:
        """The functions, by their names."""
        return {node.decl.name: node for node in self.nodes if isinstance(node, FuncDef)}

    @cached_property
    def _prototypes(self) -> dict[str, Decl]:
        return {node.name: node for node in self.nodes if isinstance(node, Decl)}

    def short(self, name: str) -> str:
        """A name without the prefix that all public ones have."""
        return name.removeprefix(f"{self.files.prefix}_")

    def constant(self, name: str) -> str:
        """The name of a constant without the prefix."""
        return name.removeprefix(f"{self.files.prefix.upper()}_")

    @property
    def optional(self) -> Sequence[str]:
        """The functions that may be given no samples: where a table gives runs what comes or the time, these two."""
        return ("take", "go_on") if "take" in self.functions else ()

    def owner(self, function: str) -> str | None:
        """The struct that a function is given a pointer to before all else, without the prefix; None if none."""
        match self.functions[function].decl.type.args.params[0] if function in self.functions else None:
            case Decl(type=PtrDecl(type=type_)) if self.short(type_.type.names[0]) in self.structs:
                return self.short(type_.type.names[0])
            case _:
                return None

    def called(self, name: str) -> str:
        """What a function is called in Rust: one of a property or a table without the name of that."""
        owner = self.owner(name)
        called = name if "static" in self.functions[name].decl.storage else self.short(name)
        return called if owner == "monitors" else called.removeprefix(f"{owner}_")

    def about(self, function: str) -> list[str]:
        """The paragraphs of the comment above a function, or above where it is declared for others."""
        return self._above(self._prototypes.get(function) or self.functions[function])

    def about_struct(self, name: str) -> list[str]:
        """The paragraphs of the comment above a struct."""
        return self._above(self.structs[name])

    def _above(self, node: Node) -> list[str]:
        end = node.coord.line - 1
        while not self._lines[end - 1]:
            end -= 1
        if not self._lines[end - 1].endswith("*/"):
            return []
        start = end - 1
        while not self._lines[start].startswith("/*"):
            start -= 1
        lines = [self._plain(line.strip(" */")) for line in self._lines[start:end]]
        return [" ".join(part.split("\n")) for part in "\n".join(lines).strip().split("\n\n")]

    def _plain(self, line: str) -> str:
        """A comment in which nothing has a prefix."""
        table = "" if self.files.table is None else f"`{self.files.prefix}_{self.files.table.stem}_"
        bare = (line.replace(table, "`") if table else line).replace(f"`{self.files.prefix}_", "`")
        return bare.replace(f"{self.files.prefix.upper()}_", "").replace("NULL", "None")

    def remark(self, line: int) -> str:
        """The comment at the end of a line, if there is one."""
        found = _REMARK.search(self._lines[line - 1])
        return "" if found is None else found[1]


def _is_array(struct: Struct) -> bool:
    return bool(struct.decls) and struct.decls[0].name == "elements"
