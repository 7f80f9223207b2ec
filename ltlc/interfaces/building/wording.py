"""The gate's answer about a property, in words: a line about what was checked, and diagnostics about what failed."""

from __future__ import annotations

from ltlc.assurance.certify import NotCertified
from ltlc.assurance.exactness import LATE
from ltlc.assurance.foresight import Foreseen, Unforeseen
from ltlc.assurance.gate import Judgement
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.replay import Deviation, Replayed, Shown
from ltlc.assurance.runs import Agreement, Mismatch
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import Exceeded
from ltlc.compiler import Compiled
from ltlc.program.guards import GuardProgram
from ltlc.semantics.instants import Instant
from ltlc.semantics.words import Letter
from ltlc.specification.specification import Specification

GATE_SECONDS, GATE_MEMORY = 6, 2
"""How many times as much as translating one property judging it may use."""


def summary(compiled: Compiled, judgement: Judgement | Exceeded, target: str) -> str:
    """Size of the monitor and what the gate checked, in one line."""
    monitor, alphabet = compiled.monitor, compiled.specification.alphabet
    size = f"{_count(len(monitor.verdicts), 'state')}, {_count(alphabet.count(), 'letter')}"
    if isinstance(judgement, Exceeded):
        return f"{size}; not judged"
    certificate = "NOT certified" if isinstance(judgement.certificate, NotCertified) else "certified"
    found = "" if isinstance(judgement.alphabet, Foreseen) else "; some letters NOT covered"
    code = f", {_reading_text(judgement.reading)}" if judgement.reading else ""
    shown = _cross_check_text(judgement.cross_check), _replay_text(judgement.replay, target) + code
    return f"{size}{found}; {certificate}; {'; '.join(shown)}"


def _cross_check_text(outcome: Agreement | Mismatch) -> str:
    if isinstance(outcome, Mismatch):
        return "NOT as defined"
    exhaustive = f" (all to length {outcome.exhaustive})" if outcome.exhaustive else ""
    return f"as defined on {_count(outcome.runs, 'run')}{exhaustive}"


_COMPILERS = {"c": "C compiler", "rust": "rustc"}
"""What code is replayed with, for each target that needs such a thing."""


def _replay_text(outcome: Replayed | Deviation | None, target: str) -> str:
    if outcome is None and target in _COMPILERS:
        return f"code NOT replayed: no {_COMPILERS[target]} installed"
    if outcome is None:
        return "not replayed: the output is not code"
    if isinstance(outcome, Deviation):
        return "the code behaves DIFFERENTLY"
    return f"code replayed on {_count(outcome.runs, 'run')}"


def _reading_text(outcome: ReadBack | Difference) -> str:
    return "read back, NOT equal" if isinstance(outcome, Difference) else "read back"


def _count(number: int, noun: str) -> str:
    shown = f"{number:,}" if number < 10**6 else f"{number:.1e}"
    return f"{shown} {noun}{'' if number == 1 else 's'}"


def failures(specification: Specification, compiled: Compiled, judgement: Judgement | Exceeded) -> list[Diagnostic]:
    """Why a property may not be emitted; nothing if it may."""
    place, label = compiled.specification.span, compiled.specification.label
    if isinstance(judgement, Exceeded):
        message = f"judging `{label}` {judgement}"
        return [diagnostic("LTL704", specification.source, place, message, help=_ALLOW_MORE)]
    found = []
    if isinstance(judgement.certificate, NotCertified):
        message = f"the monitor of `{label}` is not certified: {judgement.certificate.reason}"
        found.append(diagnostic("LTL705", specification.source, place, message, help=_advice(judgement.certificate)))
    if isinstance(judgement.alphabet, Unforeseen):
        values = "; then ".join(map(str, judgement.alphabet.frames))
        letter = _letter_text(judgement.alphabet.letter)
        message = f"the alphabet of `{label}` excludes {letter}, but {values} leads to it"
        found.append(diagnostic("LTL706", specification.source, place, message, help=_OUR_FAULT))
    if isinstance(judgement.cross_check, Mismatch):
        wrong = judgement.cross_check
        run = "; ".join(map(_letter_text, wrong.run)) or "no step at all"
        message = f"the monitor of `{label}` reports {wrong.monitor.value} after {run}, but: {wrong.expected}"
        found.append(diagnostic("LTL702", specification.source, place, message, help=_OUR_FAULT))
    if isinstance(judgement.replay, Deviation):
        message = f"the code of `{label}` behaves incorrectly: {_deviation_text(judgement.replay)}"
        found.append(diagnostic("LTL703", specification.source, place, message, help=_OUR_FAULT))
    if isinstance(judgement.reading, Difference):
        message = f"the text of the code of `{label}` does not match its monitor: {judgement.reading}"
        found.append(diagnostic("LTL707", specification.source, place, message, help=_OUR_FAULT))
    if isinstance(judgement.machine, Difference):
        message = f"the lowered machine of `{label}` does not match its monitor: {judgement.machine}"
        found.append(diagnostic("LTL710", specification.source, place, message, help=_OUR_FAULT))
    return found


def guard_failure(specification: Specification, program: GuardProgram, wrong: Difference) -> Diagnostic:
    """That the program of guards is not their region."""
    guard = program.guards[0]
    message = f"the lowered guard of {guard.out} does not match its region: {wrong}"
    return diagnostic("LTL710", specification.source, guard.span, message, help=_OUR_FAULT)


def guard_code_failure(specification: Specification, wrong: str) -> Diagnostic:
    """That the code of a guard does something else than its program."""
    guard = specification.guards[0]
    message = f"the code of the guard of {guard.out} behaves incorrectly: {wrong}"
    return diagnostic("LTL703", specification.source, guard.span, message, help=_OUR_FAULT)


def _advice(refused: NotCertified) -> str:
    if refused.too_late:
        return _TOO_LATE
    return _TOO_LARGE if refused.too_large else _NOTHING_WRITTEN


_NOTHING_WRITTEN = "nothing was written: only certified monitors are"
_TOO_LARGE = f"{_NOTHING_WRITTEN}; write each side of its `and` as a separate property, or nest fewer scopes"
_TOO_LATE = f"{_NOTHING_WRITTEN}; {LATE}"
_ALLOW_MORE = (
    "nothing was written; raise the limits with `--budget SECONDS,MB`, of which judging may use "
    f"{GATE_SECONDS} times the seconds, or split the property into several"
)
_OUR_FAULT = "nothing was written; this is a bug in ltlc, please report it with the specification"


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
