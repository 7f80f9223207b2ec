"""What runs is accepted exactly if it shows the verdicts of its monitor on every run of letters that exist."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import pytest
from control_mutants import control_mutants
from hypothesis import given, settings
from strategies import alphabets, properties
from support import compiled

from ltlc.assurance.pairs import followed, pairs_of
from ltlc.automata import Budget
from ltlc.compiler import Compiled, compile_specification
from ltlc.language import load
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.conditions import Bound
from ltlc.semantics.control import Base, Control, Followed, Pair, Setting
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.following import Following, follows_monitor
from ltlc.semantics.ltl import TRUE, Atom, Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import AfterUntil, Eventually, Now, Property
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter

EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("**/*.txt"))
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
    todo = [(0, 0)]
    for state, judged in todo:
        if control.stances[state].verdict is not monitor.verdicts[judged]:
            return False
        reached = {(after(control, state, letter), monitor.step(judged, letter)) for letter in letters}
        todo += sorted(reached.difference(todo))
    return True


@settings(max_examples=60)
@given(properties(), alphabets())
def test_what_is_made_of_any_property_follows_its_monitor(property_: Property, alphabet: Alphabet) -> None:
    each = compiled(property_, alphabet=alphabet)
    assert follows_monitor(assumption_of(each), each.monitor, program_of(each)) == Following(follows=True)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_what_is_made_of_every_example_without_clocks_follows_its_monitor(path: Path) -> None:
    specification, _ = load(path, (), EPISODE)
    assert specification is not None
    for each in compile_specification(specification, EPISODE, Budget())[0]:
        program = followed(each, assumption_of(each))
        assert (program is None) == bool(timed_atoms(each.formula))
        assert program is None or follows_monitor(assumption_of(each), each.monitor, program).follows


@settings(max_examples=15)
@given(properties(depth=2), alphabets())
def test_a_mutant_is_accepted_exactly_if_no_word_tells_it_apart(property_: Property, alphabet: Alphabet) -> None:
    each = compiled(property_, alphabet=alphabet)
    assumption, letters = assumption_of(each), list(alphabet.restricted_to(each.monitor.atoms).letters())
    for mutant in control_mutants(program_of(each).control):
        program = Followed(mutant, pairs_of(mutant, each.monitor, assumption))
        accepted = follows_monitor(assumption, each.monitor, program).follows
        assert accepted == show_the_same(mutant, each.monitor, letters), mutant


def test_no_mutant_of_the_stop_sign_is_accepted() -> None:
    program = program_of(STOP_SIGN)
    mutants = list(control_mutants(program.control))
    assert len(mutants) > 30
    assert len(set(mutants)) == len(mutants)
    for mutant in mutants:
        changed = Followed(mutant, pairs_of(mutant, STOP_SIGN.monitor, TRUE))
        assert not follows_monitor(TRUE, STOP_SIGN.monitor, changed).follows, mutant


def test_pairs_that_leave_one_out_or_have_a_wrong_one_are_refused() -> None:
    program = program_of(STOP_SIGN)
    assert len(program.pairs) > 3
    for pair in program.pairs:
        rest = tuple(other for other in program.pairs if other != pair)
        assert not follows_monitor(TRUE, STOP_SIGN.monitor, replace(program, pairs=rest)).follows
    first, violated = 0, STOP_SIGN.monitor.verdicts.index(Verdict.VIOLATED)
    wrong = replace(program, pairs=(*program.pairs, Pair(first, violated)))
    assert not follows_monitor(TRUE, STOP_SIGN.monitor, wrong).follows


def test_a_program_that_sets_a_clock_or_looks_again_is_refused() -> None:
    program = program_of(STOP_SIGN)
    control = program.control
    first, *rest = control.outcomes
    for changed in (
        replace(control, outcomes=(first._replace(settings=(Setting(0, Base.NOW, 5),)), *rest)),
        replace(control, outcomes=(first._replace(again=True), *rest)),
        replace(control, first_due=(5,)),
    ):
        assert not follows_monitor(TRUE, STOP_SIGN.monitor, replace(program, control=changed)).follows


def test_a_program_that_goes_round_in_circles_is_refused() -> None:
    program = program_of(STOP_SIGN)
    (first, *rest), (branch, *branches) = program.control.stances, program.control.branches
    circle = replace(
        program.control,
        stances=(first._replace(step=~0), *rest),
        branches=(branch._replace(if_so=~0, if_not=~0), *branches),
    )
    answer = follows_monitor(TRUE, STOP_SIGN.monitor, replace(program, control=circle))
    assert answer == Following(follows=False, met=Bound.DEPTH)


def test_the_bound_on_work_is_told_when_it_is_met() -> None:
    answer = follows_monitor(TRUE, STOP_SIGN.monitor, program_of(STOP_SIGN), work=3)
    assert answer == Following(follows=False, met=Bound.WORK)
