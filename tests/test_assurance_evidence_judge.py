"""The judge accepts the verdict that a recorded run has, with its time, and no other; as the one from Coq does."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import pytest
from judged_cases import SOME, TABLE, answer, cases, claim, drawn, drawn_counts, names_of
from test_semantics_certificate_text import entry
from timed import MARK, NEWS, SIGNALS, Draw, holds, letters_of, ordinary_atoms

from ltlc.assurance.evidence.claims import LATEST, refusal
from ltlc.assurance.evidence.conditions import asks_between_steps
from ltlc.assurance.evidence.document import Claim, Line, StatedAtom, Summed
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.certificate_text import Entry
from ltlc.semantics.encodings import DWYER, EPISODE, encode
from ltlc.semantics.instants import Instant, Observation, Step
from ltlc.semantics.ltl import And, Atom, Formula, Not
from ltlc.semantics.properties import AfterUntil, Always, Eventually, Implies, Never, Now, Property, Within, predicates
from ltlc.semantics.properties import Not as NotProperty
from ltlc.semantics.timed_atoms import (
    Historically,
    News,
    Occurred,
    Once,
    Previously,
    Since,
    atoms_within,
    names_within,
)
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter

START = 10**18


def test_the_judge_says_of_random_claims_what_the_one_from_coq_says() -> None:
    _, *table = TABLE.read_text(encoding="utf-8").splitlines()
    assert [*map(answer, cases())] == table
    kinds = Counter(
        "as claimed" in line or line.partition("REFUSED: ")[2].split(",")[0].split(" from ")[0] for line in table
    )
    assert all(kinds[f"the verdict is {verdict.value}"] > 30 for verdict in SOME)
    assert kinds[True] > 50


def lines_of(of: Entry, run: Observation, counts: Sequence[Occurred]) -> list[Line]:
    """The lines of a run that starts at `START`, as they are to be written."""
    names, news = names_of(of, counts), {each.name for each in NEWS}
    lines: list[Line] = []
    held: Letter = frozenset()
    for time, atoms in run.steps:
        letter = atoms & frozenset(names)
        if not lines or letter != held or START + time == lines[-1].time:
            lines.append(Line(START + time, tuple(n for n, name in enumerate(names) if name in letter)))
            held = letter - news
    return lines


def true_claim(of: Entry, run: Observation, counts: Sequence[Occurred] = ()) -> Claim:
    """What is right of a run: by the reference for runs in time, and the certified monitor."""
    letters = letters_of(of.certificate.formula, run, counts)
    times = [each.time for each in letters if isinstance(each, Instant)]
    verdicts = of.certificate.monitor.run(letters)
    final = next(n for n, _ in enumerate(verdicts) if {*verdicts[n:]} == {verdicts[-1]})
    until = times[final] if verdicts[-1].is_permanent else run.until
    lines = [line for line in lines_of(of, run, counts) if line.time <= START + until]
    return claim(of, START + run.session, lines, START + until, verdicts[-1], counts)


def refused(stated: Claim, of: Entry) -> str | None:
    assert not isinstance(stated.letters, Summed)
    return refusal(stated, stated.letters, of)


def is_not_covered(of: Entry, counts: Sequence[Occurred] = ()) -> bool:
    """Whether `previously` is asked of what changes between two steps, as a count does: nothing is claimed of that."""
    asked = [atom for part in predicates(of.subject) for atom in atoms_within(part) if isinstance(atom, Previously)]
    counted = {count.name for count in counts}
    return asks_between_steps(of.subject) or any(not counted.isdisjoint(names_within(each.operand)) for each in asked)


def runs(seeds: range, each: int) -> list[tuple[Entry, Observation]]:
    found = []
    for seed in (seed for seed in seeds if (3 * seed + 1) % 5 != 4):  # which are of instances
        of, draw = drawn(3 * seed + 1), Draw(seed)
        found += [(of, draw.run()) for _ in range(each)]
    return found


@pytest.mark.parametrize("is_counted", [False, True])
def test_the_verdict_of_a_run_is_accepted_with_its_time_and_no_other(is_counted: bool) -> None:
    verdicts: Counter[Verdict] = Counter()
    chance = random.Random(7)
    for of, run in runs(range(60), 6):
        counts = drawn_counts(of, chance) if is_counted else ()
        if is_counted and not counts:
            continue
        stated = true_claim(of, run, counts)
        why = refused(stated, of)
        if why is not None and is_not_covered(of, counts):
            assert "depends on steps that have no line" in why
            continue
        assert why is None, (of.subject, run, counts)
        assert stated.verdict.is_permanent or stated.verdict.holds == holds(of.subject, run, counts)
        verdicts[stated.verdict] += 1
        for other in SOME:
            assert (refused(replace(stated, verdict=other), of) is None) == (other is stated.verdict)
        early = replace(stated, until=stated.until - 1, decided=stated.decided - 1)
        assert not stated.verdict.is_permanent or refused(early, of) is not None
    assert min(verdicts[verdict] for verdict in SOME) > (5 if is_counted else 20)


def instances_of(run: Observation) -> list[Observation]:
    """The runs in which only one of the messages that open instances is one."""
    found = []
    for number, step in enumerate(run.steps):
        if MARK.name in step.letter:
            steps = (
                other if n == number else Step(other.time, other.letter - {MARK.name})
                for n, other in enumerate(run.steps)
            )
            found.append(run._replace(steps=tuple(steps)))
    return found


def test_the_verdict_of_a_run_is_that_of_its_worst_instance_and_no_other() -> None:
    verdicts: Counter[Verdict] = Counter()
    for seed in (seed for seed in range(4, 250, 5) if seed % 3):  # with all letters
        of, draw = drawn(seed), Draw(seed)
        for _ in range(15):
            run = draw.run((*SIGNALS, MARK.name))
            instances = instances_of(run)
            claims = [true_claim(of, each) for each in instances]
            violated = [each.until for each in claims if each.verdict is Verdict.VIOLATED]
            is_owed = any(each.verdict is Verdict.PRESUMABLY_VIOLATED for each in claims)
            verdict = Verdict.PRESUMABLY_VIOLATED if is_owed else Verdict.PRESUMABLY_SATISFIED
            verdict, until = (Verdict.VIOLATED, min(violated)) if violated else (verdict, START + run.until)
            lines = [line for line in lines_of(of, run, ()) if line.time <= until]
            stated = claim(of, START + run.session, lines, until, verdict)
            why = refused(stated, of)
            if why is not None and is_not_covered(of):
                assert "depends on steps that have no line" in why
                continue
            assert why is None, (of.subject, run)
            is_well = all(holds(of.subject, each) for each in instances)
            is_satisfied = any(each.verdict is Verdict.SATISFIED for each in claims)
            assert violated or is_satisfied or is_well == (verdict is Verdict.PRESUMABLY_SATISFIED)
            verdicts[verdict] += 1
            assert all((refused(replace(stated, verdict=other), of) is None) == (other is verdict) for other in SOME)
            assert "not of instances" in (refused(replace(stated, opens=int(stated.opens == 0)), of) or "")
    assert min(verdicts[verdict] for verdict in SOME if verdict is not Verdict.SATISFIED) > 10


def test_what_is_accepted_of_changed_letters_is_the_verdict_of_these() -> None:
    chance, accepted, said = random.Random(5), 0, 0
    for of, run in runs(range(60, 100), 4):
        stated = true_claim(of, run)
        assert not isinstance(stated.letters, Summed)
        lines = [*stated.letters]
        place, names = chance.randrange(len(lines)), names_of(of)
        held = {*lines[place].atoms} ^ {chance.randrange(len(names))} if names else set()
        time = lines[place].time + chance.choice((0, 0, -1, 1))
        lines[place] = Line(time, tuple(sorted(held)))
        changed = replace(stated, letters=tuple(lines))
        said += 1
        if refused(changed, of) is None:
            accepted += 1
            steps = tuple(Step(t - START, frozenset(names[n] for n in atoms)) for t, atoms in lines)
            other = Observation(steps, changed.until - START, run.session)
            assert other.until >= steps[-1].time
            found = true_claim(of, other)
            assert (found.verdict, found.until) == (stated.verdict, stated.until)
    assert 10 < accepted < said


NEAR, STOPPED, RAIN = Atom("near"), Atom("stopped"), News("new rain")
RESPONSE = entry("response", Always(Implies(Now(NEAR), Within(2_000_000_000, Eventually(Now(STOPPED))))))
SECOND = 1_000_000_000


def response(until: int, verdict: Verdict, *lines: tuple[int, tuple[int, ...]]) -> Claim:
    atoms = (StatedAtom("near", {}), StatedAtom("stopped", {}))
    return Claim("response", "", atoms, 0, tuple(Line(t, held) for t, held in lines), until, verdict, until)


def test_a_bound_passes_at_the_first_nanosecond_after_it_though_there_is_no_line() -> None:
    late = 3 * SECOND + 1
    assert refused(response(late, Verdict.VIOLATED, (SECOND, (0,))), RESPONSE) is None
    assert refused(response(late - 1, Verdict.PRESUMABLY_VIOLATED, (SECOND, (0,))), RESPONSE) is None
    assert refused(response(late - 1, Verdict.VIOLATED, (SECOND, (0,))), RESPONSE) == (
        f"the verdict is presumably_violated from {late - 1} on, not violated from {late - 1} on"
    )
    assert refused(response(late, Verdict.PRESUMABLY_SATISFIED, (SECOND, (0,)), (late - 1, (1,))), RESPONSE) is None


def timed_entry(property_: Property) -> Entry:
    return entry("p", property_, alphabet=Alphabet(ordinary_atoms(encode(property_, EPISODE))))


@pytest.mark.parametrize(
    ("goal", "lines"),
    [
        (Historically("stopped for 3 ns", STOPPED, 3), ((5, (0,)),)),
        (Not(Once("stopped within 2 ns", STOPPED, 2)), ((5, (0,)), (6, ()))),
        (Not(Since("near since stopped within 2 ns", NEAR, STOPPED, 2)), ((5, (0, 1)), (6, (0,)))),
    ],
)
def test_a_bound_may_pass_in_the_nanosecond_in_which_its_goal_is_reached(
    goal: Formula, lines: tuple[tuple[int, tuple[int, ...]], ...]
) -> None:
    of = timed_entry(Always(Within(2, Eventually(Now(goal)))))
    atoms = tuple(StatedAtom(name, {}) for name in names_of(of))
    stated = Claim("p", "", atoms, 0, tuple(Line(*each) for each in lines), 8, Verdict.VIOLATED, 8)
    assert refused(stated, of) is None
    early = replace(stated, verdict=Verdict.PRESUMABLY_VIOLATED, until=7, decided=7)
    assert refused(early, of) is None
    assert refused(replace(stated, verdict=Verdict.PRESUMABLY_SATISFIED), of) is not None


def test_many_steps_that_change_nothing_are_one_line() -> None:
    atoms = (StatedAtom("d < 1", {}), StatedAtom("d > 3", {}), StatedAtom("speed == 0", {}))
    of = entry("p", AfterUntil(Atom("d < 1"), Atom("d > 3"), Eventually(Now(Atom("speed == 0")))))
    lines = (Line(5, (0,)), Line(10**9, (1,)))
    assert refused(Claim("p", "", atoms, 5, lines, 10**9, Verdict.VIOLATED, 10**9), of) is None


@pytest.mark.parametrize(
    ("stated", "why"),
    [
        (response(5, Verdict.VIOLATED), "it has no letters"),
        (response(5, Verdict.NOT_STARTED, (5, ())), "it has letters, so it has started"),
        (response(5, Verdict.PRESUMABLY_SATISFIED, (6, ())), "times go back"),
        (response(9, Verdict.PRESUMABLY_SATISFIED, (6, ()), (5, ())), "times go back"),
        (response(LATEST + 1, Verdict.PRESUMABLY_SATISFIED, (6, ())), "times after the year 2084 are not judged"),
        (replace(response(9, Verdict.PRESUMABLY_SATISFIED, (6, ())), decided=8), "was not looked at up to the time"),
        (replace(response(9, Verdict.PRESUMABLY_SATISFIED, (6, ())), atoms=()), "'near' is missing"),
        (
            replace(response(9, Verdict.PRESUMABLY_SATISFIED, (6, ())), atoms=(StatedAtom("near", {}),) * 2),
            "'near' is there twice",
        ),
    ],
)
def test_a_claim_that_is_not_as_it_has_to_be_is_refused(stated: Claim, why: str) -> None:
    assert why in (refused(stated, RESPONSE) or "")


def test_an_atom_that_follows_from_the_others_cannot_be_stated() -> None:
    atoms = tuple(StatedAtom(name, {}) for name in RESPONSE.certificate.monitor.atoms)
    stated = replace(response(9, Verdict.PRESUMABLY_SATISFIED, (6, ())), atoms=atoms)
    assert "follows from the other atoms" in (refused(stated, RESPONSE) or "")


def test_letters_that_the_certificate_excludes_are_refused() -> None:
    of = entry("p", Never(Now(NEAR)))
    of = replace(of, certificate=replace(of.certificate, assumption=Not(And(NEAR, STOPPED))))
    stated = replace(response(9, Verdict.VIOLATED, (9, (0, 1))), label="p")
    assert refused(stated, of) == "the certificate assumes that there is no such letter"


def test_another_encoding_is_not_judged() -> None:
    of = entry("p", AfterUntil(NEAR, STOPPED, Eventually(Now(STOPPED))), DWYER)
    assert refused(response(5, Verdict.PRESUMABLY_SATISFIED, (5, ())), of) == "its encoding is not that of the language"


def test_what_depends_on_steps_without_a_line_is_refused() -> None:
    rained = Now(Previously("previously new rain", RAIN))
    of = timed_entry(Always(Implies(NotProperty(rained), Eventually(rained))))
    stated = Claim("p", "", (StatedAtom("new rain", {}),), 0, (Line(5, (0,)),), 6, Verdict.PRESUMABLY_SATISFIED, 6)
    assert refused(stated, of) == "what 'previously' asks depends on steps that have no line"
