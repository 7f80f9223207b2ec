"""From the text of a specification to its typed form: parse, resolve names, check types."""

from __future__ import annotations

import sys
from codecs import BOM_UTF8
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.language.names import Checker
from ltlc.frontend.language.resolve import checker_of, sound_part
from ltlc.frontend.syntax.parse import parse
from ltlc.frontend.syntax.tree import Declaration, ObjectFromTopic, SyntaxTree
from ltlc.inputs.messages.definitions import BadPath, MessageTypes, read_by_packs, shipped
from ltlc.semantics.encodings import EPISODE, Encoding
from ltlc.specification.specification import Specification

__all__ = ["ReadText", "load", "load_text", "read", "read_source", "read_text"]

MAX_BYTES = 1_000_000
"""A longer file is not a specification."""

STDIN = Path("-")
"""What is read from standard input."""


def load(
    path: str | Path, message_paths: Sequence[str] = (), encoding: Encoding = EPISODE
) -> tuple[Specification | None, list[Diagnostic]]:
    """The specification in the file at `path`, or None, and all findings about it, errors and warnings.

    The path `-` is standard input. `message_paths` are folders with `.msg` files or ROS packages, beside the messages
    of ROS 2 Jazzy. Under `encoding` the bounds on time have to have clocks.
    """
    read = read_source(Path(path))
    return (None, [read]) if isinstance(read, Diagnostic) else load_text(read, message_paths, encoding)


def load_text(
    source: Source, message_paths: Sequence[str] = (), encoding: Encoding = EPISODE, recordings: Iterable[Path] = ()
) -> tuple[Specification | None, list[Diagnostic]]:
    """The specification that `source` states, which is about `recordings`; otherwise as `load`."""
    types, problems = types_for(source, message_paths, recordings)
    found = read(source, types, encoding)
    if not source.text.strip():
        return None, found.diagnostics
    diagnostics = in_order([*problems, *found.diagnostics])
    failed = found.checker.has_failed or any(d.severity is Severity.ERROR for d in diagnostics)
    return (None if failed else found.sound), diagnostics


@dataclass(frozen=True, slots=True)
class ReadText:
    """A text as far as it can be read: its tree, what looked up the names in it, and all findings about it.

    `sound` is the specification of those of its properties that have no error.
    """

    tree: SyntaxTree
    checker: Checker
    sound: Specification
    diagnostics: list[Diagnostic]


def read(source: Source, types: MessageTypes, encoding: Encoding = EPISODE) -> ReadText:
    """As much of `source` as can be read, errors or not."""
    tree, syntax_errors = parse(source)
    checker = checker_of(source, tree, types, encoding)
    sound = sound_part(checker, tree)
    if not source.text.strip():
        return ReadText(tree, checker, sound, [diagnostic("LTL904", source, Span(0, 0), "the file is empty")])
    return ReadText(tree, checker, sound, in_order([*syntax_errors, *checker.diagnostics]))


def types_for(
    source: Source, message_paths: Sequence[str], recordings: Iterable[Path] = ()
) -> tuple[MessageTypes, list[Diagnostic]]:
    """The types that `source` may name, which is about `recordings`, and what is wrong with `message_paths`.

    Where they differ, `message_paths` win over recordings, and these over ROS 2 Jazzy. Without recordings, what rule
    packs read is known besides.
    """
    if not message_paths and not recordings:
        return MessageTypes({**read_by_packs(), **shipped()}), []
    from ltlc.inputs.recordings.bags.known import message_types

    types, bad_paths = message_types(message_paths, recordings, partial(_declared_types, source))
    if not recordings:
        types = MessageTypes({**read_by_packs(), **types.messages})
    return types, [_bad_path(source, bad) for bad in bad_paths]


def _declared_types(source: Source) -> list[tuple[str, str]]:
    """The topics in the declarations of `source`, each with the name of its message type."""
    tree, _ = parse(source)
    declared = [part for command in tree.commands for part in getattr(command, "attributes", [command])]
    found = [part for part in declared if isinstance(part, Declaration | ObjectFromTopic)]
    return [(part.topic.text, part.type.text.partition(".")[0].partition("[")[0]) for part in found]


def in_order(diagnostics: list[Diagnostic]) -> list[Diagnostic]:
    """`diagnostics` in the order of the text, those without a place first."""
    return sorted(diagnostics, key=lambda d: d.primary.span.start if d.primary else -1)


def _bad_path(source: Source, bad: BadPath) -> Diagnostic:
    return diagnostic("LTL906", source, None, f"definitions of messages: {bad.path} {bad.reason}")


def read_source(path: Path) -> Source | Diagnostic:
    """The text of the specification at `path`, or on standard input, or why it cannot be read."""
    if path != STDIN and _is_recording(path):
        nothing = Source(str(path), "")
        message = f"{path} is a recording, where a specification is needed"
        help = f"give the specification first, then recordings: `ltlc run PROPS {path.name}`"
        return diagnostic("LTL902", nothing, None, message, help=help)
    return read_text(path)


def read_text(path: Path, most: int = MAX_BYTES) -> Source | Diagnostic:
    """The text of a file of at most so many bytes, or of standard input, whatever its name; or why there is none."""
    if path == STDIN:
        return _source(Path("<stdin>"), sys.stdin.buffer.read(most + 1), most)
    nothing = Source(str(path), "")
    try:
        if path.is_dir():
            return diagnostic("LTL902", nothing, None, f"{path} is a folder, not a file")
        with path.open("rb") as file:
            data = file.read(most + 1)
    except FileNotFoundError:
        return diagnostic("LTL901", nothing, None, f"there is no file {path}")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        return diagnostic("LTL902", nothing, None, f"{path} cannot be read: {reason}")
    return _source(path, data, most)


def _is_recording(path: Path) -> bool:
    """Whether `path` looks like a recording, by its name."""
    if not path.is_dir() and path.suffix.lower() not in _OF_RECORDINGS:
        return False
    from ltlc.inputs.recordings import is_recording  # which takes as long to import as a check

    return path.exists() and is_recording(path)


_OF_RECORDINGS = frozenset(
    {".mcap", ".db3", ".bag", ".ulg", ".csv", ".jsonl", ".ndjson", ".parquet", ".gz", ".zst", ".zstd"}
)
"""How the names of recordings end."""


def _source(path: Path, data: bytes, most: int) -> Source | Diagnostic:
    """The text that `data` is, read from `path` and no further than one byte beyond what is allowed."""
    nothing = Source(str(path), "")
    if len(data) > most:
        return diagnostic("LTL905", nothing, None, f"{path} is longer than {most} bytes: it is not a specification")
    mark = BOM_UTF8 if data.startswith(BOM_UTF8) else b""
    return _decode(path, data.removeprefix(mark), mark)


def _decode(path: Path, data: bytes, mark: bytes) -> Source | Diagnostic:
    try:
        return Source(str(path), data.decode("utf-8"), mark)
    except UnicodeDecodeError as error:
        readable = Source(str(path), data[: error.start].decode("utf-8") + "\N{REPLACEMENT CHARACTER}")
        place = Span(len(readable.text) - 1, len(readable.text))
        message = f"the byte 0x{data[error.start]:02x} is not UTF-8 text"
        return diagnostic("LTL903", readable, place, message, help="save the file as UTF-8")
