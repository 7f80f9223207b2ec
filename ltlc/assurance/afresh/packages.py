"""What a package for colcon has beside Python: what is compared of it, what may be added, and its code as one text."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import PurePath

from ltlc.assurance.afresh import python
from ltlc.assurance.afresh.outcomes import Equal, Unequal, instead

_TEXTS = frozenset({".py", ".xml", ".yaml", ".cfg", ".txt", ".md", ".json"})
_CODE = frozenset({".py", ".so", ".pyd", ".pth", ".cfg", ".toml"})
"""What a further file could be run, or decide what is run, by."""
_COMMENTS = {
    ".xml": re.compile(r"<!--.*?-->", re.S),
    ".yaml": re.compile(r"(?:(?<=\s)|^)#.*", re.M),
    ".cfg": re.compile(r"^#.*", re.M),
}
_PROSE = (".md", ".json")
MOST_NAMED = 5


def is_read(name: str) -> bool:
    """Whether a file of a package is looked into: text that ltlc makes, recordings apart."""
    path = PurePath(name)
    return path.suffix in _TEXTS and not name.startswith("test/recordings/") and not path.name.startswith(".")


def compare(name: str, found: str, emitted: str) -> Equal | Unequal:
    """Whether a file that is not Python says the same, line by line."""
    suffix = PurePath(name).suffix
    if suffix in _PROSE:
        what = "the runs that `colcon test` replays" if suffix == ".json" else "what it says to its reader"
        return Equal("", not_compared=what)
    left, right = (list(_lines(text, suffix)) for text in (found, emitted))
    for one, other in zip_longest(left, right):
        if one is None or other is None or one[1] != other[1]:
            number = found.count("\n") + 1 if one is None else one[0]
            return Unequal(instead(one and one[1], other and other[1]), number)
    return Equal("line by line", not_compared="comments" if suffix in _COMMENTS else "")


def _lines(text: str, suffix: str) -> Iterator[tuple[int, str]]:
    """The lines that say something, with their numbers; blanks at their beginning count."""
    if suffix in _COMMENTS:
        text = _COMMENTS[suffix].sub(lambda comment: "\n" * comment[0].count("\n"), text)
    for number, line in enumerate(text.split("\n"), 1):
        if line.strip():
            yield number, line.rstrip()


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
    """The properties and the runtime of a package as one module, what they import of one another left out."""
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
