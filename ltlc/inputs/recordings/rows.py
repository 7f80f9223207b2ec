"""What all formats of recordings share: rows, values, and their possible errors."""

from __future__ import annotations

import json
import math
from datetime import UTC, datetime, timedelta
from pathlib import Path

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.runtime.sampling import Value
from ltlc.runtime.times import SECOND, nanoseconds, seconds_text, span_text
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import ValueType
from ltlc.specification.wire import DOUBLES, Kind, Numbers


@dataclass(frozen=True, slots=True)
class Row:
    """What was sampled at `time`, in ns: values by the names of signals."""

    time: Nanoseconds
    values: dict[str, Value]


class RecordingError(Exception):
    """A recording cannot be used, for the reason that `diagnostic` gives."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic


def failure(code: str, path: Path, message: str, help: str = "") -> RecordingError:
    """An error to be raised about the recording at `path`."""
    return RecordingError(diagnostic(code, Source(str(path), ""), None, message, help=help))


def outside(path: Path, first: Nanoseconds, last: Nanoseconds | None) -> RecordingError:
    """An error about a recording that has nothing between `--from` and `--until`.

    It begins at `first` and ends at `last`, before `--from`; if `last` is None, it begins after `--until`.
    """
    option, which = ("--until", "begins after") if last is None else ("--from", "ends before")
    message = f"the recording {which} the time of `{option}`: it begins at {seconds_text(first)} s"
    lasts = "" if last is None else f" and lasts {span_text(last - first)}"
    help = f"give a time of its clock, or one since its beginning with `+`, such as `{option} +0.5`"
    return failure("LTL804", path, f"{message}{lasts}", help)


LONGEST_GAP = 366 * 86_400 * SECOND
"""Between two rows of one run; more is a change of clocks."""


_UNITS = ((18, "nanoseconds"), (15, "microseconds"), (11, "milliseconds"))
"""So many digits a time since 1970 has at least in these units."""


def time_of_row(path: Path, place: str, previous: Nanoseconds | None, written: str) -> Nanoseconds:
    """The time that `written`, in seconds, is: not before that of the row before, nor a year after it.

    `place` says where it is. Raises RecordingError.
    """
    try:
        time = nanoseconds(ascii_number(written))
    except (NotAValueError, ValueError):
        message = f"{place}: `{written}` is not a time in seconds"
        unit = next((unit for digits, unit in _UNITS if len(written) >= digits), "")
        help = f"is it in {unit}? times must be in seconds, before the year 2116" if written.isdigit() and unit else ""
        raise failure("LTL804", path, message, help or calendar_help(written.strip('"'))) from None
    check_order(path, place, previous, time)
    return time


def calendar_help(written: str) -> str:
    """The help with a calendar time (ISO 8601) in seconds; empty if `written` is not one."""
    try:
        time = datetime.fromisoformat(written)
    except ValueError:
        return ""
    since_1970 = (time if time.tzinfo else time.replace(tzinfo=UTC)) - datetime(1970, 1, 1, tzinfo=UTC)
    seconds = seconds_text(since_1970 // timedelta(microseconds=1) * 1000)
    return f"write it in seconds since 1970: `{seconds}`{'' if time.tzinfo else ', if it is in UTC'}"


def follows(previous: Nanoseconds | None, time: Nanoseconds) -> bool:
    """Whether a row can be at `time` that comes after the one before, if there is one."""
    return previous is None or previous <= time <= previous + LONGEST_GAP


def check_order(path: Path, place: str, previous: Nanoseconds | None, time: Nanoseconds) -> None:
    """Raise RecordingError if `time` does not follow that of the row before."""
    if previous is None or follows(previous, time):
        return
    moments = f"from {seconds_text(previous)} to {seconds_text(time)}"
    if time < previous:
        message = f"{place}: time goes back {moments}"
        help = "sort the rows by time; if two runs were recorded into one file, split it there"
        raise failure("LTL804", path, message, help)
    message = f"{place}: time jumps {moments}, by more than a year"
    help = "a run has one clock: do some times count from the start of a simulation and others from 1970?"
    raise failure("LTL804", path, message, help)


class NotAValueError(Exception):
    """A cell does not hold a value of its signal."""


@dataclass(frozen=True, slots=True)
class Column:
    """What the cells of a signal are: values of a type; numbers are made those that the signal can be."""

    type: ValueType
    numbers: Numbers = DOUBLES

    @property
    def wanted(self) -> str:
        """What a cell may contain, for an error message."""
        if self.numbers.kind is Kind.INTEGER:
            several = "an array of whole numbers" if self.type is ValueType.NUMBERS else "a whole number"
            return f"{several} from {self.numbers.least} to {self.numbers.most}"
        return _WANTED[self.type]


_WANTED = {
    ValueType.NUMBER: "a number, such as 1.5, 1e-3, nan or inf",
    ValueType.BOOLEAN: "true, false, 1 or 0",
    ValueType.STRING: "a string",
    ValueType.NUMBERS: "an array of numbers, such as [1.5, 2]",
    ValueType.BOOLEANS: "an array of booleans, such as [true, false]",
    ValueType.STRINGS: 'an array of strings, such as ["a", "b"]',
}

_NOT_FINITE = {sign + name for sign in ("", "+", "-") for name in ("nan", "inf", "infinity")}


def double_from_text(text: str) -> float:
    """The double that `text` writes. Raises NotAValueError."""
    try:
        return float(ascii_number(text))
    except ValueError:
        raise NotAValueError from None


def number_from_text(text: str, numbers: Numbers) -> float:
    """The one of `numbers` that `text` writes. Raises NotAValueError."""
    double, digits = double_from_text(text), text.strip()
    is_whole = numbers.is_wide and math.isfinite(double) and digits.lstrip("+-").isdigit()
    return fitted(int(digits) if is_whole else double, numbers)


def fitted(value: float, numbers: Numbers) -> float:
    """`value` as one of `numbers`; fractions and NaN are not integers. Raises NotAValueError."""
    if numbers.kind is Kind.INTEGER and not numbers.has(value):
        raise NotAValueError
    return numbers.nearest(value)


def ascii_number(text: str) -> str:
    """`text` without what Python accepts in numbers and others do not. Raises NotAValueError."""
    stripped = text.strip()
    if not stripped.isascii() or "_" in stripped:
        raise NotAValueError
    return stripped


def truth_from_text(text: str) -> bool:
    """The boolean that `text` writes, as a word or a number. Raises NotAValueError."""
    word = text.strip().lower()
    if word in ("true", "false"):
        return word == "true"
    number = double_from_text(text)
    if number not in (0, 1):
        raise NotAValueError
    return number == 1


def value_given(path: Path, place: str, name: str, value: object, column: Column) -> Value:
    """A value as JSON has it as one of the signal `name`; `place` says where it stands. Raises RecordingError."""
    try:
        return value_from_json(value, column)
    except NotAValueError:
        message = f"{place}: `{name}`: `{json.dumps(value, default=repr)}` is not {column.wanted}"
        raise failure("LTL803", path, message) from None


def value_from_json(value: object, column: Column) -> Value:
    """A value as JSON has it, as a value of a signal. Raises NotAValueError."""
    match column.type, value:
        case ValueType.NUMBER, int() | float() if not isinstance(value, bool):
            return fitted(value, column.numbers)
        case ValueType.NUMBER, str() if value.lower() in _NOT_FINITE:
            return fitted(float(value), column.numbers)
        case ValueType.BOOLEAN, bool():
            return value
        case ValueType.BOOLEAN, int() | float() if value in (0, 1):
            return bool(value)
        case ValueType.STRING, str():
            return value
        case _, list() | tuple() if column.type.element is not None:
            of_one = Column(column.type.element, column.numbers)
            return tuple(value_from_json(item, of_one) for item in value)
    raise NotAValueError
