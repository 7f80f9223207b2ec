"""What runs of a property with clocks, folded and emitted, gives the verdicts of its monitor on the run in time."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import pytest
from effort import share_of
from stepping import emitted as python_module
from stepping import from_text
from timed import ARRIVAL, MESSAGE, Draw, compiled

from ltlc.assurance.programs import load
from ltlc.automata.folding import fold
from ltlc.backends.python import standalone_classes
from ltlc.backends.python.load import load_plan
from ltlc.backends.python.monitors import runtime_class
from ltlc.backends.steps import clock_names
from ltlc.compiler import Compiled
from ltlc.program.machine import Machine
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.times import SECOND
from ltlc.semantics import properties as p
from ltlc.semantics.instants import Instant, Observation, Step
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import Age, TimedAtom, atoms_within
from ltlc.semantics.timed_monitor import Effect, TimedMonitor
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import New

NEVER = 1 << 62
NUMBERS = "decl distance /distance std_msgs/Float64.data\ndecl speed /speed std_msgs/Float64.data\n"


class Folded:
    """Runs a `TimedMonitor` by what its fields say."""

    def __init__(self, monitor: TimedMonitor, session: int) -> None:
        self.monitor = monitor
        self.state = 0
        self.letter: frozenset[str] = frozenset()
        self.again = NEVER
        self.time: int | None = None
        self.clocks = [NEVER if age is None else session + age.duration for age in monitor.ages]

    def hear(self, time: int) -> bool:
        """A message renews the ages; whether some was late."""
        ages = {c: age.duration for c, age in enumerate(self.monitor.ages) if age is not None}
        was_late = any(time > self.clocks[c] for c in ages)
        for c, duration in ages.items():
            self.clocks[c] = time + duration
        return was_late and self.time is not None

    def step(self, time: int, letter: frozenset[str]) -> None:
        self.letter = letter - {ARRIVAL.name}
        self._go(self.monitor.edges, time, letter, time)

    @property
    def due(self) -> int:
        """Before the first step, and once the verdict is permanent, nothing is; an age that is late has been."""
        if self.time is None or self.verdict.is_permanent:
            return NEVER
        ages = [age is not None for age in self.monitor.ages]
        return min([self.again, *(d for d, age in zip(self.clocks, ages, strict=True) if not age or self.time <= d)])

    def expire(self, time: int | None = None) -> None:
        time = self.due + 1 if time is None else time
        self._go(self.monitor.held_edges, time, self.letter, time - 1)

    def _go(self, edges: tuple[int, ...], time: int, letter: frozenset[str], held: int) -> None:
        target, atoms = edges[self.state], self.monitor.atoms
        while target < 0:
            atom, low, high = self.monitor.decisions[~target]
            holds = atoms[atom] in letter if atom < len(atoms) else time > self.clocks[atom - len(atoms)]
            target = high if holds else low
        self.time = time
        self.state, actions, again, _ = self.monitor.outcomes[target]
        self.again = time if again else NEVER
        for clock, effect, duration in actions:
            since = {Effect.START: time, Effect.RELEASE: held, Effect.EXTEND: self.clocks[clock], Effect.STOP: NEVER}
            self.clocks[clock] = since[effect] + duration

    @property
    def verdict(self) -> Verdict:
        return self.monitor.verdicts[self.state]


class Running(NamedTuple):
    """Something that runs: how it takes a step, and a message that makes none."""

    monitor: Any
    step: Callable[[int, frozenset[str]], None]
    hear: Callable[[int], None]

    def catch_up(self, time: int) -> None:
        while time > self.monitor.due:
            self.monitor.expire()


def folded(made: Compiled) -> Callable[[int], Running]:
    monitor = fold(made.formula, made.specification.alphabet, made.monitor)

    def start(session: int) -> Running:
        running = Folded(monitor, session)

        def step(time: int, letter: frozenset[str]) -> None:
            while time > running.due:
                running.expire()
            if MESSAGE.name in letter:
                running.hear(time)
            running.step(time, letter)

        def hear(time: int) -> None:
            if running.hear(time):
                running.expire(time)

        return Running(running, step, hear)

    return start


PRELUDE = """from __future__ import annotations
import math
from ltlc.semantics.verdicts import Verdict
INFINITY = math.inf
NOT_STARTED, VIOLATED, SATISFIED = Verdict.NOT_STARTED, Verdict.VIOLATED, Verdict.SATISFIED
PRESUMABLY_VIOLATED, PRESUMABLY_SATISFIED = Verdict.PRESUMABLY_VIOLATED, Verdict.PRESUMABLY_SATISFIED
NEVER = 1 << 62
"""


def emitted(made: Compiled) -> Callable[[int], Running]:
    make = load(PRELUDE + runtime_class(made, "Emitted", "props.txt").text, "emitted")["Emitted"]
    inputs = [f"new {i.signal.name}" if isinstance(i, New) else i.signal.name for i in made.specification.inputs()]
    ages = [(name, age) for name, (age, _) in zip(clock_names(made.machine), made.machine.clocks, strict=True) if age]

    def start(session: int) -> Running:
        running = make(session)

        def renew(time: int) -> bool:
            was_late = any(time > getattr(running, name) for name, _ in ages)
            for name, age in ages:
                setattr(running, name, time + age.duration)
            return was_late and running.verdict is not Verdict.NOT_STARTED

        def step(time: int, letter: frozenset[str]) -> None:
            if MESSAGE.name in letter:
                while time > running.due:
                    running.expire()
                renew(time)
            running.step(time, *(name in letter for name in inputs))

        def hear(time: int) -> None:
            if renew(time):
                running.due = time - 1
                running.expire()

        return Running(running, step, hear)

    return start


def deviates(made: Compiled, start: Callable[[int], Running], run: Observation, heard: Iterable[int] = ()) -> bool:
    """Whether what runs gives another verdict than the monitor at some nanosecond of `run`.

    At the times `heard` a message comes that makes no step, after the step there, if there is one.
    """
    timed = TimedRun(trackers_of(made.formula), [ARRIVAL], run.session)
    running, state = start(run.session), 0

    def is_right(instants: Iterable[Instant]) -> bool:
        nonlocal state
        for instant in instants:
            state = made.monitor.step(state, instant)
        return running.monitor.verdict is made.monitor.verdicts[state]

    ends = [*(each.time for each in run.steps[1:]), run.until]
    for (time, letter), end in zip(run.steps, ends, strict=True):
        running.step(time, letter)
        if not is_right(timed.step(time, letter)):
            return True
        for now in range(time, end + 1):
            running.catch_up(now)
            if not is_right(timed.hold(now)):
                return True
            if now in heard:
                running.hear(now)
                if not is_right(timed.hear(now, {MESSAGE.name})):
                    return True
    return False


@pytest.mark.parametrize("form", [folded, emitted])
def test_what_runs_gives_the_verdicts_of_the_monitor_at_every_nanosecond(form: Any) -> None:
    judged = 0
    for seed in range(share_of(100)):
        draw = Draw(seed)
        property_ = draw.property()
        made = compiled(property_)
        if not any(isinstance(atom, TimedAtom) for atom in atoms_within(made.formula)):
            continue
        start = form(made)
        for run in (draw.run() for _ in range(6)):
            judged += 1
            heard = {time for time in range(run.until) if draw.chance.random() < 1 / 4}
            assert not deviates(made, start, run, heard), (property_, run, heard)
    assert judged > share_of(300)


def test_a_step_takes_the_clock_steps_before_it_whatever_came_meanwhile() -> None:
    judged = 0
    for seed in range(share_of(100)):
        draw = Draw(seed)
        made = compiled(draw.property())
        if not made.machine.is_timed:
            continue
        for run in (draw.run() for _ in range(6)):
            judged += 1
            running = emitted(made)(run.session)
            timed, state = TimedRun(trackers_of(made.formula), [ARRIVAL], run.session), 0
            for time, letter in run.steps:
                for instant in timed.step(time, letter):
                    state = made.monitor.step(state, instant)
                running.step(time, letter)
                assert running.monitor.verdict is made.monitor.verdicts[state], (made.specification.property, run)
    assert judged > share_of(300)


def test_a_signal_called_time_is_told_from_the_time() -> None:
    declared = "decl time /time std_msgs/Float64.data\n"
    [made], _ = from_text(f"{NUMBERS}{declared}always (distance < 1 implies eventually time > 1 within 2 s)")
    [written] = standalone_classes([made], "props.txt")
    monitor = python_module([made])[written.name](0)
    [name] = [name for name, signal in written.parameters if signal.name == "time"]
    assert monitor.step(time=1, distance=0.5, **{name: 0.0}).value == "presumably_violated"
    assert monitor.step(time=2, distance=2.0, **{name: 5.0}).value == "presumably_satisfied"


def test_a_deadline_passes_at_a_step_that_is_none() -> None:
    [made], _ = from_text(f"{NUMBERS}always (distance < 1 implies eventually speed < 0.1 within 2 s)")
    [written] = standalone_classes([made], "props.txt")
    monitor = python_module([made])[written.name](0)
    assert monitor.step(0, 0.5, 1.0) is monitor.verdict
    assert monitor.verdict.value == "presumably_violated"
    monitor.step(2_000_000_000, 0.5, math.nan)
    assert (monitor.verdict.value, monitor.invalid) == ("presumably_violated", 1)
    monitor.step(2_000_000_001, 0.5, math.nan)
    assert (monitor.verdict.value, monitor.invalid) == ("violated", 2)


AGED = Age("age", MESSAGE, 2)


@pytest.mark.parametrize("form", [folded, emitted])
@pytest.mark.parametrize("property_", [p.Now(AGED), p.Always(p.Implies(p.Now(Atom("x")), p.Now(AGED)))])
def test_an_age_that_runs_out_before_the_first_step_is_noticed_at_it(form: Any, property_: Property) -> None:
    made = compiled(property_)
    for session in range(-4, 1):
        for first in ("x", ""):
            steps = (Step(0, frozenset(first)), Step(4, frozenset("x")))
            assert not deviates(made, form(made), Observation(steps, 6, session)), session


@pytest.mark.parametrize("duration", [10**6, 5 * 10**9, 3600 * 10**9])
def test_what_runs_differs_by_the_durations_only(duration: int) -> None:
    def of(bound: int) -> Machine:
        goal = p.Within(bound, p.Eventually(p.Now(Atom("y"))))
        return compiled(p.Always(p.Implies(p.Now(Atom("x")), goal))).machine

    short, long = of(7), of(duration)
    assert (short.states, short.decisions) == (long.states, long.decisions)
    assert {each.duration for outcome in long.outcomes for each in outcome.sets} == {0, duration}


AGES = [
    "always (age(j) <= 2 s or @{i, -2} > 5)",
    "eventually (age(j) > 1 s and i < @{i, -1})",
    "always (age(j) <= 1 s and age(j) <= 3 s or @{i, -1} > 5) or never (age(k) > 2 s and i > @{i, -2})",
]


@pytest.mark.parametrize("text", AGES)
def test_emitted_python_counts_ages_from_news_that_comes_before_its_history_is_full(text: str) -> None:
    declared = "".join(f"decl {name} /{name} Float64.data\n" for name in "ijk")
    compiled, specification = from_text(declared + text)
    monitored, plan = python_module(compiled)["Monitors"], load_plan(compiled, specification)
    read = {wanted.signal.name for wanted in compiled[0].specification.inputs() if isinstance(wanted, New)}
    chance = random.Random(text)
    for _ in range(share_of(300)):
        rows, time = ByRows(Session(plan)), 0
        rows.begin(time)
        monitors = monitored(time)
        for _ in range(6):
            time += chance.choice([0, 1, SECOND - 1, SECOND, SECOND + 1, 2 * SECOND])
            value, news = chance.choice([0.0, 3.0, 9.0]), {name for name in read if chance.random() < 1 / 3}
            rows.samples(time, ("i",), [value], [f"/{name}" for name in news])
            (verdict,) = monitors.step(time=time, i=value, **{f"new_{name}": name in news for name in read}).values()
            assert verdict == rows.tracks[0].verdict.value


def test_times_that_no_run_has_end_no_program_in_an_endless_loop() -> None:
    text = (
        "decl x /x Float64.data\nvalue_error: always (x > 1 implies eventually x < 0 within 1 s)\nalways age(x) < 1 s"
    )
    compiled, _ = from_text(text)
    for call in ("step", "advance"):
        monitors = python_module(compiled)["Monitors"](0)
        monitors.step(0, 2.0, True)
        with pytest.raises(ValueError, match="before 2\\*\\*62 ns"):
            getattr(monitors, call)(2**62 + 1, *([0.0, False] if call == "step" else []))
