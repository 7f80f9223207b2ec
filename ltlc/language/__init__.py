"""From the text of a specification to its typed form: parse, resolve names, check types."""

from __future__ import annotations

import sys
from codecs import BOM_UTF8
from collections.abc import Sequence
from pathlib import Path

from ltlc.codes import diagnostic
from ltlc.diagnostics import Diagnostic, Severity
from ltlc.language.resolve import resolve
from ltlc.messages.definitions import BadPath, MessageTypes, message_types
from ltlc.semantics.encodings import EPISODE, Encoding
from ltlc.source import Source, Span
from ltlc.specification.specification import Specification
from ltlc.syntax.parse import parse

__all__ = ["load", "load_text", "read_source"]

MAX_BYTES = 1_000_000
"""A longer file is not a specification."""

STDIN = Path("-")
"""What is read from standard input."""


def load(
    path: str | Path, message_paths: Sequence[str] = (), encoding: Encoding = EPISODE
) -> tuple[Specification | None, list[Diagnostic]]:
    """The specification in the file at `path`, or None, and all that is to be said about it, errors and warnings.

    The path `-` is standard input. `message_paths` are folders with `.msg` files or ROS packages, beside the messages
    of ROS 2 Jazzy. Under `encoding` the bounds on time have to have clocks.
    """
    read = read_source(Path(path))
    return (None, [read]) if isinstance(read, Diagnostic) else load_text(read, message_paths, encoding)


def load_text(
    source: Source, message_paths: Sequence[str] = (), encoding: Encoding = EPISODE
) -> tuple[Specification | None, list[Diagnostic]]:
    """The specification that `source` states; otherwise as `load`."""
    if not source.text.strip():
        return None, [diagnostic("LTL904", source, Span(0, 0), "the file is empty")]
    types, problems = types_for(source, message_paths)
    tree, syntax_errors = parse(source)
    specification, findings = resolve(source, tree, types, encoding)
    diagnostics = in_order([*problems, *syntax_errors, *findings])
    failed = any(d.severity is Severity.ERROR for d in diagnostics)
    return (None if failed else specification), diagnostics


def types_for(source: Source, message_paths: Sequence[str]) -> tuple[MessageTypes, list[Diagnostic]]:
    """The types that `source` may name, and what is wrong with `message_paths`."""
    types, bad_paths = message_types(message_paths)
    return types, [_bad_path(source, bad) for bad in bad_paths]


def in_order(diagnostics: list[Diagnostic]) -> list[Diagnostic]:
    """`diagnostics` in the order of the text, those without a place first."""
    return sorted(diagnostics, key=lambda d: d.primary.span.start if d.primary else -1)


def _bad_path(source: Source, bad: BadPath) -> Diagnostic:
    return diagnostic("LTL906", source, None, f"the message path {bad.path} {bad.reason}")


def read_source(path: Path) -> Source | Diagnostic:
    """The text of the file at `path`, or of standard input, or why it cannot be read."""
    if path == STDIN:
        return _source(Path("<stdin>"), sys.stdin.buffer.read(MAX_BYTES + 1))
    nothing = Source(str(path), "")
    try:
        if path.is_dir():
            return diagnostic("LTL902", nothing, None, f"{path} is a folder, not a file")
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        return diagnostic("LTL901", nothing, None, f"there is no file {path}")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        return diagnostic("LTL902", nothing, None, f"{path} cannot be read: {reason}")
    return _source(path, data)


def _source(path: Path, data: bytes) -> Source | Diagnostic:
    """The text that `data` is, read from `path` and no further than one byte beyond what is allowed."""
    nothing = Source(str(path), "")
    if len(data) > MAX_BYTES:
        return diagnostic(
            "LTL905", nothing, None, f"{path} is longer than {MAX_BYTES} bytes: it is not a specification"
        )
    return _decode(path, data.removeprefix(BOM_UTF8))


def _decode(path: Path, data: bytes) -> Source | Diagnostic:
    try:
        return Source(str(path), data.decode("utf-8"))
    except UnicodeDecodeError as error:
        readable = Source(str(path), data[: error.start].decode("utf-8") + "\N{REPLACEMENT CHARACTER}")
        place = Span(len(readable.text) - 1, len(readable.text))
        message = f"the byte 0x{data[error.start]:02x} is not UTF-8 text"
        return diagnostic("LTL903", readable, place, message, help="save the file as UTF-8")
