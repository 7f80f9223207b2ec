"""A file of certificates is checked against the specification that it is said to be about."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from support import place
from test_semantics_certificate_text import NEAR, SPEEDING, STOP_SIGN, TEXT, entry

from ltlc.assurance.certificates import Checked, Subject, Unreadable, check_certificates
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.certificate import Answer
from ltlc.semantics.certificate_reader import parse
from ltlc.semantics.certificate_text import Entry, to_text
from ltlc.semantics.ltl import TRUE, Not
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import Never, Now, Throughout, atoms
from ltlc.semantics.verdicts import Verdict

EXACT = Answer(certified=True, exact=True)


def subject(of: Entry) -> Subject:
    return Subject(of.label, of.line, of.subject, Alphabet(atoms(of.subject)), of.encoding)


SUBJECTS = [subject(STOP_SIGN), subject(SPEEDING)]


def objections(subjects: list[Subject], text: str) -> list[str | None]:
    checked = check_certificates(subjects, text)
    assert not isinstance(checked, Unreadable)
    assert all(each.passed == (each.objection is None) for each in checked)
    return [each.objection for each in checked]


def test_certificates_of_the_specification_pass() -> None:
    checked = check_certificates(SUBJECTS, TEXT)
    assert checked == tuple(map(Checked, ["stop_at_sign", "line 4"], [EXACT] * 2, [None] * 2, parse(TEXT)))
    assert tuple(each.certified for each in checked) == parse(TEXT)


def test_a_state_is_shown_to_be_undecided_by_letters_that_go_on_for_ever_where_there_are_such() -> None:
    words = [word for found in STOP_SIGN.certificate.witnesses for word in found]
    assert words
    assert all(len(word.loop) == 1 for word in words)
    assert max(len(word.stem) for word in words) == 1


def test_their_order_does_not_matter() -> None:
    assert objections(SUBJECTS, to_text([SPEEDING, STOP_SIGN])) == [None, None]


def test_a_property_without_a_certificate_does_not_pass() -> None:
    assert objections(SUBJECTS, to_text([STOP_SIGN])) == [None, "it has no certificate"]


def test_a_certificate_for_a_property_that_the_specification_has_not_does_not_pass() -> None:
    assert objections(SUBJECTS[:1], TEXT) == [None, "the specification has no such property"]


@pytest.mark.parametrize(
    ("changed", "objection"),
    [
        ({"property": Throughout(Not(NEAR))}, "the certificate is for another property"),
        ({"encoding": "dwyer"}, "the certificate is for encoding 'episode', not 'dwyer'"),
    ],
)
def test_a_certificate_for_something_else_does_not_pass(changed: dict[str, Any], objection: str) -> None:
    assert objections([replace(SUBJECTS[0], **changed), SUBJECTS[1]], TEXT) == [objection, None]


def test_a_formula_that_is_not_the_encoding_of_the_property_does_not_pass() -> None:
    other = entry("line 4", Never(Now(Not(NEAR))))
    forged = replace(SPEEDING, certificate=other.certificate)
    assert objections(SUBJECTS[1:], to_text([forged])) == [
        "the certificate's formula is not the 'episode' encoding of the property"
    ]


def test_an_assumption_that_the_atoms_arithmetic_does_not_grant_does_not_pass() -> None:
    property_ = SPEEDING.subject
    nothing_holds = Alphabet(atoms(property_), (Group(atoms(property_), (frozenset(),)),))
    forged = to_text([entry("line 4", property_, alphabet=nothing_holds)])
    assert objections(SUBJECTS[1:], forged) == [
        "the certificate assumes more about its atoms than their arithmetic gives"
    ]
    assert objections([replace(SUBJECTS[1], alphabet=nothing_holds)], forged) == [None]


def test_a_certificate_that_assumes_the_impossible_does_not_pass() -> None:
    certificate = replace(SPEEDING.certificate, assumption=Not(TRUE))
    forged = to_text([replace(SPEEDING, certificate=certificate)])
    assert objections(SUBJECTS[1:], forged) == ["no letter is found that the certificate's assumption allows"]


def test_a_certificate_that_shows_nothing_does_not_pass() -> None:
    forged = TEXT.replace("q0 presumably_satisfied", "q0 satisfied", 1)
    assert objections(SUBJECTS, forged) == ["the certificate does not show it", None]


def test_a_monitor_that_is_right_but_decides_too_late_does_not_pass() -> None:
    always_right = entry("line 4", Throughout(TRUE))
    undecided = Monitor((), (Verdict.PRESUMABLY_SATISFIED,), (0,), ())
    remains = ((place(always_right.certificate.formula),),)
    late = replace(always_right.certificate, monitor=undecided, annotations=remains, witnesses=((),))
    text = to_text([replace(always_right, certificate=late)])
    assert objections([subject(always_right)], text) == [
        "its verdicts are right, but one that could be permanent may be missing"
    ]


def test_a_text_that_is_no_certificate_is_reported_with_its_line() -> None:
    assert check_certificates(SUBJECTS, "garbage\n") == Unreadable(1, "a certificate starts with 'ltlc-certificate 1'")


def test_two_certificates_with_one_label_are_refused() -> None:
    expected = Unreadable(1, "two certificates have the same label")
    assert check_certificates(SUBJECTS, to_text([STOP_SIGN, STOP_SIGN])) == expected
