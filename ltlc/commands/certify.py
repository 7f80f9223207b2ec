"""`ltlc certify`: certificates that someone else made, and code, checked against a specification.

Trusted are the front end, the encoding and the checker; neither Spot nor what made the certificates. What made the code
is not trusted either: its text is read back and compared with the certified monitors.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from ltlc.analysis.suppression import unsuppressed
from ltlc.assurance.certificates import Checked, Subject, Unreadable, check_certificates
from ltlc.assurance.reading.c.files import written as written_in_c
from ltlc.assurance.reading.files import written
from ltlc.assurance.reading.letters import Judged
from ltlc.assurance.reading.outcomes import Difference, ReadBack, Written
from ltlc.commands import arguments
from ltlc.commands.common import FINDING, OK, failure, report, unusable
from ltlc.commands.progress import progress, saying
from ltlc.language import load
from ltlc.limits import Budget, Exceeded, run_all
from ltlc.semantics.certificate_text import in_words
from ltlc.semantics.encodings import ENCODINGS, encode
from ltlc.semantics.ltl import TRUE
from ltlc.specification.specification import Specification

READING = Budget(seconds=60.0, megabytes=1024)
"""What reading back the code of one property may use."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc certify` takes."""
    arguments.add_specification(parser)
    arguments.add_reading(parser)
    parser.add_argument("certificate", metavar="CERTIFICATE", type=Path, help="the file of certificates")
    parser.add_argument(
        "--code",
        metavar="FILE",
        type=Path,
        help="emitted Python, a node or monitors, or C beside its header, to be read back",
    )


def run(options: argparse.Namespace) -> int:
    """Say of each property whether its certificate proves its monitor right, and its code is that; 0 if all are."""
    specification, diagnostics = load(options.specification, options.msg_path, ENCODINGS[options.encoding])
    report(unsuppressed(diagnostics))
    if specification is None:
        return failure(diagnostics)
    try:
        text = _read(options.certificate, "certificate")
        code = [] if options.code is None else _texts(options.code)
    except _UnusableError as error:
        return unusable(str(error))
    subjects = [Subject(p.label, p.line, p.property, p.alphabet, options.encoding) for p in specification.properties]
    with saying("checking certificates", options.quiet):
        checked = check_certificates(subjects, text)
    if isinstance(checked, Unreadable):
        return unusable(f"{options.certificate}:{checked.line}: {checked.message}")
    for each in checked:
        print(f"{each.label}: {_answer(each)}")
        if each.assumption != TRUE:
            print(f"  assuming {in_words(each.assumption)}")
    is_right = all(each.passed for each in checked)
    if code:
        is_right = _is_code_of(code, specification, checked, options) and is_right
    return OK if is_right else FINDING


class _UnusableError(Exception):
    """A file cannot be used; the message says why."""


def _read(path: Path, what: str) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise _UnusableError(f"{path} cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise _UnusableError(f"{path} is not a {what}: it is not UTF-8 text") from None


def _answer(checked: Checked) -> str:
    if not checked.passed:
        return f"NOT certified: {checked.objection}"
    return "certified, exactly" if checked.answer.exact else "certified, but not that every permanent verdict is given"


def _texts(path: Path) -> list[str]:
    """The text of a file of code; of C, that of its header as well."""
    header = [_read(path.with_suffix(".h"), "header")] if path.suffix == ".c" else []
    return [*header, _read(path, "file of code")]


def _is_code_of(
    code: Sequence[str], specification: Specification, checked: Sequence[Checked], options: argparse.Namespace
) -> bool:
    """Say of each certified property whether its part of `code` is its monitor; whether that is so of all."""
    monitors = [each.monitor for each in checked[: len(specification.properties)]]
    if None in monitors:
        print("the code was not read back: not every property is certified")
        return False
    judged = [
        Judged(each, encode(each.property, ENCODINGS[options.encoding]), monitor)
        for each, monitor in zip(specification.properties, monitors, strict=True)
        if monitor is not None
    ]
    with progress("reading back the code", options.quiet) as watch:
        parts: Sequence[Written | Difference] = _written(code, judged)
        jobs = [part.read_back for part in parts if not isinstance(part, Difference)]
        found = run_all(jobs, READING, watch=watch)
    outcomes = iter(found)
    is_right = True
    for each, part in zip(judged, parts, strict=True):
        outcome = part if isinstance(part, Difference) else next(outcomes)
        is_right &= isinstance(outcome, ReadBack)
        print(f"{each.specification.label}: {_reading(outcome)}")
    return is_right


def _written(code: Sequence[str], judged: Sequence[Judged]) -> Sequence[Written | Difference]:
    match code:
        case [header, source]:
            return written_in_c(header, source, judged)
    return written(code[0], judged)


def _reading(outcome: ReadBack | Difference | Exceeded) -> str:
    match outcome:
        case ReadBack():
            return "its code is the monitor"
        case Difference():
            return f"its code is NOT the monitor: {outcome}"
    return f"its code was NOT read back: that {outcome}"
