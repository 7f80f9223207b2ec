"""What runs is accepted exactly if it shows the verdicts of its monitor on every run of letters that exist."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path

import pytest
from control_mutants import control_mutants
from effort import share_of
from hypothesis import given, settings
from mutants import set_at
from strategies import alphabets, properties
from support import compiled
from timed import ARRIVAL, Draw
from timed import compiled as compiled_in_time

from ltlc.assurance.pairs import followed, pairs_of, uncovered
from ltlc.automata import Budget
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.conditions import Bound
from ltlc.semantics.control import Base, Control, Followed, Outcome, Pair, Setting, Stance
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.following import Following, follows_monitor
from ltlc.semantics.instants import Observation
from ltlc.semantics.ltl import FALSE, TRUE, And, Atom, Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import AfterUntil, Eventually, Never, Now, Property
from ltlc.semantics.timed_atoms import Once, Previously, news_of
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import IDLE, trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter

EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("**/*.txt"))
TIME = Path(__file__).parent / "fixtures" / "check" / "time.txt"
STOP_SIGN = compiled(AfterUntil(Atom("near"), Atom("far"), Eventually(Now(Atom("stopped")))))


def assumption_of(each: Compiled) -> Formula:
    """What its certificate supposes of every letter."""
    return each.specification.alphabet.restricted_to(each.monitor.atoms).as_formula()


def program_of(each: Compiled) -> Followed:
    program = followed(each, assumption_of(each))
    assert program is not None
    return program


def after(control: Control, state: int, letter: Letter) -> int:
    """Where a step leads, by the definition in `proofs/Program.v`; no clock runs."""
    way = control.stances[state].step
    while way < 0:
        branch = control.branches[~way]
        way = branch.if_so if branch.asked in letter else branch.if_not
    return control.outcomes[way].state


def show_the_same(control: Control, monitor: Monitor, letters: Iterable[Letter]) -> bool:
    """Whether both have the same verdict after every word over `letters`, one letter at a time."""
    letters = list(letters)
    if any(outcome.again for outcome in control.outcomes):
        return False  # where nothing is timed, no clock step comes
    todo = [(0, 0)]
    for state, judged in todo:
        if control.stances[state].verdict is not monitor.verdicts[judged]:
            return False
        reached = {(after(control, state, letter), monitor.step(judged, letter)) for letter in letters}
        todo += sorted(reached.difference(todo))
    return True


def following(each: Compiled, program: Followed) -> Following:
    return follows_monitor(each.formula, assumption_of(each), each.monitor, program)


def with_pairs(control: Control, each: Compiled) -> Followed:
    """A control that may be wrong, with the pairs that it has."""
    return Followed(control, pairs_of(control, each.formula, each.monitor, assumption_of(each)))


@settings(max_examples=60)
@given(properties(), alphabets())
def test_what_is_made_of_any_property_follows_its_monitor(property_: Property, alphabet: Alphabet) -> None:
    each = compiled(property_, alphabet=alphabet)
    assert following(each, program_of(each)) == Following(follows=True)


@pytest.mark.parametrize("path", [*EXAMPLES, TIME], ids=lambda path: path.stem)
def test_what_is_made_of_every_example_and_sentence_follows_its_monitor(path: Path) -> None:
    specification, _ = load(path, (), EPISODE)
    assert specification is not None
    for each in compile_specification(specification, EPISODE, Budget())[0]:
        if uncovered(each) is None:
            assert following(each, program_of(each)) == Following(follows=True), each.specification.label


@settings(max_examples=15)
@given(properties(depth=2), alphabets())
def test_a_mutant_is_accepted_exactly_if_no_word_tells_it_apart(property_: Property, alphabet: Alphabet) -> None:
    each = compiled(property_, alphabet=alphabet)
    letters = list(alphabet.restricted_to(each.monitor.atoms).letters())
    for mutant in control_mutants(program_of(each).control):
        accepted = following(each, with_pairs(mutant, each)).follows
        assert accepted == show_the_same(mutant, each.monitor, letters), mutant


def test_no_mutant_of_the_stop_sign_is_accepted() -> None:
    program = program_of(STOP_SIGN)
    mutants = list(control_mutants(program.control))
    assert len(mutants) > 30
    assert len(set(mutants)) == len(mutants)
    for mutant in mutants:
        assert not following(STOP_SIGN, with_pairs(mutant, STOP_SIGN)).follows, mutant


def test_pairs_that_leave_one_out_or_have_a_wrong_one_are_refused() -> None:
    program = program_of(STOP_SIGN)
    assert len(program.pairs) > 3
    for pair in program.pairs:
        rest = tuple(other for other in program.pairs if other != pair)
        assert not following(STOP_SIGN, replace(program, pairs=rest)).follows
    first, violated = 0, STOP_SIGN.monitor.verdicts.index(Verdict.VIOLATED)
    wrong = replace(program, pairs=(*program.pairs, Pair(first, violated)))
    assert not following(STOP_SIGN, wrong).follows


def test_a_program_with_a_clock_that_its_property_does_not_have_is_refused() -> None:
    program = program_of(STOP_SIGN)
    for first in (None, 5):
        control = replace(program.control, first_due=(first,))
        assert not following(STOP_SIGN, replace(program, control=control)).follows


def test_a_program_that_goes_round_in_circles_is_refused() -> None:
    program = program_of(STOP_SIGN)
    (first, *rest), (branch, *branches) = program.control.stances, program.control.branches
    circle = replace(
        program.control,
        stances=(first._replace(step=~0), *rest),
        branches=(branch._replace(if_so=~0, if_not=~0), *branches),
    )
    answer = following(STOP_SIGN, replace(program, control=circle))
    assert answer == Following(follows=False, met=Bound.DEPTH)


def test_the_bound_on_work_is_told_when_it_is_met() -> None:
    answer = follows_monitor(STOP_SIGN.formula, TRUE, STOP_SIGN.monitor, program_of(STOP_SIGN), work=3)
    assert answer == Following(follows=False, met=Bound.WORK)


class UntakenError(Exception):
    """A clock step comes, but the control takes none."""


class Clockwork:
    """What a control does in time, nanosecond by nanosecond: `runs` in `proofs/Program.v`."""

    def __init__(self, control: Control, began: Nanoseconds, news: Sequence[str]) -> None:
        self.control, self.news = control, frozenset(news)
        self.state, self.looks_again = 0, False
        self.due = [None if first is None else began + first for first in control.first_due]
        self.letter: Letter = frozenset()
        self.time: Nanoseconds | None = None

    @property
    def verdict(self) -> Verdict:
        return self.control.stances[self.state].verdict

    def step(self, time: Nanoseconds, letter: Letter) -> None:
        if self.time is not None:
            self.hold(time)
        self.time, self.letter = time, letter
        self.go(self.control.stances[self.state].step)

    def hold(self, until: Nanoseconds) -> None:
        assert self.time is not None
        while self.time < until:
            self.time += 1
            self.letter -= self.news
            if self.looks_again or any(map(self.is_late, range(len(self.due)))):
                way = self.control.stances[self.state].clock_step
                if way is None:
                    raise UntakenError
                self.go(way)

    def is_late(self, clock: int) -> bool:
        due = self.due[clock]
        assert self.time is not None
        return due is not None and due < self.time

    def go(self, way: int) -> None:
        while way < 0:
            asked, if_so, if_not = self.control.branches[~way]
            way = if_so if (self.is_late(asked) if isinstance(asked, int) else asked in self.letter) else if_not
        outcome = self.control.outcomes[way]
        settings_ = {setting.clock: setting for setting in reversed(outcome.settings)}
        self.due = [self.set(due, settings_[n]) if n in settings_ else due for n, due in enumerate(self.due)]
        self.state, self.looks_again = outcome.state, outcome.again

    def set(self, due: Nanoseconds | None, setting: Setting) -> Nanoseconds | None:
        assert self.time is not None
        match setting.base:
            case Base.NOW:
                return self.time + setting.duration
            case Base.JUST_BEFORE:
                return self.time - 1 + setting.duration
            case Base.DUE:
                return None if due is None else due + setting.duration
            case Base.NEVER:
                return None


def verdicts_of(each: Compiled, run: Observation) -> list[Verdict]:
    """What the monitor says before the first step of `run`, and after each."""
    timed, judged = TimedRun(trackers_of(each.formula), news_of(each.formula), run.session), 0
    found = [each.monitor.verdicts[judged]]
    for step in run.steps:
        for instant in timed.step(*step):
            judged = each.monitor.step(judged, instant)
        found.append(each.monitor.verdicts[judged])
    return found


def shown_by(control: Control, each: Compiled, run: Observation) -> list[Verdict] | None:
    """The same of `control`; None if a clock step comes that it does not take."""
    clockwork = Clockwork(control, run.session, [news.name for news in news_of(each.formula)])
    found = [clockwork.verdict]
    for step in run.steps:
        try:
            clockwork.step(*step)
        except UntakenError:
            return None
        found.append(clockwork.verdict)
    return found


def covered(draw: Draw, depth: int) -> Compiled:
    """A property with clocks of which it can be checked that what runs follows its monitor."""
    drawn = (compiled_in_time(draw.property(depth)) for _ in count())
    return next(each for each in drawn if uncovered(each) is None)


SEEDS = range(share_of(125))


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_made_of_properties_with_clocks_follows_and_shows_the_verdicts_of_its_monitor(seed: int) -> None:
    draw = Draw(seed)
    each = covered(draw, depth=1 + seed % 2)
    program = program_of(each)
    assert following(each, program) == Following(follows=True)
    for run in (draw.run() for _ in range(10)):
        assert shown_by(program.control, each, run) == verdicts_of(each, run)


def test_no_mutant_with_clocks_is_accepted_that_shows_another_verdict_in_some_run() -> None:
    """Most that are refused do show one; the others set a clock of which nothing comes."""
    refused = accepted = wrong = 0
    for seed in SEEDS[::10]:
        draw = Draw(seed)
        each = covered(draw, depth=1)
        runs = [(run, verdicts_of(each, run)) for run in (draw.run() for _ in range(40))]
        mutants = list(control_mutants(program_of(each).control))
        draw.chance.shuffle(mutants)
        for mutant in mutants[:40]:
            is_wrong = any(shown_by(mutant, each, run) != verdicts for run, verdicts in runs)
            is_accepted = following(each, with_pairs(mutant, each)).follows
            assert not (is_accepted and is_wrong), (seed, mutant)
            refused, accepted, wrong = refused + (not is_accepted), accepted + is_accepted, wrong + is_wrong
    assert wrong > 0.5 * refused > 40
    assert accepted < 0.4 * refused


RECENT = compiled_in_time(Never(Now(And(Once("lately", ARRIVAL, 3), Atom("x")))))
"""Both change by themselves: what is news, and whether there was some lately."""


def test_pairs_that_say_something_false_of_the_last_letter_or_the_clocks_are_refused() -> None:
    program = program_of(RECENT)
    for number, pair in enumerate(program.pairs):
        if not RECENT.monitor.verdicts[pair.judged].is_permanent:
            others = {other.stand for other in program.pairs if len(other.stand) == len(pair.stand)} - {pair.stand}
            false = [pair._replace(last_letter=FALSE), *(pair._replace(stand=other) for other in others)]
            assert len(false) > 1
            for changed in false:
                pairs = set_at(program.pairs, number, changed)
                assert not following(RECENT, replace(program, pairs=pairs)).follows


def test_a_program_that_never_looks_back_is_refused_with_pairs_in_which_nothing_has_been() -> None:
    each = compiled_in_time(Never(Now(And(Previously("before", Atom("x")), Atom("y")))))
    satisfied = Control((Stance(Verdict.PRESUMABLY_SATISFIED, 0, 0),), (), (Outcome(0),))
    assert not following(each, Followed(satisfied, (Pair(0, 0, (IDLE,)),))).follows


@pytest.mark.parametrize("each", [RECENT, compiled_in_time(Never(Now(And(ARRIVAL, Atom("x")))))])
def test_a_program_is_refused_exactly_if_a_clock_step_comes_that_it_does_not_take(each: Compiled) -> None:
    control, draw = program_of(each).control, Draw(1)
    runs = [draw.run() for _ in range(60)]
    for number, stance in enumerate(control.stances):
        if not stance.verdict.is_permanent:
            changed = replace(control, stances=set_at(control.stances, number, stance._replace(clock_step=None)))
            comes = any(shown_by(changed, each, run) is None for run in runs)
            assert following(each, with_pairs(changed, each)).follows != comes


def test_a_clock_that_counts_from_the_last_instant_held_has_to_be_due_in_time() -> None:
    control = program_of(RECENT).control
    held = [n for n, outcome in enumerate(control.outcomes) if Base.JUST_BEFORE in {s.base for s in outcome.settings}]
    assert held
    for number in held:
        (setting,) = control.outcomes[number].settings
        late = control.outcomes[number]._replace(settings=(setting._replace(duration=setting.duration + 1),))
        changed = replace(control, outcomes=set_at(control.outcomes, number, late))
        assert not following(RECENT, with_pairs(changed, RECENT)).follows


def test_a_clock_that_is_started_after_a_permanent_verdict_is_refused() -> None:
    control = program_of(RECENT).control
    over = next(n for n, stance in enumerate(control.stances) if stance.verdict.is_permanent)
    started = Outcome(over, (Setting(0, Base.NOW, 5),))
    stances = set_at(control.stances, over, control.stances[over]._replace(step=len(control.outcomes)))
    changed = replace(control, stances=stances, outcomes=(*control.outcomes, started))
    assert not following(RECENT, with_pairs(changed, RECENT)).follows
