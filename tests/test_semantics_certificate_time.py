"""Certificates of properties with clocks: found, written, read, checked; and refused where they are not about time."""

from __future__ import annotations

from dataclasses import replace

import pytest
from mutants import monitor_mutants
from timed import ARRIVAL, Draw, X, Y, Z, clocks, letters_of, monitor_of, ordinary_atoms

from ltlc.assurance.certificates import Subject, Unreadable, check_certificates
from ltlc.assurance.certify import NotCertified, certify
from ltlc.automata import Budget, Task, translate, translate_all
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.certificate import Answer, Certificate, Place, check
from ltlc.semantics.certificate_draft import bound_of
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.certificate_text import Entry, to_text
from ltlc.semantics.conditions import Bound
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.intervals import without_intervals
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Property
from ltlc.semantics.reset_machine import ResetMachine
from ltlc.semantics.timed_atoms import Age, Once
from ltlc.semantics.trackers import trackers_of
from ltlc.semantics.verdicts import Verdict

EXACT = Answer(certified=True, exact=True)


def response(within: int, answer: ltl.Formula = Y) -> Property:
    return p.Always(answered(within, answer))


def answered(within: int, answer: ltl.Formula = Y) -> Property:
    return p.Implies(p.Now(X), p.Within(within, p.Eventually(p.Now(answer))))


def certified(property_: Property, monitor: Monitor | None = None) -> Certificate | NotCertified:
    formula = encode(property_, EPISODE)
    return certify(formula, Alphabet(ordinary_atoms(formula)), monitor or monitor_of(property_))


def entry(property_: Property) -> Entry:
    found = certified(property_)
    assert isinstance(found, Certificate), found
    return Entry("line 1", 1, without_intervals(property_), "episode", found)


RECENT = Once("once y within 2 s", Y, 2 * 10**9)
EXAMPLES = {
    "response": response(10**8),
    "prevention": p.Always(p.Implies(p.Now(X), p.Within(5, p.Never(p.Now(Y))))),
    "recently": p.Always(p.Now(ltl.implies(X, RECENT))),
    "watchdog": p.Always(p.Now(Age("age(n) <= 200 ms", ARRIVAL, 2 * 10**8))),
    "a clock that a message starts": p.Always(p.Implies(p.Now(ARRIVAL), p.Within(5, p.Eventually(p.Now(X))))),
    "two bounds on one clock": p.After(X, p.And(p.Within(1, p.Never(p.Now(Y))), p.Within(9, p.Eventually(p.Now(Y))))),
    "one response in two scopes": p.And(response(2), p.After(Z, response(2))),
}


@pytest.mark.parametrize("property_", EXAMPLES.values(), ids=EXAMPLES)
def test_a_property_with_clocks_is_certified_exactly_and_its_certificate_read_back(property_: Property) -> None:
    written = entry(property_)
    (read,) = parse(to_text([written]))
    assert (read.subject, read.certificate.formula) == (property_, written.certificate.formula)
    assert check(written.certificate) == check(read.certificate) == EXACT


def test_random_properties_with_clocks_are_certified_and_those_with_one_exactly() -> None:
    exact = 0
    for seed in range(60):
        property_ = Draw(seed).property(depth=1)
        (read,) = parse(to_text([entry(property_)]))
        answer = check(read.certificate)
        assert answer.certified, property_
        assert answer.exact or not ResetMachine(read.certificate.formula).words_are_runs, property_
        exact += answer.exact
    assert exact > 50


def test_no_monitor_with_another_verdict_in_time_is_certified() -> None:
    """Of the changes that some run shows."""
    for property_ in (EXAMPLES["response"], EXAMPLES["recently"], EXAMPLES["watchdog"]):
        right, formula = entry(property_).certificate, encode(property_, EPISODE)
        runs = [letters_of(formula, Draw(seed).run()) for seed in range(100)]
        caught = 0
        for mutant in monitor_mutants(right.monitor):
            if any(mutant.run(run) != right.monitor.run(run) for run in runs):
                made = certified(property_, mutant)
                assert check(replace(right, monitor=mutant)) != EXACT
                assert isinstance(made, NotCertified) or check(made) != EXACT
                caught += 1
        assert caught


def test_certificates_with_long_names_and_many_bounds_are_read_back() -> None:
    for seed in (98, 115, 124, 148, 278):
        property_ = Draw(seed).property(depth=2 if seed > 150 else 1)
        (read,) = parse(to_text([entry(property_)]))
        assert read.subject == property_


def bound(property_: Property) -> int:
    own = [ltl.size(predicate) for predicate in events(property_)]
    return bound_of(property_, own, [bound(body) for body in p.children(property_)])


def events(property_: Property) -> list[ltl.Formula]:
    """The state predicates of a keyword itself."""
    below = [predicate for body in p.children(property_) for predicate in p.predicates(body)]
    return list(p.predicates(property_))[: len(list(p.predicates(property_))) - len(below)]


def test_the_bound_on_an_encoding_is_one() -> None:
    for seed in range(300):
        property_ = Draw(seed).property(depth=3)
        assert ltl.size(encode(property_, EPISODE)) <= bound(property_)
    triggers = p.Implies(p.Now(X), p.Implies(p.Now(Y), p.And(answered(1), p.Now(Z))))
    assert ltl.size(encode(p.Always(triggers), EPISODE)) <= bound(p.Always(triggers))


def test_nothing_is_assumed_of_what_time_decides() -> None:
    """A certificate would speak of runs of which there may be none."""
    assert not check(replace(entry(EXAMPLES["recently"]).certificate, assumption=RECENT)).certified
    assert not check(replace(entry(EXAMPLES["watchdog"]).certificate, assumption=ARRIVAL)).certified


TEXT = to_text([entry(EXAMPLES["recently"])])


def objection(property_: Property, text: str) -> str | None:
    alphabet = Alphabet(ordinary_atoms(encode(property_, EPISODE)))
    checked = check_certificates([Subject("line 1", 1, property_, alphabet, "episode")], text)
    assert not isinstance(checked, Unreadable), checked
    return checked[0].objection


def test_a_certificate_reads_as_its_definitions_and_states() -> None:
    lines = TEXT.splitlines()
    assert "a2 once y within 2 s" in lines
    assert "t0 a2 once f0 2000000000" in lines
    assert "k3 unread idle" in lines
    assert any(line.startswith("q0 presumably_satisfied d0 remains k0.f") for line in lines)


def test_a_certificate_of_the_property_passes() -> None:
    assert objection(EXAMPLES["recently"], TEXT) is None


@pytest.mark.parametrize("other", [replace(RECENT, within=1), replace(RECENT, operand=X), replace(RECENT, within=None)])
def test_a_timed_atom_that_is_defined_in_another_way_does_not_pass(other: Once) -> None:
    assert objection(p.Always(p.Now(ltl.implies(X, other))), TEXT) == (
        "the certificate defines its timed atoms in another way"
    )


def test_another_bound_is_another_property() -> None:
    assert objection(response(3), to_text([entry(response(2))])) == "the certificate is for another property"


def changed(old: str, new: str) -> str:
    assert old in TEXT
    return TEXT.replace(old, new, 1)


WRONG = {
    "no such kind": (changed("a2 once f0", "a2 twice f0"), "a definition has an atom"),
    "no duration": (changed("2000000000", "2 s"), "is not a duration"),
    "a duration of 0": (changed("f0 2000000000", "f0 0"), "too small"),
    "a huge duration": (changed("2000000000", "9" * 5000), "is not a duration"),
    "defined after its use": (changed("t0 a2", "f1 a2\nt0 a2"), "used already"),
    "no state of these clocks": (changed("unread idle", "unread idle idle"), "no state of the clocks"),
    "more bounds passed than there are": (changed("unread idle", "unread running 2"), "no state of the clocks"),
    "nothing a clock can do": (changed("unread idle", "unread asleep"), "not what a clock can do"),
    "neither read nor unread": (changed("unread idle", "idle"), "'read' or 'unread'"),
    "no clocks": (TEXT.replace("k0.", ""), "not said where the clocks are"),
    "a clock that decides a part of the property": (
        changed("p1 always", "p1 within 1").replace("a2 once y within 2 s", "a2 more than 1 ns since the beginning"),
        "is late decides",
    ),
    "age of a value": (changed("a2 once f0 2000000000", "a2 age f0 2000000000"), "an age is that of news"),
}


@pytest.mark.parametrize(("text", "message"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_about_time_is_refused(text: str, message: str) -> None:
    with pytest.raises(UnreadableError, match=message):
        parse(text)


def test_more_clocks_than_are_looked_at_are_refused() -> None:
    atoms = [f"a{n} once {n}" for n in range(3, 60)]
    definitions = [f"t{n - 2} a{n} once f0 1" for n in range(3, 60)]
    text = changed("t0 a2", "\n".join(["t0 a2 once f0 2000000000", *definitions, "f9 a2"]))
    text = text.replace("a2 once y within 2 s", "\n".join(["a2 once y within 2 s", *atoms]), 1)
    with pytest.raises(UnreadableError, match="more than 50"):
        parse(text)


def test_clocks_side_by_side_are_more_work_than_is_done() -> None:
    """Fifty atoms of the past have 2 to the 50 ways to go on."""
    past = [Once(f"once {n}", ltl.Atom(f"s{n}")) for n in range(50)]
    formula = encode(p.Always(p.Now(ltl.disjunction(past))), EPISODE)
    undecided = Monitor((), (Verdict.PRESUMABLY_SATISFIED,), (0,), ())
    start = Place(ResetMachine(formula).initial, formula)
    certificate = Certificate(formula, ltl.TRUE, undecided, ((start,),), (), ((),))
    assert check(certificate, work=100_000) == Answer(certified=False, exact=False, met=Bound.WORK)


def test_equal_clocks_in_different_scopes_are_told_apart() -> None:
    names = [
        name
        for tracker in trackers_of(encode(EXAMPLES["one response in two scopes"], EPISODE))
        for name in tracker.atoms
    ]
    assert len(set(names)) == len(names) == 2
    assert clocks(EXAMPLES["one response in two scopes"]) == 2


def test_properties_of_one_shape_that_define_their_atoms_differently_are_translated_each() -> None:
    def of(atom: Once) -> Task:
        formula = encode(p.Always(p.Now(ltl.implies(X, atom))), EPISODE)
        return Task(formula, Alphabet(ordinary_atoms(formula)))

    tasks = [of(RECENT), of(replace(RECENT, operand=ltl.Not(Y))), of(replace(RECENT, within=None))]
    assert translate_all(tasks, Budget()) == [translate(task.formula, task.alphabet) for task in tasks]
