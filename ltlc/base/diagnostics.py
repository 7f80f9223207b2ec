"""Diagnostics about a file, as data: collected by the passes, shown by `ltlc.base.render`."""

from __future__ import annotations

from enum import Enum
from typing import Any

from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass


class Severity(Enum):
    """How much a diagnostic weighs: an error stops the build, `--strict` counts warnings, notes only inform."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class Label:
    """A place in the source and a few words about it; the words may be empty."""

    span: Span
    text: str = ""


@dataclass(frozen=True, slots=True)
class Fix:
    """A fix that needs no more thought than a yes: what to write in place of parts of the source.

    `title` says what it does, as an order. The `edits` do not overlap. It `is_certain` if it is the only fix that
    makes sense, so that a program may carry it out; else it is one that a person may choose.
    """

    title: str
    edits: tuple[tuple[Span, str], ...]
    is_certain: bool = False


@dataclass(frozen=True, slots=True)
class Help:
    """How to fix something: in words, and by `fixes` where it can be written down."""

    text: str
    fixes: tuple[Fix, ...] = ()


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding.

    `code` is stable (`LTL` and three digits) and `name` its mnemonic; both are listed in `ltlc.base.codes`.
    `message` stands alone, without the source. `primary` is the place the finding is about, `secondary` what it
    refers to; `primary` is None only where there is no text, such as a file that cannot be read. `help` says how to
    fix it, and the `fixes` are fixes that can be carried out as they are. `example` is a run that shows it, in the
    form in which the JSON output carries it, or None.
    """

    code: str
    name: str
    severity: Severity
    message: str
    source: Source
    primary: Label | None
    secondary: tuple[Label, ...] = ()
    help: str = ""
    example: dict[str, Any] | None = None
    fixes: tuple[Fix, ...] = ()
