"""The forms that are imported: a line for each, and which one a file is of."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import PurePath

from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.importing import c2po, fret, hpl, smv, stl, table
from ltlc.importing.names import Signals
from ltlc.importing.operators import Measure
from ltlc.importing.requirement import Requirement
from ltlc.importing.values import FormulaError
from ltlc.semantics.durations import UNITS, Nanoseconds

Reader = Callable[[Source, Signals, Measure], Sequence[Requirement]]
"""Reads the requirements of a file. Raises UnusableFileError."""


@dataclass(frozen=True)
class FileForm:
    """A form of files: what it is called, how it is read, the ends of their names, and how time is usually read.

    Without a unit, a bound is so many positions where it `counts`, and seconds otherwise.
    """

    name: str
    read: Reader
    endings: tuple[str, ...]
    reading: str
    counts: bool = True


FORMS: Mapping[str, FileForm] = {
    "fret": FileForm(fret.NAME, fret.read, (".json",), "points"),
    "hpl": FileForm(hpl.NAME, hpl.read, (".hpl",), "signals"),
    "csv": FileForm(table.NAME, table.read, (".csv", ".tsv"), "signals", counts=False),
    "c2po": FileForm(c2po.NAME, c2po.read, (".c2po", ".mltl"), "points"),
    "smv": FileForm(smv.NAME, smv.read, (".smv", ".ltl"), "points"),
    "stl": FileForm(stl.NAME, stl.read, (".stl",), "signals", counts=False),
}


def form_of(name: str) -> str | None:
    """The form of a file with this name; None if the name does not say."""
    ending = PurePath(name).suffix.lower()
    return next((key for key, form in FORMS.items() if ending in form.endings), None)


def measure_of(form: FileForm, step: Nanoseconds | None) -> Measure:
    """How bounds are counted: in steps, or in nanoseconds."""

    def measure(number: str, unit: str) -> int:
        if unit and unit not in UNITS:
            raise FormulaError(f"there is no unit `{unit}`")
        if not unit and form.counts:
            if not re.fullmatch(r"\d+", number):
                raise FormulaError("a bound counts positions: it is a whole number")
            return int(number) * (1 if step is not None else 10**9)
        length = round(float(number) * UNITS[unit or "s"])
        steps, rest = divmod(length, step or 1)
        if rest:
            raise FormulaError("a bound is no whole number of steps: give another `--step`, or `--reading signals`")
        return steps

    return measure
