"""Random properties, over letters some of which do not exist: what is found is compared with all short runs."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import alphabets, properties, temporal_subformulas
from studies import short_lassos, short_words, study
from tableau import Tableau

from ltlc.analysis.lassos import LassoSearch
from ltlc.analysis.questions import (
    inconsistent,
    never_decided,
    never_triggered,
    no_finite_run,
    redundant,
    unsatisfiable,
    vacuous_part,
    valid,
)
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import Atom, Not, eventually
from ltlc.semantics.properties import AfterUntil, Property
from ltlc.semantics.verdicts import Verdict

AB = ("a", "b")
few = settings(max_examples=60)
stated = properties(AB, depth=2)
letters = alphabets(AB)


@few
@given(stated, letters)
def test_unsatisfiable_means_no_short_run_and_else_there_is_a_run(property_: Property, known: Alphabet) -> None:
    about = study(known, property_)
    found = list(unsatisfiable.ask(about, about.subjects[0]))
    formula = about.subjects[0].formula
    if found:
        assert not any(holds_on_lasso(formula, lasso) for lasso in short_lassos(known, 3))
        assert not any(satisfies(word, property_) for word in short_words(known, 4))
    else:
        run = about.languages.word([about.words[0]])
        assert run is not None
        assert holds_on_lasso(formula, run)


@few
@given(stated, letters)
def test_whether_it_can_hold_and_fail_is_what_a_tableau_says(property_: Property, known: Alphabet) -> None:
    about = study(known, property_)
    (subject,) = about.subjects
    if len(set(temporal_subformulas(subject.formula))) > 4:
        return
    verdict = Tableau(subject.formula, subject.alphabet.letters()).verdict(())
    assert bool(list(unsatisfiable.ask(about, subject))) == (verdict is Verdict.VIOLATED)
    assert bool(list(valid.ask(about, subject))) == (verdict is Verdict.SATISFIED)


@few
@given(stated, letters)
def test_what_is_called_valid_fails_on_no_short_run(property_: Property, known: Alphabet) -> None:
    about = study(known, property_)
    if list(valid.ask(about, about.subjects[0])):
        assert all(holds_on_lasso(about.subjects[0].formula, lasso) for lasso in short_lassos(known, 3))
        assert all(satisfies(word, property_) for word in short_words(known, 4))


@few
@given(stated, letters)
def test_what_has_no_finite_run_has_no_short_one_and_has_an_infinite_one(property_: Property, known: Alphabet) -> None:
    about = study(known, property_)
    found = list(no_finite_run.ask(about, about.subjects[0]))
    if found:
        assert not any(satisfies(word, property_) for word in short_words(known, 4))
        run = about.languages.word([about.words[0]])
        assert run is not None
        assert holds_on_lasso(about.subjects[0].formula, run)
    elif not about.subjects[0].never_holds:
        assert any(verdict.holds for verdict in about.subjects[0].monitor.verdicts)  # type: ignore[union-attr]


@few
@given(stated, letters)
def test_a_vacuous_part_can_be_replaced_on_every_short_run(property_: Property, known: Alphabet) -> None:
    about = study(known, property_)
    if not about.subjects[0].is_contingent:
        return
    replaced = property_
    for path, truth in vacuous_part.vacuous(about, about.subjects[0]):
        replaced = vacuous_part.replaced(replaced, path, truth)
    formula = encode(replaced, EPISODE)
    for word in short_words(known, 3):
        assert satisfies(word, property_) == satisfies(word, replaced)
    for lasso in short_lassos(known, 3):
        assert holds_on_lasso(about.subjects[0].formula, lasso) == holds_on_lasso(formula, lasso)


@few
@given(properties(AB, depth=1), st.booleans())
def test_no_event_is_idle_where_the_closing_event_is_its_negation(body: Property, positive: bool) -> None:
    event, negation = Atom("a"), Not(Atom("a"))
    scope = AfterUntil(event, negation, body) if positive else AfterUntil(negation, event, body)
    about = study(Alphabet(AB, ()), scope)
    if about.subjects[0].is_contingent:
        assert not [path for path, _ in vacuous_part.vacuous(about, about.subjects[0]) if path[0] < 2]


@few
@given(stated, letters)
def test_what_is_never_decided_can_go_either_way_after_every_short_run(property_: Property, known: Alphabet) -> None:
    about = study(known, property_)
    if not list(never_decided.ask(about, about.subjects[0])):
        return
    continuations = short_lassos(known, 3)
    for word in short_words(known, 2):
        truths = {
            holds_on_lasso(about.subjects[0].formula, type(rest)(word + rest.stem, rest.loop)) for rest in continuations
        }
        assert truths == {True, False}


@few
@given(stated, letters)
def test_an_event_that_is_never_triggered_happens_on_no_short_run_that_satisfies(
    property_: Property, known: Alphabet
) -> None:
    about = study(known, property_)
    subject = about.subjects[0]
    if not subject.is_contingent:
        return
    lassos = [lasso for lasso in short_lassos(known, 3) if holds_on_lasso(subject.formula, lasso)]
    for event in never_triggered.events(property_):
        occurs = eventually(event.predicate)
        happens = any(holds_on_lasso(occurs, lasso) for lasso in lassos)
        assert not (happens and event in never_triggered.impossible(about, subject))


@few
@given(stated, stated, letters)
def test_what_is_redundant_holds_on_every_short_run_that_satisfies_the_other(
    one: Property, other: Property, known: Alphabet
) -> None:
    about = study(known, one, other)
    for subject, given_ in ((about.subjects[0], about.subjects[1]), (about.subjects[1], about.subjects[0])):
        if not list(redundant.ask(about, subject)):
            continue
        for word in short_words(known, 3):
            assert satisfies(word, subject.specification.property) or not satisfies(word, given_.specification.property)


@few
@given(stated, stated, letters)
def test_two_properties_are_inconsistent_exactly_if_no_run_satisfies_both(
    one: Property, other: Property, known: Alphabet
) -> None:
    about = study(known, one, other)
    for component in about.components:
        if len(component) < 2:
            continue
        found = list(inconsistent.ask(about, component))
        together = [all(holds_on_lasso(s.formula, lasso) for s in component) for lasso in short_lassos(known, 3)]
        assert not (found and any(together))
        if not found:
            run = about.languages.word(about.words)
            assert run is not None
            assert all(holds_on_lasso(s.formula, run) for s in component)


@few
@given(stated, letters, st.integers(1, 3))
def test_the_search_for_lassos_finds_one_exactly_if_there_is_one_of_that_length(
    property_: Property, known: Alphabet, length: int
) -> None:
    formula = encode(property_, EPISODE)
    search = LassoSearch([formula], known, length)
    exact = [lasso for lasso in short_lassos(known, length) if len(lasso.stem) + len(lasso.loop) == length]
    truths = {holds_on_lasso(formula, lasso) for lasso in exact}
    assert (search.find({0: True}) is not None) == (True in truths)
    assert (search.find({0: False}) is not None) == (False in truths)
