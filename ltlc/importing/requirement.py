"""What is read of a file of another tool: requirements, with their formulas if they have any."""

from __future__ import annotations

from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.importing.formulas import Formula


@dataclass(frozen=True)
class Requirement:
    """One requirement of a file.

    `text` is what people read, and `rationale` why; `original` is the formula, or a phrase, at `place`. `meaning`
    is the formula that the property must equal; `forms` are formulas from which it may be written, the first one that
    can be, each of them compared. `said` are properties that are written already. Without any of these, `problem` says
    why. `notes` are remarks on how it is read. It `has_readings`, at points and over signals, if it is metric temporal
    logic.
    """

    id: str
    text: str
    original: str
    place: Span | None = None
    meaning: Formula | None = None
    forms: tuple[Formula, ...] = ()
    said: tuple[str, ...] = ()
    problem: str = ""
    notes: tuple[str, ...] = ()
    rationale: str = ""
    has_readings: bool = True


class UnusableFileError(ValueError):
    """A file is not of the form that is asked for; `offset` is the place, in characters from 0."""

    def __init__(self, reason: str, offset: int = 0) -> None:
        super().__init__(reason)
        self.offset = offset
