"""The judge accepts the verdict that a recorded run has, with its time, and no other; as the one from Coq does."""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import replace

import pytest
from judged_cases import SOME, TABLE, answer, atoms_of, cases, claim, drawn
from test_semantics_certificate_text import entry
from timed import NEWS, Draw, holds, letters_of

from ltlc.assurance.evidence.document import Claim, Line, StatedAtom, Summed
from ltlc.assurance.evidence.judge import LATEST, refusal
from ltlc.semantics.certificate_text import Entry
from ltlc.semantics.encodings import DWYER
from ltlc.semantics.instants import Instant, Observation, Step
from ltlc.semantics.ltl import And, Atom, Not
from ltlc.semantics.properties import AfterUntil, Always, Eventually, Implies, Never, Now, Within
from ltlc.semantics.timed_atoms import News, Previously
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


def lines_of(of: Entry, run: Observation) -> list[Line]:
    """The lines of a run that starts at `START`, as they are to be written."""
    names, news = atoms_of(of), {each.name for each in NEWS}
    lines: list[Line] = []
    held: Letter = frozenset()
    for time, atoms in run.steps:
        letter = atoms & frozenset(names)
        if not lines or letter != held or START + time == lines[-1].time:
            lines.append(Line(START + time, tuple(n for n, name in enumerate(names) if name in letter)))
            held = letter - news
    return lines


def true_claim(of: Entry, run: Observation) -> Claim:
    """What is right of a run: by the reference for runs in time, and the certified monitor."""
    letters = letters_of(of.certificate.formula, run)
    times = [each.time for each in letters if isinstance(each, Instant)]
    verdicts = of.certificate.monitor.run(letters)
    final = next(n for n, _ in enumerate(verdicts) if {*verdicts[n:]} == {verdicts[-1]})
    until = times[final] if verdicts[-1].is_permanent else run.until
    lines = [line for line in lines_of(of, run) if line.time <= START + until]
    return claim(of, START + run.session, lines, START + until, verdicts[-1])


def refused(stated: Claim, of: Entry) -> str | None:
    assert not isinstance(stated.letters, Summed)
    return refusal(stated, stated.letters, of)


def runs(seeds: range, each: int) -> list[tuple[Entry, Observation]]:
    found = []
    for seed in seeds:
        of, draw = drawn(3 * seed + 1), Draw(seed)
        found += [(of, draw.run()) for _ in range(each)]
    return found


def test_the_verdict_of_a_run_is_accepted_with_its_time_and_no_other() -> None:
    verdicts: Counter[Verdict] = Counter()
    for of, run in runs(range(60), 6):
        stated = true_claim(of, run)
        why = refused(stated, of)
        if why is not None and "previously" in why:
            continue
        assert why is None, (of.subject, run)
        assert stated.verdict.is_permanent or stated.verdict.holds == holds(of.subject, run)
        verdicts[stated.verdict] += 1
        for other in SOME:
            assert (refused(replace(stated, verdict=other), of) is None) == (other is stated.verdict)
        early = replace(stated, until=stated.until - 1, decided=stated.decided - 1)
        assert not stated.verdict.is_permanent or refused(early, of) is not None
    assert min(verdicts[verdict] for verdict in SOME) > 20


def test_what_is_accepted_of_changed_letters_is_the_verdict_of_these() -> None:
    chance, accepted, said = random.Random(5), 0, 0
    for of, run in runs(range(60, 100), 4):
        stated = true_claim(of, run)
        assert not isinstance(stated.letters, Summed)
        lines = [*stated.letters]
        place, names = chance.randrange(len(lines)), atoms_of(of)
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
    of = entry("p", Never(Now(Previously("previously new rain", RAIN))))
    stated = Claim("p", "", (StatedAtom("new rain", {}),), 0, (Line(5, (0,)),), 9, Verdict.VIOLATED, 9)
    assert refused(stated, of) == "what 'previously' asks depends on steps that have no line"
