"""Whether a control follows a monitor: whether both show the same verdict after every run.

The pairs in which the two can be are given, and need not be trusted: a state of the control, one of the monitor, and
where the trackers are. In each, both have to show the same; every step and every nanosecond has to lead to such a pair
again, with the due times that the trackers ask for.

Coq: `proofs/Follows.v`, with the same names, and `Followed.v`, the proof that the answer may be believed:
`followed_sound`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from enum import Enum, auto
from functools import partial
from itertools import product
from typing import NamedTuple, TypeVar

from ltlc.dataclass import dataclass
from ltlc.semantics.certificate import DEPTH, WORK
from ltlc.semantics.conditions import FALSE_CONDITION, Bound, Condition, Conditions, Memory
from ltlc.semantics.control import Base, Followed, Outcome, Pair, Setting, Stance, Way
from ltlc.semantics.ltl import Formula, Not, atoms, conjunction
from ltlc.semantics.monitor import Monitor, Target
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.timed_atoms import Age
from ltlc.semantics.trackers import Case, Phase, State, Tracker

Result = TypeVar("Result")

Answered = Mapping[str, bool]
"""The atoms that have been asked for on the way. Coq: `answered`."""

Land = Callable[[Outcome, int, Answered, Condition], bool]
"""Whether an outcome of the control and a state of the monitor are right, by letters with these answers."""


@dataclass(frozen=True, slots=True)
class Following:
    """Whether the control is shown to follow the monitor; if not, the bound that was `met`, if any."""

    follows: bool
    met: Bound | None = None


def follows_monitor(
    formula: Formula,
    assumption: Formula,
    monitor: Monitor,
    program: Followed,
    depth: int = DEPTH,
    work: int = WORK,
) -> Following:
    """Whether `program` shows the verdicts of `monitor`, of `formula`, over the letters that satisfy `assumption`.

    Coq: `follows_monitor`.
    """
    checker = _Checker(formula, assumption, monitor, program, depth, work)
    try:
        follows = checker.is_right()
    except _OutOfWorkError:
        follows = False
    return Following(follows, None if follows else checker.memory.met)


class _OutOfWorkError(Exception):
    """There are more ways for time to go on than may be looked at."""


class _Occasion(Enum):
    """Coq: `occasion`."""

    OPENING = auto()
    """The first step."""
    STEP = auto()
    """Another step."""
    WAIT = auto()
    """An instant a nanosecond later than the one before."""


class _Row(NamedTuple):
    """A clock at an instant: its tracker, the state before, and the case. Coq: `row`."""

    tracker: Tracker
    state: State
    case: Case

    @property
    def counts(self) -> bool:
        """Whether a bound is yet to pass; that of an age from the beginning of the session on. Coq: `counts`."""
        is_first = isinstance(self.tracker.subject, Age) and self.state.phase is Phase.FIRST
        return is_first or self.tracker.is_running(self.state)


class _Decides(NamedTuple):
    """A question with what follows 'yes' and 'no'. Coq: `Decides`."""

    asked: str | int
    if_so: int
    if_not: int


class _Checker:
    def __init__(
        self, formula: Formula, assumption: Formula, monitor: Monitor, program: Followed, depth: int, work: int
    ) -> None:
        self.control, self.pairs, self.monitor = program.control, program.pairs, monitor
        self.depth = depth
        self.time = ResetMachine(formula)
        self.conditions = Conditions()
        self.memory = Memory(work)
        self.allowed = self.conditions.unfold(assumption)
        self.no_news = conjunction(map(Not, self.time.news))
        self.decided = {atom for tracker in self.time.trackers for atom in tracker.atoms}

    def is_right(self) -> bool:
        return (
            self.control.first_due == tuple(self.first_dues())
            and self.decided.isdisjoint(branch.asked for branch in self.control.branches)
            and self.begins_right()
            and all(self.pair_is_right(pair) for pair in self.pairs)
        )

    def first_dues(self) -> Iterable[int | None]:
        """When the clocks are first due. Coq: `first_dues`."""
        for tracker in self.time.trackers:
            if tracker.bounds:
                is_due = isinstance(tracker.subject, Age) and not self.is_permanent(0)
                yield tracker.bounds[0] if is_due else None

    def is_permanent(self, judged: int) -> bool:
        """Coq: `permanent`."""
        return self.monitor.verdicts[judged].is_permanent

    def begins_right(self) -> bool:
        """Coq: `begins_right`."""
        stance = self.control.stances[0]
        if stance.verdict is not self.monitor.verdicts[0]:
            return False
        if self.is_permanent(0):
            return any(_meets(Outcome(0), 0, pair) for pair in self.pairs)
        return self.move_on(_Occasion.OPENING, stance, Pair(0, 0, self.time.initial.states), self.allowed)

    def pair_is_right(self, pair: Pair) -> bool:
        """Coq: `pair_is_right`."""
        stance = self.control.stances[pair.state]
        if stance.verdict is not self.monitor.verdicts[pair.judged]:
            return False
        if self.is_permanent(pair.judged):
            lead = partial(self.lead, (), pair=pair, letters=self.allowed, land=self.lands_for_good)
            return not pair.looks_again and lead(way=stance.step) and lead(way=None)
        if not self.move_on(_Occasion.STEP, stance, pair, self.allowed):
            return False
        return not pair.looks_again if self.time.is_trivial else self.waits_right(stance, pair)

    def waits_right(self, stance: Stance, pair: Pair) -> bool:
        """Whether what happens after `pair` by time alone is right: the letter is held, without its news."""
        timed = self.decided.union(news.name for news in self.time.news)
        if not timed.isdisjoint(atoms(pair.last_letter)):
            return False
        held = self.narrowed(self.allowed, conjunction([pair.last_letter, self.no_news]))
        return held is None or self.move_on(_Occasion.WAIT, stance, pair, held)

    def move_on(self, occasion: _Occasion, stance: Stance, pair: Pair, letters: Condition) -> bool:
        """Whether all that trackers may do after `pair` leads to a pair again. Coq: `move_on`."""
        clocks = Clocks(occasion is _Occasion.OPENING, pair.stand)
        for among, cases in self.time.side_by_side(clocks, letters, self.narrowed):
            if occasion is _Occasion.STEP and self.time.passing(clocks, cases):
                continue  # a step comes after the clock steps up to its time
            together = zip(self.time.trackers, pair.stand, cases, strict=True)
            rows = [_Row(*row) for row in together if row[0].bounds]
            land = partial(self.lands, occasion, rows, tuple(case.state for case in cases))
            for late in product(*(_may_be_late(occasion, row) for row in rows)):
                way: Way | None = stance.step
                if occasion is _Occasion.WAIT:
                    way = stance.clock_step if pair.looks_again or any(late) else None
                    if way is None and (pair.looks_again or any(late)):
                        return False
                if not self.lead(late, pair=pair, letters=among, land=land, way=way):
                    return False
        return True

    def narrowed(self, letters: Condition, predicate: Formula) -> Condition | None:
        """Those of `letters` that satisfy `predicate`. Coq: `narrowed`."""
        found = self.conditions.conjunction(letters, self.conditions.unfold(predicate))
        if not self.memory.spend(self.conditions.node(found).weight):
            raise _OutOfWorkError
        return None if found == FALSE_CONDITION else found

    def lands(
        self,
        occasion: _Occasion,
        rows: list[_Row],
        states: tuple[State, ...],
        outcome: Outcome,
        judged: int,
        known: Answered,
        letters: Condition,
    ) -> bool:
        """Whether clocks are set as they should be, and there is a pair for what comes next. Coq: `lands`."""
        is_over = self.is_permanent(judged)
        is_right = _is_off if is_over else partial(_is_due_right, occasion)
        if not all(is_right(row, _setting_of(clock, outcome)) for clock, row in enumerate(rows)):
            return False
        return any(
            _meets(outcome, judged, pair)
            and (is_over or pair.stand == states)
            and self.conditions.follows(self.depth, letters, self.under(known, pair.last_letter), self.memory)
            for pair in self.pairs
        )

    def under(self, known: Answered, predicate: Formula) -> Condition:
        """What remains of `predicate` with what has been answered. Coq: `under`."""
        found = self.conditions.unfold(predicate)
        for atom, value in known.items():
            found = self.conditions.assign(self.conditions.fact_of_atom(atom), value, found)
        return found

    def lands_for_good(self, outcome: Outcome, judged: int, _: Answered, __: Condition) -> bool:
        """The same once the verdict is permanent: no clock runs, and none is started. Coq: `lands_for_good`."""
        starts = any(setting.base in (Base.NOW, Base.JUST_BEFORE) for setting in outcome.settings)
        return self.is_permanent(judged) and any(_meets(outcome, judged, pair) for pair in self.pairs) and not starts

    def lead(self, late: tuple[bool, ...], *, pair: Pair, letters: Condition, land: Land, way: Way | None) -> bool:
        """Whether `letters` lead from `way`, or from staying, and from the monitor's state to what is right.

        Coq: `lead`.
        """

        def with_monitor(outcome: Outcome, known: Answered, letters: Condition) -> bool:
            def judge(judged: int, known: Answered, letters: Condition) -> bool:
                return self.by_cases(self.depth, known, letters, partial(land, outcome, judged))

            edge = self.monitor.edges[pair.judged]
            return self.walk(self.look_of_monitor, (), self.depth, edge, known, letters, judge)

        if way is None:
            return with_monitor(Outcome(pair.state), {}, letters)
        return self.walk(self.look_of_control, late, self.depth, way, {}, letters, with_monitor)

    def look_of_control(self, way: Way) -> Outcome | _Decides:
        """Coq: `look_of_program`."""
        return self.control.outcomes[way] if way >= 0 else _Decides(*self.control.branches[~way])

    def look_of_monitor(self, target: Target) -> int | _Decides:
        """Coq: `look_of_monitor`."""
        if target >= 0:
            return target
        atom, low, high = self.monitor.decisions[~target]
        return _Decides(self.monitor.atoms[atom], high, low)

    def walk(
        self,
        look: Callable[[int], Result | _Decides],
        late: tuple[bool, ...],
        fuel: int,
        node: int,
        known: Answered,
        letters: Condition,
        judge: Callable[[Result, Answered, Condition], bool],
    ) -> bool:
        """Whether `judge` accepts every end to which `letters` lead that answer as is `known`. Coq: `walk`."""
        if letters == FALSE_CONDITION:
            return True
        if not self.memory.descend(fuel) or not self.memory.spend(self.conditions.node(letters).weight):
            return False
        seen = look(node)
        if not isinstance(seen, _Decides):
            return judge(seen, known, letters)
        on = partial(self.walk, look, late, fuel - 1, judge=judge)
        match seen.asked:
            case int(clock):
                is_late = clock < len(late) and late[clock]
                return on(node=seen.if_so if is_late else seen.if_not, known=known, letters=letters)
            case atom if atom in known:
                return on(node=seen.if_so if known[atom] else seen.if_not, known=known, letters=letters)
            case atom:
                return all(
                    on(node=node, known={**known, atom: value}, letters=self.assigned(atom, value, letters))
                    for value, node in ((True, seen.if_so), (False, seen.if_not))
                )

    def by_cases(
        self, fuel: int, known: Answered, letters: Condition, judge: Callable[[Answered, Condition], bool]
    ) -> bool:
        """Whether `judge` accepts `letters`, or its cases: that there are none may not be seen at once.

        Coq: `by_cases`.
        """
        if letters == FALSE_CONDITION:
            return True
        node = self.conditions.node(letters)
        atom = node.first_atom
        if fuel == 0 or atom is None or not self.memory.spend(node.weight):
            return judge(known, letters)
        return judge(known, letters) or all(
            self.by_cases(fuel - 1, {**known, atom: value}, self.assigned(atom, value, letters), judge)
            for value in (True, False)
        )

    def assigned(self, atom: str, value: bool, letters: Condition) -> Condition:
        return self.conditions.assign(self.conditions.fact_of_atom(atom), value, letters)


def _meets(outcome: Outcome, judged: int, pair: Pair) -> bool:
    """Coq: `meets`."""
    return (pair.state, pair.judged, pair.looks_again) == (outcome.state, judged, outcome.again)


def _may_be_late(occasion: _Occasion, row: _Row) -> tuple[bool, ...]:
    """Whether the clock can be past its due time. Coq: `may_be_late`."""
    if occasion is _Occasion.STEP or not row.counts:
        return (False,)
    return (True, False) if row.case.passed is None else (row.state.passed < row.case.passed,)


def _setting_of(clock: int, outcome: Outcome) -> Setting:
    """How `outcome` sets a clock. Coq: `setting_of`."""
    unchanged = Setting(clock, Base.DUE, 0)
    return next((setting for setting in outcome.settings if setting.clock == clock), unchanged)


def _is_off(row: _Row, setting: Setting) -> bool:
    """Whether the clock is then not due. Coq: `is_off`."""
    return setting.base is Base.NEVER or (setting.base is Base.DUE and not row.counts)


def _is_due_right(occasion: _Occasion, row: _Row, setting: Setting) -> bool:
    """Whether the clock is then due when its next bound passes, if it runs. Coq: `is_due_right`."""
    if not row.tracker.is_running(row.case.state):
        return _is_off(row, setting)
    next_bound = row.tracker.bounds[row.case.state.passed]
    is_held = row.state.phase is Phase.HELD
    match setting.base:
        case Base.NEVER:
            return False
        case Base.NOW:
            is_now = row.case.starts or (is_held and occasion is _Occasion.STEP)
            return is_now and setting.duration == next_bound
        case Base.JUST_BEFORE:
            is_before = not row.case.starts and is_held and occasion is _Occasion.WAIT
            return is_before and setting.duration == next_bound
        case Base.DUE:
            goes_on = row.counts and not row.case.starts and not is_held
            return goes_on and row.tracker.bounds[row.state.passed] + setting.duration == next_bound
