"""Checking a file of certificates against a specification: `ltlc certify` trusts neither Spot nor the producer."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

from ltlc.dataclass import dataclass
from ltlc.semantics import properties
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.certificate import DEPTH, WORK, Answer, Certificate, check, possible
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.certificate_text import Entry
from ltlc.semantics.conditions import Bound, Conditions
from ltlc.semantics.encodings import ENCODINGS, encode
from ltlc.semantics.intervals import without_intervals
from ltlc.semantics.ltl import TRUE, Formula
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import Occurred, duration_of, operands, timed_atoms


@dataclass(frozen=True, slots=True)
class Subject:
    """A property of a specification, as the front end understands it: what a certificate has to be about."""

    label: str
    line: int
    property: Property
    alphabet: Alphabet
    encoding: str


@dataclass(frozen=True, slots=True)
class Checked:
    """What became of one property: the checker's answer, or why its certificate was not even looked at.

    `entry` is its certificate, where the checker was asked and has met no bound.
    """

    label: str
    answer: Answer
    objection: str | None = None
    entry: Entry | None = None

    @property
    def assumption(self) -> Formula:
        """What its certificate supposes of every letter."""
        return TRUE if self.entry is None else self.entry.certificate.assumption

    @property
    def certified(self) -> Entry | None:
        """The certificate, if it is accepted; its program has not been checked."""
        return self.entry if self.answer.certified else None

    @property
    def passed(self) -> bool:
        """Whether the property is certified exactly: its verdicts are right, and permanent as soon as they can be."""
        return self.answer.exact


@dataclass(frozen=True, slots=True)
class Unreadable:
    """The certificate is not one: `line` of it says something else."""

    line: int
    message: str


def check_certificates(subjects: Sequence[Subject], text: str) -> tuple[Checked, ...] | Unreadable:
    """What the certificates in `text` prove of `subjects`, each of which must have one; in their order.

    A certificate for something else, or one that supposes more about the letters than the atoms' arithmetic
    gives, is objected to and counts as none.
    """
    try:
        entries = parse(text)
    except UnreadableError as error:
        return Unreadable(error.line, error.message)
    by_label = {entry.label: entry for entry in entries}
    if len(by_label) < len(entries):
        return Unreadable(1, "two certificates have the same label")
    checked = [_check(subject, by_label.pop(subject.label, None)) for subject in subjects]
    surplus = [
        Checked(label, Answer(certified=False, exact=False), "the specification has no such property")
        for label in by_label
    ]
    return (*checked, *surplus)


def _check(subject: Subject, entry: Entry | None) -> Checked:
    objection = "it has no certificate" if entry is None else _objection(subject, entry)
    if entry is None or objection is not None:
        return Checked(subject.label, Answer(certified=False, exact=False), objection)
    answer = check(entry.certificate)
    if answer.met is not None:
        return Checked(subject.label, answer, over_bound(answer.met))
    if not answer.certified:
        objection = "the certificate does not show it"
    elif not answer.exact:
        objection = "its verdicts are right, but one that could be permanent may be missing"
    return Checked(subject.label, answer, objection, entry)


def over_bound(bound: Bound) -> str:
    """That checking a certificate met `bound`, in words."""
    if bound is Bound.WORK:
        return f"checking its certificate takes more work than the checker may do ({WORK:,} units)"
    return f"checking its certificate takes more than {DEPTH} nested case distinctions"


def _objection(subject: Subject, entry: Entry) -> str | None:
    """Why `entry` is not about `subject`, if it is not."""
    conditions, said = Conditions(), without_intervals(subject.property)
    if entry.encoding != subject.encoding:
        return f"the certificate is for encoding '{entry.encoding}', not '{subject.encoding}'"
    if _key(conditions, entry.subject) != _key(conditions, said):
        return "the certificate is for another property"
    if _definitions(conditions, entry.subject) != _definitions(conditions, said):
        return "the certificate defines its timed atoms in another way"
    formula = encode(said, ENCODINGS[subject.encoding])
    if conditions.number(entry.certificate.formula) != conditions.number(formula):
        return f"the certificate's formula is not the '{subject.encoding}' encoding of the property"
    if not possible(entry.certificate.assumption):
        return "no letter is found that the certificate's assumption allows"
    if not _is_assumption(conditions, entry.certificate, subject.alphabet):
        return "the certificate assumes more about its atoms than their arithmetic gives"
    return None


def _definitions(conditions: Conditions, property_: Property) -> set[tuple[object, ...]]:
    """Those that certificates have: to them, a count is an atom of letters."""
    atoms = (atom for predicate in properties.predicates(property_) for atom in timed_atoms(predicate))
    return {
        (type(atom), atom.name, duration_of(atom), *map(conditions.number, operands(atom)))
        for atom in atoms
        if not isinstance(atom, Occurred)
    }


def _is_assumption(conditions: Conditions, certificate: Certificate, alphabet: Alphabet) -> bool:
    """Whether the assumption is that of the alphabet, or none."""
    granted = (TRUE, alphabet.as_formula(), alphabet.restricted_to(certificate.monitor.atoms).as_formula())
    return conditions.number(certificate.assumption) in {conditions.number(formula) for formula in granted}


def _key(conditions: Conditions, property_: Property) -> Hashable:
    """What is the same for equal properties over atoms with equal names, however deep their state predicates are."""
    own = {
        properties.Now: ("predicate",),
        properties.Throughout: ("predicate",),
        properties.After: ("event",),
        properties.Until: ("event",),
        properties.AfterUntil: ("opening", "closing"),
    }.get(type(property_), ())
    predicates = [conditions.number(getattr(property_, name)) for name in own]
    durations = [property_.duration] if isinstance(property_, properties.Within) else []
    parts = [_key(conditions, part) for part in properties.children(property_)]
    return (type(property_).__name__, *predicates, *durations, *parts)
