"""Ways to make monitors that can be stepped: from the text of a specification, or any machine over any conditions."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

from hypothesis import strategies as st
from program_reference import is_nan
from strategies import predicates

from ltlc.automata import Budget
from ltlc.backends import python
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source, Span
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load_text
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.times import nanoseconds
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.diagrams import Diagrams
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.monitor import Decision, Monitor
from ltlc.semantics.verdicts import Verdict
from ltlc.specification import expressions as e
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import evaluate, letter
from ltlc.specification.expressions import Comparison, Condition, Count, IsTrue, Relation, Same
from ltlc.specification.functions import Function
from ltlc.specification.specification import PropertySpecification
from ltlc.specification.specification import Specification as Spec

FIELD = e.Field("/odom", "nav_msgs/msg/Odometry", ("pose", "pose", "position", "x"))


def number(name: str) -> e.Signal:
    return e.Signal(name, e.ValueType.NUMBER, FIELD)


X, Y, Z = number("robot.x"), number("robot_x"), number("y")
"""Three numbers; the first two would have the same name in Python."""
FLAG = e.Signal("flag", e.ValueType.BOOLEAN, FIELD)
MODE = e.Signal("mode", e.ValueType.STRING, FIELD)
SCAN = e.Signal("scan", e.ValueType.NUMBERS, FIELD)
NAMES = e.Signal("names", e.ValueType.STRINGS, FIELD)
FLAGS = e.Signal("flags", e.ValueType.BOOLEANS, FIELD)


def from_text(text: str, name: str = "props.txt") -> tuple[list[Compiled], Spec]:
    """A specification, compiled; no error is expected."""
    compiled, specification = _compiled(text, name)
    return list(compiled), specification


@cache
def _compiled(text: str, name: str) -> tuple[Sequence[Compiled], Spec]:
    """Once for all tests of a process: what comes back is frozen."""
    specification, diagnostics = load_text(Source(name, text))
    assert specification is not None, diagnostics
    compiled, problems = compile_specification(specification, EPISODE, Budget(30.0, 1024))
    assert not problems
    return compiled, specification


def session(text: str, keep_verdicts: bool = True) -> ByRows:
    """A run of the specification `text`, to be judged row by row, before its first sample."""
    return ByRows(Session(load_plan(*from_text(text)), keep_verdicts))


def ns(seconds: float) -> int:
    """A time, exactly as it is written in a test."""
    return nanoseconds(repr(seconds))


def machine(monitor: Monitor, conditions: Mapping[str, Condition], label: str = "line 1", text: str = "p") -> Compiled:
    """Any monitor over atoms with these conditions as if it had been compiled."""
    atoms = tuple(Atom(name, condition, Span(0, 0)) for name, condition in conditions.items())
    alphabet = Alphabet(tuple(conditions))
    specification = PropertySpecification(label, 1, Span(0, 0), text, p.Now(ltl.TRUE), atoms, alphabet, {})
    return Compiled(specification, EPISODE, ltl.TRUE, monitor)


def never(condition: Condition, label: str = "line 1", text: str = "p") -> Compiled:
    """`never condition`, by hand."""
    verdicts = (Verdict.PRESUMABLY_SATISFIED, Verdict.VIOLATED)
    return machine(Monitor(("a",), verdicts, (-1, 1), (Decision(0, 0, 1),)), {"a": condition}, label, text)


def specification(compiled: Sequence[Compiled], name: str = "props.txt") -> Spec:
    return Spec(Source(name, ""), tuple(c.specification for c in compiled), ())


def emitted(compiled: Sequence[Compiled], name: str = "props.txt") -> dict[str, Any]:
    """The names that the emitted standalone module defines."""
    namespace: dict[str, Any] = {"__name__": "emitted"}
    exec(compile(python.emit(compiled, specification(compiled, name)), "emitted", "exec"), namespace)
    return namespace


ODD = "it's \"\\\n{{ x }}"
CONSTANTS = (0.0, 1.0, -1.0, 2.5, 0.1, math.inf)
SAMPLES = (0.0, -0.0, 1.0, -1.0, 2.5, 0.1, 1e308, math.inf, -math.inf, math.nan, 0.30000000000000004)


LEAVES: tuple[e.Expression, ...] = (e.Current(X), e.Current(Y), e.Current(Z), e.Past(X, 1), e.Past(Z, 3))
OF_ARRAYS = [function for function in Function if function.takes.array]
OF_SOME = (Function.MIN, Function.MAX, Function.NORM)
OF_TWO = [function for function in Function if function.form and function.takes.most == 2]
OF_ONE = [function for function in Function if function.takes.most == 1]
STRINGS: tuple[e.Expression, ...] = (e.Current(MODE), e.Past(MODE, 2), e.String("a"), e.String(ODD))
BOOLEANS: tuple[e.Expression, ...] = (e.Current(FLAG), e.Past(FLAG, 1), e.Boolean(True), e.Boolean(False))


def numeric(depth: int = 2) -> st.SearchStrategy[e.Expression]:
    """Expressions over `X`, `Y`, `Z`, their past, an array and constants; none that is a constant is NaN (LTL213)."""
    return _numeric(depth).filter(lambda found: any(True for _ in e.reads(found)) or not is_nan(evaluate(found, {})))


@st.composite
def _numeric(draw: st.DrawFn, depth: int) -> e.Expression:
    match draw(st.integers(0, 8 if depth else 1)):
        case 0:
            return draw(st.sampled_from(LEAVES))
        case 1:
            return e.Number(draw(st.sampled_from(CONSTANTS)))
        case 2:
            return e.Negative(draw(numeric(depth - 1)))
        case 3 | 4:
            operator = draw(st.sampled_from(e.Operator))
            return e.Arithmetic(operator, draw(numeric(depth - 1)), draw(numeric(depth - 1)))
        case 5:
            return e.Call(draw(st.sampled_from(OF_ONE)), (draw(numeric(depth - 1)),))
        case 6:
            function = draw(st.sampled_from([*OF_SOME, *OF_TWO]))
            count = 2 if function in OF_TWO else draw(st.integers(2, 3))
            return e.Call(function, tuple(draw(numeric(depth - 1)) for _ in range(count)))
        case 7:
            return draw(counts())
        case _:
            return e.Call(draw(st.sampled_from(OF_ARRAYS)), (draw(arrays()),))


@st.composite
def arrays(draw: st.DrawFn, of: e.Signal = SCAN) -> e.Expression:
    """An array, its past, or a part of one."""
    wholes: list[e.Expression] = [e.Current(of), e.Current(of), e.Past(of, 1)]
    whole = draw(st.sampled_from(wholes))
    ends = st.one_of(st.none(), st.integers(-3, 3))
    return e.Slice(whole, draw(ends), draw(ends)) if draw(st.booleans()) else whole


@st.composite
def of_elements(draw: st.DrawFn) -> Condition:
    """What can be asked of elements."""
    match draw(st.integers(0, 4)):
        case 0:
            return Same(e.Element(draw(arrays(NAMES))), draw(st.sampled_from(STRINGS)))
        case 1:
            return IsTrue(e.Element(draw(arrays(FLAGS))))
        case 2:
            return IsTrue(draw(st.sampled_from(BOOLEANS)))
        case _:
            relation, margin = draw(st.sampled_from(Relation)), draw(st.sampled_from([0.0, 0.1, -0.1]))
            element: e.Expression = e.Element(draw(arrays()))
            if draw(st.booleans()):
                element = e.Arithmetic(draw(st.sampled_from(e.Operator)), element, draw(numeric(0)))
            right = draw(st.one_of(numeric(0), arrays().map(e.Element)))
            return Comparison(element, relation, right, abs(margin) if relation is Relation.EQUAL else margin)


@st.composite
def counts(draw: st.DrawFn) -> Count:
    """The number of elements of which some predicate holds."""
    named = {f"c{i}": c for i, c in enumerate(draw(st.lists(of_elements(), min_size=1, max_size=3)))}
    count = Count(draw(predicates(tuple(named))), tuple(named.items()))
    return count if count.elements else Count(count.predicate, (*count.conditions, ("flags", IsTrue(ANY_FLAG))))


ANY_FLAG = e.Element(e.Current(FLAGS))


@st.composite
def conditions(draw: st.DrawFn) -> Condition:
    """Comparisons with and without margin, booleans and strings."""
    match draw(st.integers(0, 7)):
        case 3:
            return Comparison(draw(counts()), draw(st.sampled_from([Relation.AT_LEAST, Relation.LESS])), e.Number(1.0))
        case 0:
            return Same(draw(st.sampled_from(STRINGS)), draw(st.sampled_from(STRINGS)))
        case 1:
            return Same(draw(st.sampled_from(BOOLEANS)), draw(st.sampled_from(BOOLEANS)))
        case 2:
            return IsTrue(draw(st.sampled_from(BOOLEANS)))
        case _:
            relation, margin = draw(st.sampled_from(Relation)), draw(st.sampled_from([0.0, 0.1, -0.1]))
            moved = abs(margin) if relation is Relation.EQUAL else margin
            return Comparison(draw(numeric()), relation, draw(numeric()), moved)


@st.composite
def machines(draw: st.DrawFn, most_states: int = 10) -> Compiled:
    """Any complete machine over random conditions, in which permanent verdicts are."""
    named = {f"a{i}": c for i, c in enumerate(draw(st.lists(conditions(), min_size=1, max_size=4)))}
    kinds = st.sampled_from([v for v in Verdict if v is not Verdict.NOT_STARTED])
    verdicts = draw(st.lists(kinds, min_size=1, max_size=most_states))
    diagrams, edges = Diagrams(), []
    for state, verdict in enumerate(verdicts):
        edges.append(
            diagrams.terminal(state) if verdict.is_permanent else draw(_diagram(diagrams, len(named), len(verdicts)))
        )
    nodes = [n for n in diagrams.reachable(*edges) if not diagrams.is_terminal(n)]
    target = {n: ~i for i, n in enumerate(nodes)}
    decisions = []
    for node in nodes:
        atom, low, high = diagrams.split(node)
        decisions.append(Decision(atom, *(target[n] if n in target else diagrams.value(n) for n in (low, high))))
    leads = tuple(target[n] if n in target else diagrams.value(n) for n in edges)
    return machine(Monitor(tuple(named), tuple(verdicts), leads, tuple(decisions)), named)


@st.composite
def _diagram(draw: st.DrawFn, diagrams: Diagrams, atoms: int, states: int) -> int:
    def build(level: int) -> int:
        if level == atoms or draw(st.integers(0, 3)) == 0:
            return diagrams.terminal(draw(st.integers(0, states - 1)))
        return diagrams.decision(level, build(level + 1), build(level + 1))

    return build(0)


def samples() -> st.SearchStrategy[dict[e.Signal, Any]]:
    """A value for each signal."""
    numbers = st.one_of(st.sampled_from(SAMPLES), st.integers(-3, 3).map(float))
    return st.fixed_dictionaries(
        {
            X: numbers,
            Y: numbers,
            Z: numbers,
            FLAG: st.booleans(),
            MODE: st.sampled_from(["a", "b", ODD]),
            SCAN: st.lists(numbers, max_size=4).map(tuple),
            NAMES: st.lists(st.sampled_from(["a", "b", ODD]), max_size=4).map(tuple),
            FLAGS: st.lists(st.booleans(), max_size=4).map(tuple),
        }
    )


def expected(compiled: Compiled, run: Sequence[dict[e.Signal, Any]]) -> tuple[list[str], int]:
    """The verdicts by definition, every step being a sample of every signal; and how many steps are invalid."""
    property_, monitor = compiled.specification, compiled.monitor
    state, verdict, invalid, answers = 0, Verdict.NOT_STARTED, 0, []
    for now in range(len(run)):
        back = {i: now - getattr(i, "samples", 0) for i in property_.inputs()}
        if all(step >= 0 for step in back.values()):
            seen = letter(property_.atoms, {i: run[step][i.signal] for i, step in back.items()})
            if seen is None:
                invalid += 1
            else:
                state = monitor.step(state, seen)
                verdict = monitor.verdicts[state]
        answers.append(verdict.value)
    return answers, invalid
