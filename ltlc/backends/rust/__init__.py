"""Monitors in Rust: one file for all properties, without the standard library, a heap or a function of libm.

The functions are those of emitted C, printed as Rust.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath

from ltlc import __version__
from ltlc.backends import c
from ltlc.backends.inputs import origin
from ltlc.backends.names import class_name
from ltlc.backends.rust.code import comment
from ltlc.backends.rust.expressions import verdict_name
from ltlc.backends.rust.functions import FUNCTIONS, ONLY_IN_C, texts
from ltlc.backends.rust.names import spelled, type_names
from ltlc.backends.rust.printer import Printer
from ltlc.backends.rust.trees import Trees
from ltlc.backends.rust.types import Types, type_text
from ltlc.backends.spelling import NotInTargetError
from ltlc.backends.templates import template
from ltlc.backends.trees import INDENT, prose
from ltlc.backends.wording import MEANINGS
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.program.expressions import Apply, Expression, parts
from ltlc.program.functions import ROWS, Exactness, Primitive
from ltlc.program.lowering import has_sample, lowered
from ltlc.program.types import type_of
from ltlc.runtime.times import NEVER
from ltlc.specification.expressions import Field
from ltlc.specification.samples import in_order
from ltlc.specification.specification import Specification

__all__ = ["File", "emit", "file_of"]

PREFIX = "ltlc"
"""What public names begin with in the C that is printed."""

MISSING = frozenset(
    {
        *(primitive for primitive in Primitive if ROWS[primitive].exactness is Exactness.LIBRARY),
        *(Primitive.SQRT, Primitive.NORM, Primitive.SUM, Primitive.MEAN, Primitive.DISTANCE),
    }
)
"""What `core` has no function for."""


@dataclass(frozen=True, slots=True)
class File:
    """The text of a file, and the files of C that it is equivalent to."""

    text: str
    c: c.Files
    fields: Mapping[str, str]
    borrows: bool


def emit(compiled: Sequence[Compiled], specification: Specification) -> str:
    """The file for `compiled`. Raises NotInTargetError."""
    return file_of(compiled, specification).text


def in_c(compiled: Sequence[Compiled], specification: Specification) -> c.Files:
    """The files of C from which Rust is printed. Raises NotInTargetError."""
    for primitive in (p.primitive for each in compiled for whole in _calculated(each) for p in _applied(whole)):
        if primitive in MISSING:
            raise NotInTargetError(f"the {primitive.value}, for which `core` has no function")
    return c.emit(compiled, specification, PREFIX, is_grouped=False)


def _calculated(compiled: Compiled) -> Iterator[Expression]:
    yield from (*compiled.machine.atoms, *compiled.machine.guards)
    for signal in in_order(compiled.specification.inputs()):
        if not isinstance(signal.definition, Field):
            yield from (lowered(signal.definition), has_sample(signal))


def _applied(whole: Expression) -> Iterator[Apply]:
    return (part for part in parts(whole) if isinstance(part, Apply))


def file_of(compiled: Sequence[Compiled], specification: Specification) -> File:
    """The file for `compiled`, with the files of C. Raises NotInTargetError."""
    files = in_c(compiled, specification)
    trees = Trees(files)
    unique = type_names(trees.structs.keys() - {p.name for p in files.properties})
    labels = {p.name: unique.unique(class_name(p.specification.label)) for p in files.properties}
    types = Types(trees, labels)
    given = files.samples
    fields = {name: spelled(name) for name in given.fields.values()}
    fields |= {f"has_{group.name}": fields[given.fields[group.readings[0]]] for group in given.groups}
    fields |= {heard.name: spelled(heard.name) for heard in given.heard.values() if heard.has_flag}
    printer = Printer(trees, types, fields)
    functions = {name: printer.function(name) for name in _printed(trees)}
    of = {name: trees.owner(name) for name in functions}
    tabled = [] if files.table is None else files.table.names
    code = "\n".join(line for text in functions.values() for line in text)
    text = template(__name__, "template.rs.jinja").render(
        about=_about(compiled, specification),
        never=NEVER,
        verdicts=[(verdict_name(verdict), meaning) for verdict, meaning in MEANINGS.items()],
        properties=[
            (prose(p.specification.label), labels[p.name], spelled(p.name), p.signals.name) for p in files.properties
        ],
        samples=list(_samples(files, types, fields)),
        functions=[*texts(code), *("\n".join(functions[name]) + "\n" for name in functions if of[name] is None)],
        structs=[
            {
                "name": types.struct(name),
                "lifetime": types.lifetime(name),
                "about": _described(name, trees),
                "members": [(spelled(m.name), types.text(m), types.first(m)) for m in struct.decls],
                "is_public": name == "monitors" or name in tabled,
                "are_read": name in tabled,
                "begun": printer.beginning(name),
                "methods": [functions[each] for each in functions if of[each] == name],
            }
            for name, struct in trees.structs.items()
            if name != "samples"
        ],
        lifetime=types.lifetime("samples"),
        sizes=trees.sizes,
        called=[trees.short(name) for name in functions],
    )
    return File(text, files, fields, types.borrows("samples"))


def _printed(trees: Trees) -> Iterator[str]:
    """The functions that are printed: not those that Rust has of its own, nor what is written by itself."""
    apart = {"init", *(f"{what}_of" for what in ("verdict", "steps", "invalid", "since", "left_out"))}
    apart |= set() if trees.files.table is None else {f"{trees.files.table.stem}_init"}
    apart |= FUNCTIONS.keys() | ONLY_IN_C
    return (name for name in trees.functions if trees.short(name) not in apart)


def _described(name: str, trees: Trees) -> list[str]:
    of = {p.name: [f"Line {p.specification.line}: {p.specification.text}"] for p in trees.files.properties}
    of["monitors"] = ["The monitors of all properties."]
    return comment("///", *(of.get(name) or trees.about_struct(name)))


def _samples(files: c.Files, types: Types, fields: dict[str, str]) -> Iterator[str]:
    """The members of `Samples`."""
    given = files.samples
    for signal, name in given.fields.items():
        yield from comment("///", origin(signal), indent=INDENT)
        yield f"{INDENT}pub {fields[name]}: Option<{type_text(type_of(signal))}>,"
    for heard in given.heard.values():
        if heard.has_flag:
            yield from comment("///", f"a message on {heard.topic} has come", indent=INDENT)
            yield f"{INDENT}pub {fields[heard.name]}: bool,"


def _about(compiled: Sequence[Compiled], specification: Specification) -> list[str]:
    source = PurePath(specification.source.name).name
    first = f"Runtime monitors for the properties of {source}, made by ltlc {__version__}."
    of_each = [f"{c.specification.label}: {c.specification.text}" for c in compiled]
    return comment("//!", first, *of_each, "No heap, no recursion, no globals, nothing but `core`.")
