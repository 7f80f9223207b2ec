"""What a package for colcon has beside Python: what is compared of it, what may be added, and its code as one text."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from configparser import ConfigParser
from configparser import Error as ConfigError
from itertools import zip_longest
from pathlib import PurePath
from typing import NamedTuple
from xml.parsers.expat import ExpatError, ParserCreate

import yaml
from yaml import YAMLError

from ltlc.assurance.afresh import python
from ltlc.assurance.afresh.outcomes import Equal, Unequal, instead

_TEXTS = frozenset({".py", ".xml", ".yaml", ".cfg", ".txt", ".md", ".json"})
_CODE = frozenset({".py", ".so", ".pyd", ".pth", ".cfg", ".toml"})
"""What a further file could be run, or decide what is run, by."""
PROSE = (".md", ".json")
"""What a package has that decides nothing, and is not compared."""
MOST_NAMED = 5


def is_read(name: str) -> bool:
    """Whether a file of a package is looked into: text that ltlc makes, recordings apart."""
    path = PurePath(name)
    return path.suffix in _TEXTS and not name.startswith("test/recordings/") and not path.name.startswith(".")


def compare(name: str, found: str, emitted: str) -> Equal | Unequal:
    """Whether a file that is not Python has the same contents."""
    suffix = PurePath(name).suffix
    if suffix in PROSE:
        what = "the runs that `colcon test` replays" if suffix == ".json" else "its preprocessor directives"
        return Equal("", not_compared=what)
    parse, how, not_compared = _PARSERS.get(suffix, (_of_text, "line by line", ""))
    try:
        parts = list(parse(found))
    except (ExpatError, YAMLError, ConfigError) as error:
        return Unequal(f"it cannot be read: {' '.join(str(error).split())}")
    for part, other in zip_longest(parts, parse(emitted)):
        if part is None or other is None or part.said != other.said:
            lines = [each and text.split("\n")[each.line - 1] for each, text in ((part, found), (other, emitted))]
            return Unequal(instead(*lines), found.count("\n") + 1 if part is None else part.line)
    return Equal(how, not_compared=not_compared)


class _Part(NamedTuple):
    """A part of a file, and its line."""

    line: int
    said: tuple[object, ...]


def _of_text(text: str) -> Iterator[_Part]:
    """The lines that are not blank; white space at their beginning counts."""
    return (_Part(number, (line.rstrip(),)) for number, line in enumerate(text.split("\n"), 1) if line.strip())


def _of_xml(text: str) -> list[_Part]:
    """Elements with their attributes, the text between them, instructions. Raises ExpatError."""
    found: list[_Part] = []
    parser = ParserCreate()
    parser.buffer_text = parser.ordered_attributes = True

    def note(*said: object) -> None:
        found.append(_Part(parser.CurrentLineNumber, said))

    def note_text(text: str) -> None:
        if text.strip():
            note("text", text.strip())

    def note_types(*_: object) -> None:
        raise ExpatError("it declares a type of document")

    parser.StartElementHandler = lambda name, attributes: note("begin", name, tuple(attributes))
    parser.EndElementHandler = lambda name: note("end", name)
    parser.ProcessingInstructionHandler = lambda target, data: note("instruction", target, data)
    parser.CharacterDataHandler = note_text
    parser.StartDoctypeDeclHandler = note_types
    parser.Parse(text, True)
    return found


def _of_yaml(text: str) -> Iterator[_Part]:
    """Mappings, sequences and scalars as they begin and end. Raises YAMLError."""
    for event in yaml.parse(text):
        said = (getattr(event, name, None) for name in ("anchor", "tag", "value", "implicit"))
        yield _Part(min(event.start_mark.line, text.count("\n")) + 1, (type(event).__name__, *said))


def _of_cfg(text: str) -> Iterator[_Part]:
    """Sections with their entries. Raises ConfigError."""
    parser = ConfigParser(interpolation=None)
    parser.read_string(text)
    return (_Part(1, (section, *entry)) for section in parser for entry in [(), *parser[section].items()])


_PARSERS: dict[str, tuple[Callable[[str], Iterable[_Part]], str, str]] = {
    ".xml": (_of_xml, "as a tree", "comments"),
    ".yaml": (_of_yaml, "as a tree", "comments"),
    ".cfg": (_of_cfg, "as a tree", "comments"),
}


def surplus(names: Sequence[str]) -> Iterator[tuple[str, Equal | Unequal]]:
    """Files that ltlc does not emit: code is none of a package's, others are named."""
    others = []
    for name in names:
        if PurePath(name).suffix in _CODE and not name.startswith("test/recordings/"):
            yield name, Unequal("ltlc emits no such file")
        else:
            others.append(name)
    if others:
        more = f" and {len(others) - MOST_NAMED:,} more" if len(others) > MOST_NAMED else ""
        yield ", ".join(others[:MOST_NAMED]) + more, Equal("", not_compared="ltlc emits no such file")


def as_one(texts: Mapping[str, str]) -> str:
    """The properties and the runtime of a package as one module, what they import of one another omitted."""
    (properties,) = (name for name in texts if name.count("/") == 1 and name.endswith("/properties.py"))
    package = properties.split("/")[0]
    modules = [name for name in texts if name.startswith(f"{package}/runtime/")]
    body = [each for name in (*modules, properties) for each in python.parsed(texts[name]).body]
    imports, rest = dict[str, ast.stmt](), []
    for each in body:
        if isinstance(each, ast.Import | ast.ImportFrom):
            imports |= {ast.unparse(one): one for one in _one_by_one(each, package)}
        else:
            rest.append(each)
    return ast.unparse(ast.Module([*imports.values(), *rest], []))


def _one_by_one(node: ast.Import | ast.ImportFrom, package: str) -> Iterator[ast.stmt]:
    """An import statement as one for each name, unless it is of the package itself."""
    if isinstance(node, ast.Import):
        yield from (ast.Import([alias]) for alias in node.names)
    elif not (node.module or "").startswith((f"{package}.", "__future__")):
        yield from (ast.ImportFrom(node.module, [alias], node.level) for alias in node.names)
