"""Adapters for reelay and rtamt: what they can say with the same meaning, and their answers.

Both get past-time formulas over samples, in discrete time: what they show at a sample is whether the run so far is
good.
From the form of the property follows what that means as a verdict: an `always` that has failed is violated, an
`eventually` that has come is satisfied, and a response is open or not. All else is outside, by name.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.conformance.cases import Case, Change, Verdicts
from benchmarks.conformance.score import Answer, Outside
from benchmarks.differential.compare import last_of_each_time
from benchmarks.differential.forms import is_state
from benchmarks.differential.names import number
from ltlc.frontend.syntax import tree as s

INSTALL = "python -m venv peers && peers/bin/pip install rtamt reelay, then --peers peers/lib/python3.*/site-packages"


class OutsideError(Exception):
    """A tool cannot say something; the message says what."""


@dataclass(frozen=True)
class Language:
    """How a tool writes formulas: `atom` writes a comparison of a number, `flag` a boolean."""

    atom: Callable[[str, str, str], str]
    flag: Callable[[str], str]
    implies: str
    since: str = "(({}) since ({}))"


@dataclass(frozen=True)
class Formula:
    """What a tool is asked: a past-time formula, and the verdicts where it holds and where it does not."""

    text: str
    holds: str
    fails: str


REELAY = Language(lambda x, relation, y: f"{{{x} {relation} {y}}}", lambda x: f"{{{x}}}", "->")
RTAMT = Language(
    lambda x, relation, y: f"({x} {relation.replace('!=', '!==')} {y})", lambda x: f"({x} >= 1)", "implies"
)


class Translator:
    """Writes the property of a case for a tool. Raises OutsideError."""

    def __init__(self, language: Language, case: Case) -> None:
        self.language, self.names = language, case.names
        if self.names.rate is not None or self.names.timeout is not None:
            raise OutsideError("_rate_ and _timeout_")

    def formula(self, node: s.Node) -> Formula:
        """The whole property."""
        match node:
            case s.Temporal(_, s.Word(text="after"), (event, body), None) if is_state(event):
                once = f"once({self.state(event)})"
                return self._always(f"({once}) {self.language.implies} ({self._body(body)})")
            case s.Temporal(_, s.Word(text="eventually"), (body,), None) if is_state(body):
                return Formula(f"once({self.state(body)})", "satisfied", "presumably_violated")
            case s.Temporal(
                _, s.Word(text="always"), (s.Connective(_, trigger, s.Word(text="implies"), answer),), None
            ):
                return self._response(trigger, answer) if not is_state(answer) else self._always(self._body(node))
            case _:
                return self._always(self._body(node))

    def _always(self, text: str) -> Formula:
        return Formula(f"historically({text})", "presumably_satisfied", "violated")

    def _body(self, node: s.Node) -> str:
        """What has to hold at each step."""
        match node:
            case s.Temporal(_, s.Word(text="always"), (body,), None) if is_state(body):
                return self.state(body)
            case s.Temporal(_, s.Word(text="never"), (body,), None) if is_state(body):
                return f"not({self.state(body)})"
            case _ if is_state(node):
                return self.state(node)
            case s.Temporal(_, word, _, None):
                raise OutsideError(f"nested {word.text}")
            case s.Temporal() | s.Within():
                raise OutsideError("bounds: between samples they count otherwise")
            case _:
                raise OutsideError(type(node).__name__.lower())

    def _response(self, trigger: s.Node, answer: s.Node) -> Formula:
        match answer:
            case s.Temporal(_, s.Word(text="eventually"), (body,), None) if is_state(trigger) and is_state(body):
                open_, met = self.state(trigger), self.state(body)
                owed = self.language.since.format(f"not({met})", f"({open_}) and not({met})")
                return Formula(f"not({owed})", "presumably_satisfied", "presumably_violated")
            case s.Temporal(_, _, _, s.Bound()):
                raise OutsideError("bounds: between samples they count otherwise")
            case _:
                raise OutsideError("nested always")

    def state(self, node: s.Node) -> str:
        """A state predicate."""
        match node:
            case s.Negation(_, operand):
                return f"not({self.state(operand)})"
            case s.Connective(_, left, operator, right):
                word = self.language.implies if operator.text == "implies" else operator.text
                return f"(({self.state(left)}) {word} ({self.state(right)}))"
            case s.Past(_, s.Word(text="once" | "historically" as word), (operand,), None, None):
                return f"{word}({self.state(operand)})"
            case s.Past(_, s.Word(text="since"), (left, right), None, None):
                return self.language.since.format(self.state(left), self.state(right))
            case s.Past(_, word, _, bound):
                raise OutsideError("bounds: between samples they count otherwise" if bound else word.text)
            case s.Comparison(_, s.Reference(_, name, ()), operator, s.NumberLiteral() | s.Minus() as right, margin):
                self._needs(name.text, "number")
                is_equal = operator.text in ("==", "!=") and self.names.margin is not None
                if margin is not None or is_equal or not isinstance(number(right), int | float):
                    raise OutsideError("margins")
                return self.language.atom(name.text, operator.text, repr(float(number(right))))
            case s.Reference(_, name, ()):
                self._needs(name.text, "boolean")
                return self.language.flag(name.text)
            case _:
                raise OutsideError(type(node).__name__.lower())

    def _needs(self, name: str, what: str) -> None:
        """That a name is a double or a small integer, or a boolean, that arrives by itself."""
        signal = self.names.signals.get(name)
        kinds = ("float64",), ("integer",)
        if signal is None or (signal.kind not in kinds if what == "number" else signal.kind != ("boolean",)):
            raise OutsideError("types" if signal is not None else "computed values")


def reelay_shows(formula: str, samples: Sequence[Mapping[str, Any]]) -> list[bool]:
    """What reelay shows at each sample."""
    import reelay

    monitor = reelay.discrete_timed_monitor(pattern=formula, semantics="boolean", condense=False)
    return [bool(monitor.update(dict(sample))["value"]) for sample in samples]


def rtamt_shows(formula: str, samples: Sequence[Mapping[str, Any]]) -> list[bool]:
    """What rtamt shows at each sample: a robustness that is not negative."""
    import rtamt

    monitor = rtamt.StlDiscreteTimeSpecification()
    for name in (*samples[0], "out"):
        monitor.declare_var(name, "float")
    monitor.spec = f"out = {formula}"
    monitor.parse()
    values = [[(name, float(value)) for name, value in sample.items()] for sample in samples]
    return [monitor.update(n, each) >= 0 for n, each in enumerate(values)]


@dataclass(frozen=True)
class Peer:
    """A tool: how it writes formulas, and what it shows."""

    language: Language
    shows: Callable[[str, Sequence[Mapping[str, Any]]], list[bool]]


PEERS = {"reelay": Peer(REELAY, reelay_shows), "rtamt": Peer(RTAMT, rtamt_shows)}


def answers(cases: Iterable[Case], folder: Path | None) -> Iterator[tuple[str, dict[int, Answer]]]:
    """Those of each tool that can be imported, also from a `folder`; the others are named on stderr."""
    cases = list(cases)
    if folder is not None:
        sys.path.append(str(folder))
    for name, peer in PEERS.items():
        try:
            __import__(name)
        except ImportError:
            print(f"{name} is left out: it is not installed; {INSTALL}", file=sys.stderr)
        else:
            yield name, {case.number: answer(peer, case) for case in cases}


def answer(peer: Peer, case: Case) -> Answer:
    """What a tool finds of a case."""
    [node] = case.names.properties.values()
    try:
        formula = Translator(peer.language, case).formula(node)
    except OutsideError as error:
        return Outside(str(error))
    times, samples = _samples(case)
    if not samples:
        return Verdicts([], ())
    changes: list[Change] = []
    for time, good in zip(times, peer.shows(formula.text, samples), strict=True):
        verdict = formula.holds if good else formula.fails
        if not changes or changes[-1][1] not in ("violated", "satisfied"):
            changes.append((time, verdict))
    return Verdicts(last_of_each_time(changes), ())


def _samples(case: Case) -> tuple[list[int], list[dict[str, Any]]]:
    """The values at each message, those of other signals held, once all have one; booleans are numbers."""
    read = {name for name, signal in case.names.signals.items() if signal.topic is not None}
    known: dict[str, Any] = {}
    times, samples = [], []
    for row in case.recording.rows:
        for values in row.messages.values():
            known |= {n: float(v) if type(v) is not bool else v for n, v in values.items() if n in read}
        if known.keys() == read:
            times.append(row.time)
            samples.append(dict(known))
    return times, samples
