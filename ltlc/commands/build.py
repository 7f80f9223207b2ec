"""`ltlc build`: check, then monitors, the gate, and the output."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

from ltlc.assurance.certify import NotCertified
from ltlc.assurance.foresight import Foreseen, Unforeseen
from ltlc.assurance.gate import Judgement, judge_all
from ltlc.assurance.messages import Messages
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.replay import Deviation, Replayed, Shown
from ltlc.assurance.runs import Agreement, Mismatch
from ltlc.automata import Budget, Exceeded, SpotMissing
from ltlc.codes import diagnostic
from ltlc.commands import arguments
from ltlc.commands.common import (
    FINDING,
    OK,
    compile_loaded,
    examine,
    failure,
    report,
    unusable,
    unwritable,
    without_notes,
)
from ltlc.commands.progress import progress, saying
from ltlc.commands.targets import UnfitError, target_of
from ltlc.compiler import Compiled
from ltlc.diagnostics import Diagnostic
from ltlc.files import refuse_unwritable, write_text
from ltlc.language import STDIN, read_source
from ltlc.messages.definitions import message_types
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.certificate_text import Entry, to_text
from ltlc.semantics.instants import Instant
from ltlc.semantics.words import Letter
from ltlc.specification.specification import Specification

CHECK_BUDGET = Budget(seconds=30.0, megabytes=1024)
"""What the analyses may use, all together."""

GATE_SECONDS, GATE_MEMORY = 6, 2
"""How many times as much as translating one property judging it may use."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc build` takes."""
    arguments.add_specification(parser, "the specification file; `-` for stdin, which needs --output")
    arguments.add_reading(parser)
    arguments.add_budget(parser, "what translating one property may use; judging it, six times the seconds", 10.0)
    parser.add_argument(
        "--target",
        choices=("ros2", "ament", "python", "c", "hoa", "dot", "json"),
        default="ros2",
        help="default: %(default)s",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="PATH",
        help="default: STEM_monitor.py, STEM.hoa, … here; of ament, a folder",
    )
    parser.add_argument("--certificate", type=Path, metavar="PATH", help="write the monitors' certificates to PATH")


def run(options: argparse.Namespace) -> int:
    """Write the output if every property passes the gate; otherwise say which does not, and why."""
    if options.specification == STDIN and options.output is None:
        return unusable("what is read from stdin has no name to call the output by: say --output PATH")
    target = target_of(options.target, options.output, options.specification.stem)
    try:
        path = target.told[0]
        target.refuse()
        if options.certificate:
            path = options.certificate
            refuse_unwritable(path)
    except OSError as error:
        return unwritable(path, error)
    try:
        examined = examine(read_source(options.specification), options, CHECK_BUDGET)
    except SpotMissing as error:
        return unusable(str(error))
    report(without_notes(examined.diagnostics))
    if examined.specification is None:
        return failure(examined.diagnostics)
    outcome = compile_loaded(examined.specification, options)
    if isinstance(outcome, int):
        return outcome
    specification, compiled = outcome
    seconds, megabytes = options.budget
    budget = Budget(GATE_SECONDS * seconds, GATE_MEMORY * megabytes)
    messages = Messages(message_types(options.msg_path)[0])
    try:
        with saying("making the code", options.quiet):
            made = target.make(compiled, specification, messages)
    except UnfitError as error:
        report(error.diagnostics)
        return FINDING
    with progress("judging monitors", options.quiet) as watch:
        judgements = judge_all(compiled, made.programs, messages, budget, watch, made.written)
    failures = []
    for each, judgement in zip(compiled, judgements, strict=True):
        if not options.quiet:
            print(f"{each.specification.label}: {_summary(each, judgement, options.target)}")
        failures += _failures(specification, each, judgement)
    if failures:
        report(failures)
        return FINDING
    told: Sequence[Path] = () if options.quiet else target.told
    if options.certificate and (code := _write_certificates(options, compiled, judgements)):
        return code
    if made.note and not options.quiet:
        print(made.note)
    with saying("making the files", options.quiet):
        files = made.files()
    return _write(files, told)


def _write_certificates(
    options: argparse.Namespace, compiled: Sequence[Compiled], judgements: Sequence[Judgement | Exceeded]
) -> int:
    """Write the certificates of judgements that have all passed, if others can read them; the exit code."""
    text = to_text(
        Entry(c.specification.label, c.specification.line, c.specification.property, c.encoding.name, j.certificate)
        for c, j in zip(compiled, judgements, strict=True)
        if isinstance(j, Judgement) and isinstance(j.certificate, Certificate)
    )
    try:
        parse(text)
    except UnreadableError as error:
        return unusable(f"the certificates are too large for `ltlc certify`, nothing was written: {error.message}")
    path: Path = options.certificate
    return _write({path: text}, [] if options.quiet else [path])


def _write(files: Mapping[Path, str], told: Sequence[Path]) -> int:
    """Write files, each whole or not at all, and name those that are `told`; the exit code."""
    for path, text in files.items():
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_text(path, text)
        except OSError as error:
            return unwritable(path, error)
    for path in told:
        print(f"wrote {path}")
    return OK


def _summary(compiled: Compiled, judgement: Judgement | Exceeded, target: str) -> str:
    """Size of the monitor and what the gate checked, in one line."""
    monitor, alphabet = compiled.monitor, compiled.specification.alphabet
    size = f"{_count(len(monitor.verdicts), 'state')}, {_count(alphabet.count(), 'letter')}"
    if isinstance(judgement, Exceeded):
        return f"{size}; not judged"
    certificate = "NOT certified" if isinstance(judgement.certificate, NotCertified) else "certified"
    found = "" if isinstance(judgement.alphabet, Foreseen) else "; NOT all letters foreseen"
    code = "" if judgement.reading is None else f", {_reading_text(judgement.reading)}"
    shown = _cross_check_text(judgement.cross_check), _replay_text(judgement.replay, target) + code
    return f"{size}{found}; {certificate}; {'; '.join(shown)}"


def _cross_check_text(outcome: Agreement | Mismatch) -> str:
    if isinstance(outcome, Mismatch):
        return "NOT as defined"
    exhaustive = f" (all to length {outcome.exhaustive})" if outcome.exhaustive else ""
    return f"as defined on {outcome.runs} runs{exhaustive}"


def _replay_text(outcome: Replayed | Deviation | None, target: str) -> str:
    if outcome is None and target == "c":
        return "code NOT replayed: there is no C compiler here"
    if outcome is None:
        return "not replayed: the output is not code"
    if isinstance(outcome, Deviation):
        return "the code does NOT do the same"
    return f"code replayed on {outcome.runs} runs"


def _reading_text(outcome: ReadBack | Difference) -> str:
    return "read back, NOT the same" if isinstance(outcome, Difference) else "read back"


def _count(number: int, noun: str) -> str:
    shown = f"{number:,}" if number < 10**6 else f"{number:.1e}"
    return f"{shown} {noun}{'' if number == 1 else 's'}"


def _failures(specification: Specification, compiled: Compiled, judgement: Judgement | Exceeded) -> list[Diagnostic]:
    """Why a property may not be emitted; nothing if it may."""
    place, label = compiled.specification.span, compiled.specification.label
    if isinstance(judgement, Exceeded):
        message = f"judging `{label}` {judgement}"
        return [diagnostic("LTL704", specification.source, place, message, help=_ALLOW_MORE)]
    failures = []
    if isinstance(judgement.certificate, NotCertified):
        message = f"the monitor of `{label}` is not certified: {judgement.certificate.reason}"
        failures.append(diagnostic("LTL705", specification.source, place, message, help=_advice(judgement.certificate)))
    if isinstance(judgement.alphabet, Unforeseen):
        values = "; then ".join(map(str, judgement.alphabet.frames))
        letter = _letter_text(judgement.alphabet.letter)
        message = f"the alphabet of `{label}` excludes {letter}, but {values} gives it"
        failures.append(diagnostic("LTL706", specification.source, place, message, help=_OUR_FAULT))
    if isinstance(judgement.cross_check, Mismatch):
        wrong = judgement.cross_check
        run = "; ".join(map(_letter_text, wrong.run)) or "no step at all"
        message = f"the monitor of `{label}` says {wrong.monitor.value} after {run}, but: {wrong.expected}"
        failures.append(diagnostic("LTL702", specification.source, place, message, help=_OUR_FAULT))
    if isinstance(judgement.replay, Deviation):
        message = f"the code of `{label}` does not do what it should: {_deviation_text(judgement.replay)}"
        failures.append(diagnostic("LTL703", specification.source, place, message, help=_OUR_FAULT))
    if isinstance(judgement.reading, Difference):
        message = f"the text of the code of `{label}` is not its monitor: {judgement.reading}"
        failures.append(diagnostic("LTL707", specification.source, place, message, help=_OUR_FAULT))
    return failures


def _advice(refused: NotCertified) -> str:
    if refused.too_late:
        return _TOO_LATE
    return _TOO_LARGE if refused.too_large else _NOTHING_WRITTEN


_NOTHING_WRITTEN = "nothing was written: only what is certified is"
_TOO_LARGE = (
    f"{_NOTHING_WRITTEN}; write each side of its `and` as a property of its own, or put fewer inside one another"
)
_TOO_LATE = (
    f"{_NOTHING_WRITTEN}; where one of several bounds decides what comes of another, leave that other out, "
    "or give each a property of its own"
)
_ALLOW_MORE = (
    "nothing was written; allow more with `--budget SECONDS,MB`, of which judging may use "
    f"{GATE_SECONDS} times the seconds, or split the property into several"
)
_OUR_FAULT = "nothing was written; this is a fault of ltlc, please report it with the specification"


def _letter_text(letter: Letter) -> str:
    held = " and ".join(f"`{atom}`" for atom in sorted(letter)) or "none of the atoms"
    return f"{held} at {letter.time} ns" if isinstance(letter, Instant) else held


def _deviation_text(deviation: Deviation) -> str:
    """What was to be shown, what was shown, and after what."""
    emitted = deviation.emitted
    told = {} if isinstance(emitted, str) else {n: v for n, v in emitted.items() if n in deviation.expected}
    wrong = {name: value for name, value in told.items() if value != deviation.expected[name]}
    shown = emitted if isinstance(emitted, str) else _shown_text(wrong)
    right = _shown_text({name: deviation.expected[name] for name in wrong} or deviation.expected)
    return f"{shown} instead of {right} after {_count(deviation.events, 'event')}, the last being {deviation.event}"


def _shown_text(shown: Shown) -> str:
    return ", ".join(f"{value}" if name == "verdict" else f"{name} = {value}" for name, value in shown.items())
