"""Emitted files as they are found, and as ltlc emits them now for the same monitors, compared one by one."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
from glob import escape
from html import unescape
from pathlib import Path, PurePath

from ltlc.assurance.afresh import c as c_texts
from ltlc.assurance.afresh import packages, python, rust
from ltlc.assurance.afresh.outcomes import Equal, Unequal
from ltlc.assurance.reading.c.parsing import parsed
from ltlc.backends import ament, c, emit
from ltlc.backends.ament.metadata import Metadata, metadata_of
from ltlc.backends.c import guards as c_guards
from ltlc.backends.trees import prose
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.program.guards import GuardProgram
from ltlc.specification.specification import Specification

MOST_CHARACTERS = 100_000
"""A file may have so many more than twice what is emitted: larger ones are not read."""

OF_C = (".h", ".c", ".hpp")

_MADE_BY = re.compile(r"made by ltlc (\d[\w.+!-]*?)\.?[ *]", re.I | re.A)
_NODE_OF = re.compile(r'\A"""A ROS 2 node that monitors the properties of (.+), made by ltlc ')
_PACKAGE_OF = re.compile(r"<description>Monitors for the properties of (.+?)</description>")


_COMMIT = re.compile(r'^    "commit": (None|"[0-9a-f]{7,40}(, modified)?"),$', re.M)
"""Of a node, in what it was made of."""


class UnusableError(Exception):
    """Files cannot be used as code; the message says why."""


@dataclass(frozen=True)
class Code:
    """What is found of an emitted file, and of those beside it: the texts by name, for which target.

    `surplus` are the names of files in a package that are not text.
    """

    target: str
    stem: str
    texts: Mapping[str, str]
    surplus: Sequence[str] = field(default=())

    @property
    def version(self) -> str | None:
        """The version of ltlc that made the files, as they say."""
        heads = (" ".join(text[:4000].split()) + " " for text in self.texts.values())
        return next((found[1] for found in map(_MADE_BY.search, heads) if found), None)


def code_at(path: Path) -> Code:
    """The code at `path`: a file of Python, one of C with those beside it, or the folder of a package.

    Raises UnusableError.
    """
    if path.is_dir():
        return _package_at(path)
    if path.suffix in OF_C:
        beside = [path.with_suffix(suffix) for suffix in OF_C]
        beside += sorted(path.parent.glob(f"{escape(path.stem)}_guard*.[ch]"))
        return Code("c", path.stem, {p.name: _read(p) for p in beside if p.suffix != ".hpp" or p.exists()})
    text = _read(path)
    if path.suffix == ".rs":
        return Code("rust", path.stem, {path.name: text})
    is_node = re.search(r"^def plan\(", text, re.M) is not None
    return Code("ros2" if is_node else "python", path.stem, {path.name: text})


def _package_at(folder: Path) -> Code:
    if not (folder / "package.xml").is_file():
        raise UnusableError(f"{folder} is not the folder of a package: it has no package.xml")
    names = sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*") if not p.is_dir())
    read = {name: _read(folder / name) for name in names if packages.is_read(name)}
    return Code("ament", folder.name, read, [name for name in names if name not in read])


def _read(path: Path) -> str:
    return text_at(path, "a file of code").replace("\r\n", "\n")


def text_at(path: Path, what: str) -> str:
    """The text of the file at `path`, which is to be `what`. Raises UnusableError."""
    try:
        return path.read_bytes().decode("utf-8")
    except OSError as error:
        raise UnusableError(f"{path} cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise UnusableError(f"{path} is not {what}: it is not UTF-8 text") from None


def emitted(
    code: Code, compiled: Sequence[Compiled], specification: Specification, guards: Sequence[GuardProgram] = ()
) -> Mapping[str, str]:
    """The texts that ltlc emits for the target of `code`, by name, under the name that `code` gives the specification.

    They are by the commit that `code` says. Raises NotInTargetError; UnusableError if the package says nothing of
    itself.
    """
    texts = _emitted(code, compiled, specification, guards)
    return {name: _of_commit(text, code.texts.get(name, "")) for name, text in texts.items()}


def _emitted(
    code: Code, compiled: Sequence[Compiled], specification: Specification, guards: Sequence[GuardProgram]
) -> Mapping[str, str]:
    specification = _called(specification, code)
    match code.target:
        case "c":
            files = c.emit(compiled, specification, code.stem)
            texts = (files.header, files.source, files.wrapper)
            found = dict(zip((f"{code.stem}{suffix}" for suffix in OF_C), texts, strict=True))
            if guards:
                found |= {name: text for guard in c_guards.emit(files, guards) for name, text in guard.texts.items()}
            return found
        case "ament":
            return ament.emit(compiled, specification, (), _metadata(code), guards)
        case _:
            pass
    (name,) = code.texts
    return {name: emit(code.target, compiled, specification, guards)}


def _of_commit(emitted: str, found: str) -> str:
    """What is `emitted`, made by the commit that made what is `found`."""
    own, other = _COMMIT.search(emitted), _COMMIT.search(found)
    if own is None or other is None:
        return emitted
    return f"{emitted[: own.start()]}{other[0]}{emitted[own.end() :]}"


def _metadata(code: Code) -> Metadata:
    try:
        return metadata_of(code.texts["package.xml"])
    except ValueError as error:
        raise UnusableError(f"package.xml cannot be read: {error}") from None


def _called(specification: Specification, code: Code) -> Specification:
    """The specification under the name in the files, after which nodes are named."""
    text, pattern = code.texts.get("package.xml", ""), _PACKAGE_OF
    if code.target == "ros2":
        (text,), pattern = code.texts.values(), _NODE_OF
    found = pattern.search(text)
    own = PurePath(specification.source.name).name
    if found is None:
        return specification
    name = unescape(found[1]) if code.target == "ament" else found[1]
    if name == prose(own):
        return specification
    return replace(specification, source=replace(specification.source, name=name))


def compared(code: Code, right: Mapping[str, str]) -> Iterator[tuple[str, Equal | Unequal]]:
    """Each file, by name, with what comparing it with what ltlc emits finds."""
    taken_apart = (name for name in right if not name.endswith(packages.PROSE))
    if large := [n for n in taken_apart if len(code.texts.get(n, "")) > 2 * len(right[n]) + MOST_CHARACTERS]:
        yield from ((name, Unequal("it is far larger than what ltlc emits")) for name in large)
        return
    if lone := [name for name, text in code.texts.items() if "\r" in text]:
        yield from (
            (name, Unequal("it contains a lone carriage return, which tools interpret differently")) for name in lone
        )
        return
    if code.target == "c":
        yield from _compared_c(code, right)
        return
    if code.target == "rust":
        yield from ((name, rust.compare(code.texts[name], text)) for name, text in right.items())
        return
    for name, text in right.items():
        if name in code.texts:
            yield (
                name,
                python.compare(code.texts[name], text)
                if name.endswith(".py")
                else packages.compare(name, code.texts[name], text),
            )
        elif name not in code.surplus:
            yield name, Unequal("it is missing")
    yield from packages.surplus([name for name in (*code.texts, *code.surplus) if name not in right])


def _compared_c(code: Code, right: Mapping[str, str]) -> Iterator[tuple[str, Equal | Unequal]]:
    """The header, the source file, which knows its types, what wraps them for C++, and the files of guards."""
    header, source, wrapper, *guards = right
    yield header, c_texts.compare(code.texts[header], right[header])
    yield source, c_texts.compare(code.texts[source], right[source], parsed(right[header]).types)
    if wrapper in code.texts:
        yield wrapper, c_texts.compare_tokens(code.texts[wrapper], right[wrapper])
    else:
        yield wrapper, Equal("", not_compared="the C++ header, which is missing")
    types = parsed(right[header]).types
    for name in guards:
        if name in code.texts:
            yield name, c_texts.compare(code.texts[name], right[name], types)
        else:
            yield name, Unequal("it is missing")
        types = (*types, *parsed(right[name], types).types)
