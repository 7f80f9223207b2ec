"""The replay: the code as emitted is run, and must do what its monitor and the definitions say."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from typing import Any, Generic, TypeVar

from ltlc.base.files import ScratchError
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.denotation import opened, time_opens
from ltlc.semantics.instants import Instant
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Word

Event = TypeVar("Event")

Shown = dict[str, Any]
"""What emitted code shows of a property: its `verdict` and, where it knows them, `steps`, `invalid`, `episodes`.

`changes` are the verdicts that an event has led to, and their times; `settled` those of them that the moments end with,
where it is another one than before."""


@dataclass(frozen=True, slots=True)
class Run(Generic[Event]):
    """What emitted code is given, one event after the other, and the steps that each leads to by definition.

    Of a step or clock step there is the letter, or None where something is NaN. `settings` say how the run is started.
    """

    events: Sequence[Event]
    steps: Sequence[Sequence[Instant | None]]
    settings: Any = None


Id = bool | int | float | str
"""What distinguishes slices."""


@dataclass(frozen=True, slots=True)
class SlicedRun(Run[Event]):
    """A run of what is judged for each id: `slices` has the steps of each slice at each event."""

    slices: Sequence[Mapping[Id, Sequence[Instant | None]]] = ()


Stepper = Callable[[Event], Shown]
"""Emitted code in the midst of a run: takes an event, and shows what has become of the property."""


@dataclass(frozen=True, slots=True)
class Replayed:
    """The emitted code showed what it should on all `runs` runs; they had `letters` different letters."""

    runs: int
    letters: int


@dataclass(frozen=True, slots=True)
class Deviation:
    """After `events` events, of which `event` is the last, the emitted code shows `emitted` where `expected` is right.

    `emitted` is a text where the code raises an exception.
    """

    events: int
    event: Any
    expected: Shown
    emitted: Shown | str


def replay(
    compiled: Compiled, start: Callable[[Any], Stepper[Event]], runs: Iterable[Run[Event]]
) -> Replayed | Deviation:
    """Step what `start` makes ready with the settings of a run through the events of the run, for each run."""
    expectation = Expectation(compiled)
    count, letters = 0, set()
    for run in runs:
        count += 1
        letters |= {letter for steps in run.steps for letter in steps}
        if deviation := _deviation(list(expectation.of(run)), start, run):
            return deviation
    return Replayed(count, len(letters - {None}))


def _deviation(expected: Sequence[Shown], start: Callable[[Any], Stepper[Event]], run: Run[Event]) -> Deviation | None:
    count = 0
    try:
        stepper = start(run.settings)
        for count, event in enumerate(run.events):
            emitted, right = stepper(event), expected[count]
            if any(emitted[name] != value for name, value in right.items() if name in emitted):
                return Deviation(count + 1, event, right, emitted)
    except ScratchError:
        raise
    except Exception as error:  # whatever emitted code does wrong is a finding, not the end of the gate
        return Deviation(count + 1, run.events[count], expected[count], f"{type(error).__name__}: {error}")
    return None


def settled(before: str, changes: Sequence[tuple[int, str]]) -> list[tuple[int, str]]:
    """Of `changes`, the last at each time, if the verdict is then another one than at the end of the time before."""
    found, last = [], before
    for time, verdict in dict(changes).items():
        if verdict != last:
            found.append((time, verdict))
        last = verdict
    return found


class Expectation:
    """Says what has to be shown of one property: its monitor's verdict, and the episodes of its denotation."""

    def __init__(self, compiled: Compiled) -> None:
        self._monitor = compiled.monitor
        self._has_openings = bool(compiled.specification.openings())
        self._opened = cache(lambda word: opened(word, compiled.specification.property))
        self._time_opens = time_opens(compiled.specification.property)

    def of(self, run: Run[Any]) -> Iterator[Shown]:
        """What to show after each event; at the last one, how many episodes opened up to the decision, too.

        Once the verdict is permanent no values are taken at openings, so what a step would read then is not defined.
        """
        if isinstance(run, SlicedRun):
            yield from self._of_slices(run)
            return
        state, invalid, steps = 0, 0, 0
        verdict = Verdict.NOT_STARTED
        word: Word = ()
        for number, letters in enumerate(run.steps):
            changes = []
            before_all = verdict
            for letter in letters:
                if letter is None:
                    invalid += 1
                    continue
                if not verdict.is_permanent and (self._time_opens or not letter.by_time):
                    word = (*word, letter)
                state = self._monitor.step(state, letter)
                before, verdict = verdict, self._monitor.verdicts[state]
                if verdict is not before:
                    changes.append((letter.time, verdict.value))
                steps += not letter.by_time
            shown: Shown = {"verdict": verdict.value, "changes": changes, "settled": settled(before_all.value, changes)}
            if not (verdict.is_permanent and self._has_openings):
                shown |= {"steps": steps, "invalid": invalid}
            is_last = number == len(run.steps) - 1
            yield shown | {"episodes": self._opened(word)} if is_last else shown

    def _of_slices(self, run: SlicedRun[Any]) -> Iterator[Shown]:
        """What to show of all slices: the verdict that each moment ends with, which ids violate it, which are owed."""
        states: dict[Id, int] = {}
        violated: dict[Id, int] = {}
        whole = Verdict.NOT_STARTED
        for slices in run.slices:
            before, changes = whole, list[tuple[int, str]]()
            judged = [(each.time, id_, each) for id_, steps in slices.items() for each in steps if each is not None]
            for time, id_, letter in sorted(judged, key=lambda each: each[0]):
                states[id_] = self._monitor.step(states.get(id_, 0), letter)
                if self._monitor.verdicts[states[id_]] is Verdict.VIOLATED:
                    violated.setdefault(id_, time)
                whole = conjunction(self._monitor.verdicts[state] for state in states.values())
                changes.append((time, whole.value))
            owed = {i for i, state in states.items() if self._monitor.verdicts[state] is Verdict.PRESUMABLY_VIOLATED}
            yield {
                "verdict": whole.value,
                "settled": settled(before.value, changes),
                "violated": dict(violated),
                "owed": owed,
                "owing": len(owed),
                "failed": len(violated),
            }


def conjunction(verdicts: Iterable[Verdict]) -> Verdict:
    """That of all slices that have started: of an id that has not come, nothing is known."""
    found = set(verdicts)
    for verdict in (Verdict.VIOLATED, Verdict.PRESUMABLY_VIOLATED):
        if verdict in found:
            return verdict
    return Verdict.PRESUMABLY_SATISFIED if found else Verdict.NOT_STARTED
