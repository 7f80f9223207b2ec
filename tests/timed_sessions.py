"""Rows of boolean signals, and what a property makes of them by the language: the reference for sessions in time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from hypothesis import strategies as st
from timed import ARRIVAL, Draw, past_of

from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.instants import Instant, Step, instants, with_past
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import Age, News, TimedAtom, atoms_within, counts_of
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.verdicts import Verdict

NEWS = (ARRIVAL, News("new x"))
"""What `timed_properties` has news of: a topic that no property reads otherwise, and one that has a value."""

LONG = 40
"""After so many ns nothing changes any more by itself in properties that are drawn here."""


def timed_properties() -> st.SearchStrategy[Property]:
    """Properties with bounds, past operators, ages and news, also of a signal that has a value."""
    return st.randoms(use_true_random=False).map(lambda chance: Draw(chance, NEWS).property())


@dataclass(frozen=True)
class Row:
    """What came in at a time, in ns: values by the names of signals, each on its own topic."""

    time: int
    values: Mapping[str, bool]


def rows() -> st.SearchStrategy[list[Row]]:
    """Rows some of which come at the same time; `w` is read by no property."""
    cells = st.dictionaries(st.sampled_from("xyznw"), st.booleans(), max_size=5)
    one = st.tuples(st.sampled_from([0, 1, 1, 2, 3, 5]), cells)

    def timed(drawn: list[tuple[int, dict[str, bool]]]) -> list[Row]:
        time, found = 10, []
        for gap, values in drawn:
            time += gap
            found.append(Row(time, values))
        return found

    return st.lists(one, min_size=1, max_size=7).map(timed)


_HOLDS = {
    Verdict.NOT_STARTED: None,
    Verdict.VIOLATED: False,
    Verdict.PRESUMABLY_VIOLATED: False,
    Verdict.PRESUMABLY_SATISFIED: True,
    Verdict.SATISFIED: True,
}


@dataclass
class Judge:
    """What a run of one property is by the language: its steps, one after the other, and what holds at a time.

    Among `steps` are messages that make none; `taken` are the others. Ages count from `before` at the first one.
    """

    property: Property
    formula: Formula = field(init=False)
    session: int | None = None
    heard: dict[str, int] = field(default_factory=dict)
    before: dict[str, int] = field(default_factory=dict)
    taken: int = 0
    steps: list[Step] = field(default_factory=list)
    values: dict[str, bool] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.formula = encode(self.property, EPISODE)
        counts = counts_of(self.formula)
        found = [a for part in (self.formula, *(each.operand for each in counts)) for a in atoms_within(part)]
        self.past = past_of(self.property)
        self.news = [a for a in found if isinstance(a, News)]
        self.read = {a.name for a in found if not isinstance(a, TimedAtom)}

    def take(self, time: int, values: Mapping[str, bool], new: Iterable[str], is_step: bool = True) -> None:
        """`values` came in, and messages of the signals `new`: a step if `is_step`, once all that is read is known."""
        begins = self.session is None
        self.session = time if self.session is None else self.session
        self.values.update(values)
        heard = self.told(new)
        wanted = bool(self.read & values.keys()) or bool(heard) or (begins and not self.read)
        if is_step and wanted:
            self.step(time, heard)

    def told(self, signals: Iterable[str]) -> set[str]:
        """What news the property takes note of when messages of `signals` come at a step."""
        return {f"{what} {name}" for name in signals for what in ("new", "message on")} & {n.name for n in self.news}

    def step(self, time: int, heard: Iterable[str]) -> None:
        """A step, with news `heard`, if all that is read is known; else ages count from that news."""
        self.heard |= dict.fromkeys(heard, time)
        if self.read <= self.values.keys():
            self.steps.append(Step(time, frozenset(n for n in self.read if self.values[n]).union(heard)))
            self.taken += 1
        else:
            self.before |= dict.fromkeys(heard, time)

    def hear(self, time: int, signals: Iterable[str]) -> None:
        """Messages that make no step: an instant if an age was late, at which the letter is held."""
        messages = {name for name in self.told(signals) if name.startswith("message on")}
        ages = [a for a in self.past if isinstance(a, Age) and a.news.name in messages]
        late = any(time - self.heard.get(a.news.name, self._session_began()) > a.most for a in ages)
        self.heard |= dict.fromkeys(messages, time)
        if not self.steps:
            self.before |= dict.fromkeys(messages, time)
            return
        held = self.steps[-1].letter - {news.name for news in self.news}
        if late or self.steps[-1].time < time:
            self.steps.append(Step(time, held | messages))
        else:
            self.steps[-1] = Step(time, self.steps[-1].letter | messages)

    def _session_began(self) -> int:
        assert self.session is not None
        return self.session

    def holds(self, time: int) -> bool | None:
        """Whether the property holds on what has been seen up to `time`; None before its first step."""
        return satisfies(self.word(time), self.property) if self.steps else None

    def agrees(self, verdict: Verdict, time: int) -> bool:
        """Whether `verdict` on what has been seen up to `time` is right: if it is permanent, however time goes on."""
        return _HOLDS[verdict] == self.holds(time + LONG if verdict.is_permanent else time)

    def verdict(self, monitor: Monitor, time: int) -> Verdict:
        """The verdict of the reference: `monitor`, which reads timed atoms, along a timed run."""
        run = TimedRun(trackers_of(self.formula), self.news, self.session, counts=counts_of(self.formula))
        for news, heard in self.before.items():
            list(run.hear(heard, {news}))
        state = 0
        for step in self.steps:
            for letter in run.step(*step):
                state = monitor.step(state, letter)
        for letter in run.hold(time):
            state = monitor.step(state, letter)
        return monitor.verdicts[state] if self.steps else Verdict.NOT_STARTED

    def word(self, time: int) -> tuple[Instant, ...]:
        word = instants(self.steps, time, self.news)
        for atom in self.past:
            counted = self.before.get(atom.news.name) if isinstance(atom, Age) else None
            word = with_past(word, [atom], self.session if counted is None else counted)
        return word
