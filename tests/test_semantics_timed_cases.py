"""Python and Coq mean the same in time: the table of timed cases is that of the evaluators extracted from Coq."""

from __future__ import annotations

from collections.abc import Iterable

from cases import digits
from timed_cases import OBSERVATIONS, TABLE, Reader

from ltlc.semantics import finite
from ltlc.semantics.denotation import satisfies
from ltlc.semantics.encodings import ENCODINGS, encode
from ltlc.semantics.instants import Step, instants, with_past
from ltlc.semantics.properties import Property, predicates
from ltlc.semantics.timed_atoms import Late, News, PastAtom, atoms_within, news_of
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.trackers import Tracker, trackers_of
from ltlc.semantics.words import Word

CASES = [line.split(" ; ") for line in TABLE.read_text(encoding="utf-8").splitlines()]


def past_of(property_: Property) -> list[PastAtom]:
    """The atoms of the past in a property, each after those that decide it."""
    found = {atom.name: atom for part in predicates(property_) for atom in atoms_within(part)}
    return [atom for atom in found.values() if isinstance(atom, PastAtom) and not isinstance(atom, News | Late)]


def test_the_table_holds_tens_of_thousands_of_timed_cases() -> None:
    assert len(CASES) * len(OBSERVATIONS) > 25_000


def test_the_denotation_on_instants_is_that_of_coq() -> None:
    for text, values in CASES:
        reader = Reader(text)
        property_ = reader.property()
        words = (with_past(instants(steps, until, reader.news), past_of(property_)) for steps, until in OBSERVATIONS)
        assert digits(satisfies(word, property_) for word in words) == values, text


def test_the_encoding_on_clock_steps_is_the_denotation_of_coq() -> None:
    for text, values in CASES:
        reader = Reader(text)
        formula = encode(reader.property(), ENCODINGS["episode"])
        trackers, news = trackers_of(formula), news_of(formula)
        words = (followed(trackers, news, steps, until) for steps, until in OBSERVATIONS)
        assert digits(finite.holds(formula, word) for word in words) == values, text


def followed(trackers: tuple[Tracker, ...], news: Iterable[News], steps: Iterable[Step], until: int) -> Word:
    """The letters at steps and clock steps, with what the trackers say."""
    run = TimedRun(trackers, news, session=0)
    word = [instant for step in steps for instant in run.step(step.time, step.letter)]
    return (*word, *run.hold(until))
