"""The text of modules of ltlc as parts of one file: their imports gathered, what they import from ltlc dropped."""

from __future__ import annotations

import ast
import importlib.util
import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType

from ltlc.backends.trees import INDENT, LINE_LENGTH
from ltlc.dataclass import dataclass

ROS = ("rclpy", "rcl_interfaces", "diagnostic_msgs", "std_msgs")
"""The packages that a node needs whatever it monitors."""


@dataclass(frozen=True, slots=True)
class Inlined:
    """The text of a module, with its first sentence, without its docstring and its imports."""

    title: str
    text: str


@dataclass(frozen=True, slots=True)
class Import:
    """`import module`, or `from module import name`, where `name` may be `name as alias`."""

    module: str
    name: str | None = None

    @property
    def bound(self) -> str:
        """The name that it gives to what it imports."""
        return self.name.split(" as ")[-1] if self.name else self.module.split(".")[0]


_HEADER = re.compile(r'(?s:""".*?""")?(?:\n|(?:import|from|if TYPE_CHECKING:|[ )]).*\n)*')
"""The docstring and the imports at the top of a module, be they only for types."""

FOR_TYPES = Import("typing", "TYPE_CHECKING")
"""What marks an import as for types only."""


@dataclass(frozen=True, slots=True)
class Module:
    """A module: its part of a file, what it imports and the names that it uses, those of attributes included."""

    part: Inlined
    imports: frozenset[Import]
    names: frozenset[str]


@dataclass(frozen=True)
class Program:
    """Modules as parts of one file; `names` are all that they use, which nothing else in the file may redefine.

    What is imported of ROS goes by `ros_names`.
    """

    parts: tuple[Inlined, ...]
    standard_imports: tuple[str, ...]
    ros_imports: tuple[str, ...]
    ros_names: tuple[str, ...]
    names: frozenset[str]


def inline(modules: Sequence[str], further: Iterable[Import] = ()) -> Program:
    """The program that consists of `modules`, each after what it imports, and needs `further` imports."""
    found = [_module(module) for module in modules]
    imports = {*further, *(i for module in found for i in module.imports)}
    wanted = {i for i in imports - {FOR_TYPES} if i.module != "__future__" and not i.module.startswith("ltlc.")}
    ros = {i for i in wanted if i.module.split(".")[0] in ROS}
    return Program(
        tuple(module.part for module in found),
        tuple(import_lines(wanted - ros)),
        tuple(import_lines(ros)),
        tuple(sorted({i.bound for i in ros})),
        frozenset(name for module in found for name in module.names),
    )


@cache
def _module(module: str) -> Module:
    text = module_text(module)
    code = SourceFileLoader(module, _origin(module)).get_code(module)  # Python's cache: to parse it takes longer
    assert code is not None
    body = _HEADER.sub("", text, count=1)
    header = ast.parse(text.removesuffix(body))
    title = (ast.get_docstring(header) or "").split("\n\n")[0]
    imports = frozenset(i for node in header.body for i in _imports(node))
    names = frozenset([*_names(code), *(i.bound for i in imports)])
    return Module(Inlined(" ".join(title.split()), body.strip("\n")), imports, names)


def module_text(module: str) -> str:
    """The source of a module, which is not imported: there may be no ROS here. Dataclasses are those of Python."""
    text = Path(_origin(module)).read_text(encoding="utf-8")
    return text.replace("from ltlc.dataclass import", "from dataclasses import")


def _origin(module: str) -> str:
    """The path of the source of a module."""
    spec = importlib.util.find_spec(module)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(module)
    return spec.origin


def _imports(node: ast.stmt) -> list[Import]:
    match node:
        case ast.Import(names):
            return [Import(alias.name) for alias in names]
        case ast.ImportFrom(str(module), names):
            return [Import(module, ast.unparse(alias)) for alias in names]
        case _:
            return []


def import_lines(imports: Iterable[Import]) -> list[str]:
    """Import statements as a formatter sorts them: whole modules first."""
    wanted = set(imports)
    lines = [f"import {module}" for module in sorted(i.module for i in wanted if i.name is None)]
    for module in sorted({i.module for i in wanted}):
        names = sorted((i.name for i in wanted if i.module == module and i.name is not None), key=_import_order)
        plain = [name for name in names if " as " not in name]
        if plain:
            lines += _from_import(module, plain)
        lines += [f"from {module} import {name}" for name in names if name not in plain]
    return lines


def _from_import(module: str, names: Sequence[str]) -> list[str]:
    line = f"from {module} import {', '.join(names)}"
    if len(line) <= LINE_LENGTH - len(INDENT):
        return [line]
    return [f"from {module} import (", *(f"{INDENT}{name}," for name in names), ")"]


def _import_order(name: str) -> tuple[bool, bool, str]:
    """Constants, then classes, then functions."""
    return (not name.isupper(), not name[0].isupper(), name.lower())


def _names(code: CodeType) -> Iterator[str]:
    """The names in `code` that are not local, and those of its parts."""
    yield from code.co_names
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _names(inner)
