"""The lowered program of a property: a machine as frozen, typed data, of no target, with one semantics, written here.

Between the calls of whoever runs it, a machine has a state, a verdict, a due time for each of its clocks, the value of
each register, a count `invalid`, and the values of its inputs at the last step. `tests/program_reference.py` is this
text as code.

- *Begin*, when the session begins: state 0, verdict NOT_STARTED. An age is due its duration later, no other clock;
  occurrences are late.
- *Message*, on a topic that the signal of an age is read from, at a time, whether or not it makes a step: after the
  clock steps up to that time, the age is due its duration after it. If there is no step, and the age was late before
  the message and is not so after it, a clock step comes at that time.
- *Step*, at a time, with values of `inputs`. First the clock steps up to that time are taken. Of an input that is
  `excused` there may be no value yet: if it has news, and all of that has come nevertheless, `invalid` grows by one,
  and there is no step; else its value is what is said `instead`. A register whose `closed` has the state takes its
  value. If a guard is NaN, that is undone, `invalid` grows by one, and there is no step. Else, where the condition of
  occurrences holds and, if it `begins`, did not at the step before, it occurs; of the last `times` times of that, once
  there are as many, the clock is due the duration after the first, without one never. Then the decisions from the
  state's `step` lead to an outcome. Until the first step there are no clock steps.
- *Clock step*, a nanosecond after the least due time, but for those of ages and occurrences that were late at the
  last instant; or a nanosecond after that, if it had `again`. None comes in a state without `expire`. The decisions
  from there lead to an outcome. Inputs are as at the last step, but there is no news. Nothing is invalid here: of NaN,
  which a register may have brought, every comparison is false.
- *Decisions* ask atoms, which are Boolean expressions over inputs and registers, and clocks: whether the time of the
  instant is past the clock's due time; then it is late.
- *Outcome*: the state is another one, and the verdict is that of this state; clocks are set, of which ages and
  occurrences are none; with `again`, a clock step comes a nanosecond later. One that has `taken` registers, at clock
  steps only, does nothing else but go to its state: these registers take their values, and the clock step, which is
  still due, is taken from there.
- *End*: nothing. What is owed stays owed.
"""

from __future__ import annotations

from dataclasses import field
from enum import Enum
from typing import Any, NamedTuple

from ltlc.dataclass import dataclass
from ltlc.program.expressions import Expression, Held, Kept, News, Read
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.monitor import Decision, Target
from ltlc.semantics.verdicts import Verdict


class Base(Enum):
    """What a due time counts from."""

    NOW = "this instant"
    JUST_BEFORE = "a nanosecond before this instant"
    DUE = "when the clock was due"
    NEVER = "never"


class Clock(NamedTuple):
    """Something to be late: what outcomes set, the `age` of the last message of a signal, or that of `occurrences`."""

    age: Age | None = None
    occurrences: Occurrences | None = None

    @property
    def is_set(self) -> bool:
        """Whether outcomes set it; others are asked at every instant."""
        return self.age is None and self.occurrences is None


class Age(NamedTuple):
    """It is late more than `duration` after the last message that `signal` is read from, or the session's beginning."""

    signal: str
    duration: Nanoseconds


class Occurrences(NamedTuple):
    """It is late unless `condition` occurred `times` times, the first of the last ones at most `duration` ago.

    Without a duration, it is not late any more once it occurred so often. The condition reads no registers. If that is
    `presumed`, the clock is due the duration after the first step, before there are so many.
    """

    condition: Expression
    begins: bool
    times: int
    duration: Nanoseconds | None
    presumed: bool = False


class Set(NamedTuple):
    """The clock with this number is due `duration` after `base`."""

    clock: int
    base: Base
    duration: Nanoseconds = 0


class Outcome(NamedTuple):
    """Where an instant leads; `taken` are registers by number."""

    state: int
    sets: tuple[Set, ...] = ()
    again: bool = False
    taken: tuple[int, ...] = ()


class State(NamedTuple):
    """The verdict that is shown in it, and where a step leads and a clock step; None if none comes.

    A target is the number of an outcome or, below 0, the decision `~target`.
    """

    verdict: Verdict
    step: Target
    expire: Target | None = None


Instead = bool | int | float | str | tuple[Any, ...]
"""A value that stands in for another; of arrays, those that have elements are of numbers."""


class Excused(NamedTuple):
    """A property does not wait for `input`, which is `instead` until it has a value.

    Without its `news` it makes no difference; where there is none, what it is then is what was written.
    """

    input: Held
    news: tuple[News, ...]
    instead: Instead


class Register(NamedTuple):
    """A value at an opening: at a step from a state in `closed` it is the latest one, from others it stays."""

    kept: Kept
    closed: frozenset[int]

    @property
    def latest(self) -> Held:
        """What it takes."""
        return Held(self.kept.signal, 0, self.kept.type)


@dataclass(frozen=True, slots=True)
class Machine:
    """What judges one property.

    A decision asks the atom with the number `atom` or, from `len(atoms)` on, a clock. Atoms and decisions have their
    normal forms (`ltlc.program.normal`), so that equal machines are equal as data, whatever the property is called.
    """

    label: str = field(compare=False)
    text: str = field(compare=False)
    line: int = field(compare=False)
    inputs: tuple[Read, ...]
    guards: tuple[Expression, ...]
    atoms: tuple[Expression, ...]
    clocks: tuple[Clock, ...]
    registers: tuple[Register, ...]
    states: tuple[State, ...]
    decisions: tuple[Decision, ...]
    outcomes: tuple[Outcome, ...]
    excused: tuple[Excused, ...] = ()

    @property
    def waits_for(self) -> tuple[Read, ...]:
        """The inputs that a step needs a value of."""
        excused = {each.input for each in self.excused}
        return tuple(each for each in self.inputs if not isinstance(each, News) and each not in excused)

    @property
    def is_timed(self) -> bool:
        """Whether it takes clock steps, or asks clocks."""
        asks = any(decision.atom >= len(self.atoms) for decision in self.decisions)
        return asks or any(state.expire is not None for state in self.states)
