"""Properties of time in questions of check: conflicts, consequences, and runs whose times are real."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import product

import pytest
from effort import share_of
from studies import study

from ltlc.analysis.explanation import explain
from ltlc.analysis.lassos import find_lasso
from ltlc.analysis.questions import excluded_deadline, idle_bound, inconsistent, redundant
from ltlc.analysis.search import all_shortest, shortest
from ltlc.automata import Budget, translate
from ltlc.automata.languages import Languages
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.instants import Instant, Step, instants, with_past
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import And, Atom, Formula, Not, conjunction
from ltlc.semantics.properties import (
    After,
    AfterUntil,
    Always,
    Eventually,
    Implies,
    Never,
    Now,
    Property,
    Until,
    Within,
)
from ltlc.semantics.properties import And as Both
from ltlc.semantics.timed_atoms import (
    Age,
    Historically,
    News,
    Once,
    Previously,
    Since,
    TimedAtom,
    atoms_within,
    news_of,
)
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Word, all_letters

SECOND = 10**9
A, B, C = Atom("a"), Atom("b"), Atom("c")
NEW_A = News("new a")
ALPHABET = Alphabet(("a", "b", "c"))
HELD = Historically("historically a for 2 ns", A, 2)
LENGTHS = (1, 2, 3, 5)


def response(trigger: Formula, goal: Formula, bound: int) -> Property:
    return Always(Implies(Now(trigger), Within(bound, Eventually(Now(goal)))))


def prevention(trigger: Formula, bad: Formula, bound: int) -> Property:
    return Always(Implies(Now(trigger), Within(bound, Never(Now(bad)))))


def fresh(bound: int) -> Property:
    return Always(Now(Age(f"age(a) <= {bound}", NEW_A, bound)))


def compatible(*properties: Property) -> bool:
    languages = Languages(ALPHABET)
    return languages.compatible([languages.of(encode(each, EPISODE)) for each in properties])


def implies(given: Property, then: Property) -> bool:
    languages = Languages(ALPHABET)
    return languages.implies([languages.of(encode(given, EPISODE))], languages.of(encode(then, EPISODE)))


def common_run(*properties: Property) -> Lasso | None:
    return find_lasso([encode(each, EPISODE) for each in properties], ALPHABET, LENGTHS)


@pytest.mark.parametrize(("deadline", "least", "together"), [(5, 15, False), (14, 15, False), (16, 15, True)])
def test_what_may_not_come_before_its_deadline_never_comes(deadline: int, least: int, together: bool) -> None:
    properties = response(A, B, deadline * SECOND), prevention(A, B, least * SECOND), Eventually(Now(A))
    assert compatible(*properties) is together
    assert (common_run(*properties) is not None) is together


@pytest.mark.parametrize(("most", "least", "together"), [(5, 15, False), (15, 5, True), (5, 5, True)])
def test_what_ends_in_time_does_not_last_longer(most: int, least: int, together: bool) -> None:
    lasts = Eventually(Now(Historically("a lasts", A, least * SECOND)))
    properties = response(A, Not(A), most * SECOND), lasts
    assert compatible(*properties) is together
    assert (common_run(*properties) is not None) is together


@pytest.mark.parametrize(
    ("stronger", "weaker"),
    [
        (response(A, B, 5), response(A, B, 15)),
        (response(A, B, 5), After(A, Within(5, Eventually(Now(B))))),
        (prevention(A, B, 15), prevention(A, B, 5)),
        (fresh(2), fresh(3)),
        (Within(5, Eventually(Now(A))), Within(6, Eventually(Now(A)))),
        (Eventually(Now(Historically("3", A, 3))), Eventually(Now(Historically("2", A, 2)))),
    ],
)
def test_the_tighter_bound_is_the_stronger(stronger: Property, weaker: Property) -> None:
    assert implies(stronger, weaker)
    assert not implies(weaker, stronger)


def predicate(chance: random.Random) -> Formula:
    operands: list[Formula] = [A, B, C, Not(A), And(A, Not(C)), NEW_A]
    operand = chance.choice(operands)
    bound = chance.choice([None, 1, 2, 3])
    name = f"past {chance.random()}"
    return chance.choice(
        [
            *(operand,) * 4,
            Previously(name, operand),
            Once(name, operand, bound),
            Historically(name, operand, bound),
            Since(name, Not(C), operand, bound),
            Age(name, NEW_A, bound or 4),
        ]
    )


def timed(chance: random.Random) -> Property:
    p, q, bound = predicate(chance), predicate(chance), chance.randint(1, 4)
    return chance.choice(
        [
            response(p, q, bound),
            prevention(p, q, bound),
            After(p, Within(bound, Eventually(Now(q)))),
            AfterUntil(p, q, Within(bound, Eventually(Now(B)))),
            Until(p, response(B, q, bound)),
            Both(Within(bound, Never(Now(p))), Within(bound + 1, Eventually(Now(p)))),
            Eventually(Now(p)),
        ]
    )


@pytest.mark.parametrize("seed", range(share_of(12)))
def test_automata_and_the_search_for_runs_agree(seed: int) -> None:
    chance = random.Random(seed)
    left, right = timed(chance), timed(chance)
    run = common_run(left, right)
    assert compatible(left, right) or run is None
    if implies(left, right):
        formulas = encode(left, EPISODE), Not(encode(right, EPISODE))
        assert find_lasso(formulas, ALPHABET, LENGTHS[:3]) is None
    if run is not None:
        assert all(isinstance(instant, Instant) for instant in run.stem + run.loop)
        assert holds_on_lasso(encode(left, EPISODE), run)


@pytest.mark.parametrize("seed", range(share_of(16)))
def test_a_question_that_some_runs_settle_is_answered_as_all_runs_would(seed: int) -> None:
    chance = random.Random(seed)
    left, right = (encode(timed(chance), EPISODE) for _ in range(2))
    asked, all_runs = Languages(ALPHABET), Languages(ALPHABET)
    one, other = asked.of(left), asked.of(right)

    def some(*formulas: Formula) -> bool:
        return all_runs.word([all_runs.of(formula) for formula in formulas]) is not None

    assert asked.compatible([one, other]) is some(left, right)
    assert asked.implies([one], other) is not some(left, Not(right))
    assert asked.equal(one, other) is not (some(left, Not(right)) or some(right, Not(left)))


def judged(property_: Property, word: Word, later: int) -> bool:
    """Whether the steps of `word` satisfy `property_` by the denotation, at each nanosecond, so much later."""
    past = [atom for atom in atoms_within(encode(property_, EPISODE)) if not isinstance(atom, News)]
    asked = [atom for atom in past if isinstance(atom, Previously | Once | Historically | Since | Age)]
    steps = [Step(i.time, i & {"a", "b", "c", "new a"}) for i in word if isinstance(i, Instant) and not i.by_time]
    last = word[-1]
    assert isinstance(last, Instant)
    return satisfies(with_past(instants(steps, last.time + later, [NEW_A]), asked), property_)


def _first_holds(holds: bool, verdicts: Sequence[Verdict]) -> bool:
    return verdicts[0].holds is holds


def short_runs(property_: Property, count: int) -> Iterator[tuple[Word, Verdict]]:
    """Runs that the search gives, and what the monitor says of them."""
    formula = encode(property_, EPISODE)
    monitor = translate(formula, ALPHABET)
    for holds in (True, False):
        found = all_shortest([(formula, monitor)], ALPHABET, partial(_first_holds, holds))
        yield from ((word, monitor.run(word)[-1]) for word, _ in zip(found, range(count), strict=False))


@pytest.mark.parametrize("seed", range(share_of(12)))
def test_a_run_that_is_found_means_what_the_monitor_says(seed: int) -> None:
    property_ = timed(random.Random(seed))
    for word, verdict in short_runs(property_, 20):
        last = word[-1]
        if not isinstance(last, Instant):  # nothing that was drawn depends on time
            assert satisfies(word, property_) is verdict.holds
        elif last.time < 100:  # without bounds, a while is a second
            # What is permanent may be so before it shows: what `previously` says a nanosecond later is certain.
            assert judged(property_, word, later=10 if verdict.is_permanent else 0) is verdict.holds


def earliest(property_: Property) -> dict[Verdict, int]:
    """After how many instants each verdict can come, by all runs of up to three steps with short times."""
    formula, monitor = encode(property_, EPISODE), translate(encode(property_, EPISODE), ALPHABET)
    found: dict[Verdict, int] = {}
    names = [*(atom.name for atom in atoms_within(formula) if not isinstance(atom, TimedAtom)), *news_names(formula)]
    for steps in (1, 2, 3):
        for letters, gaps in product(product(all_letters(names), repeat=steps), product(range(5), repeat=steps)):
            run, time = TimedRun(trackers_of(formula), news_of(formula), 0), 0
            word: list[Instant] = []
            for letter, gap in zip(letters, gaps, strict=True):
                word += run.step(time, letter)
                time += gap
            word += run.hold(time)
            for count, verdict in enumerate(monitor.run(word), 1):
                found[verdict] = min(count, found.get(verdict, count))
    return found


def news_names(formula: Formula) -> list[str]:
    return [news.name for news in news_of(formula)]


def _first_is(wanted: Verdict, verdicts: Sequence[Verdict]) -> bool:
    return verdicts[0] is wanted


@pytest.mark.parametrize("property_", [response(A, B, 3), prevention(A, Not(A), 2), fresh(3), Eventually(Now(HELD))])
def test_no_run_in_time_is_shorter_than_the_one_that_is_found(property_: Property) -> None:
    formula = encode(property_, EPISODE)
    monitor = translate(formula, ALPHABET)
    for verdict, count in earliest(property_).items():
        found = shortest([(formula, monitor)], ALPHABET, partial(_first_is, verdict))
        assert found is not None
        assert len(found) == count


def test_a_run_far_away_is_found() -> None:
    bounds = [SECOND * n for n in (3, 7, 11)]
    late = [Historically(f"historically a for {bound} ns", A, bound) for bound in bounds]
    property_ = Eventually(Now(conjunction([*late[:2], Not(late[2]), Once("once b within 20 s", B, 20 * SECOND)])))
    formula = encode(property_, EPISODE)
    found = shortest([(formula, translate(formula, ALPHABET))], ALPHABET, lambda said: said[0] is Verdict.SATISFIED)
    assert found is not None
    assert 7 * SECOND <= found[-1].time < 11 * SECOND  # type: ignore[attr-defined]


def codes(findings: Iterator[object]) -> list[str]:
    return [finding.code for finding in findings]  # type: ignore[attr-defined]


def test_a_conflict_that_only_durations_show_is_told() -> None:
    asked = study(ALPHABET, response(A, B, 5), prevention(A, B, 15), Eventually(Now(A)))
    assert codes(inconsistent.ask(asked, asked.subjects)) == ["LTL601"]
    assert codes(excluded_deadline.ask(asked, asked.subjects[1])) == []


def test_without_the_trigger_it_is_told_of_the_trigger_and_once() -> None:
    asked = study(ALPHABET, response(A, B, 5), prevention(A, B, 15))
    assert codes(inconsistent.ask(asked, asked.subjects)) == []
    assert [codes(excluded_deadline.ask(asked, subject)) for subject in asked.subjects] == [[], ["LTL606"]]


def test_ages_of_one_topic_are_neighbours() -> None:
    asked = study(ALPHABET, fresh(2), fresh(3))
    assert codes(redundant.ask(asked, asked.subjects[1])) == ["LTL602"]


@pytest.mark.parametrize(("inner", "outer", "idle"), [(5, 2, ["LTL507"]), (2, 5, ["LTL507"]), (5, 5, ["LTL507"])])
def test_one_of_two_bounds_on_the_same_beginning_is_idle(inner: int, outer: int, idle: list[str]) -> None:
    asked = study(ALPHABET, After(A, Within(outer, Within(inner, Eventually(Now(B))))))
    assert codes(idle_bound.ask(asked, asked.subjects[0]))[:1] == idle


def test_bounds_that_matter_are_not_idle() -> None:
    for property_ in (response(A, B, 5), prevention(A, B, 5), After(A, Within(5, Eventually(Now(Once("o", B, 2)))))):
        asked = study(ALPHABET, property_)
        assert codes(idle_bound.ask(asked, asked.subjects[0])) == []


def test_an_example_has_times_and_rows_at_which_only_time_has_passed() -> None:
    (explained,) = explain(study(ALPHABET, response(A, B, 5 * SECOND)), Budget(30, 1024))
    violated = explained.examples[0].as_json()
    assert [(step["time_ns"], step["by_time"]) for step in violated["steps"]] == [(0, False), (5 * SECOND + 1, True)]
    assert [step["remark"] for step in violated["steps"]] == ["presumably violated", "violated"]
