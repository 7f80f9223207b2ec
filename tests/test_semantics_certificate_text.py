"""Certificates survive being written and read; any other text is refused with the line that is wrong."""

from __future__ import annotations

import random
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import alphabets, properties
from support import compiled

from ltlc.assurance.certify import certify
from ltlc.assurance.pairs import followed
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.certificate import Certificate, check
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.certificate_text import Entry, in_words, to_text
from ltlc.semantics.encodings import ENCODINGS, EPISODE, Encoding
from ltlc.semantics.intervals import without_intervals
from ltlc.semantics.ltl import TRUE, And, Atom, Not, Or
from ltlc.semantics.properties import AfterUntil, Eventually, Never, Now, Property


def entry(label: str, property_: Property, encoding: Encoding = EPISODE, alphabet: Alphabet | None = None) -> Entry:
    each = compiled(property_, encoding, alphabet)
    certificate = certify(each.formula, each.specification.alphabet, each.monitor)
    assert isinstance(certificate, Certificate)
    return Entry(
        label, 1, without_intervals(property_), encoding.name, certificate, followed(each, certificate.assumption)
    )


NEAR, FAR, STOPPED = Atom("d < 1"), Atom("d > 3"), Atom("speed == 0")
STOP_SIGN = entry("stop_at_sign", AfterUntil(NEAR, FAR, Eventually(Now(STOPPED))))
SPEEDING = entry("line 4", Never(Now(Atom("speed > 2"))))
TEXT = to_text([STOP_SIGN, SPEEDING])


@settings(max_examples=60)
@given(properties(), st.sampled_from(list(ENCODINGS.values())), alphabets())
def test_what_is_written_can_be_read(property_: Property, encoding: Encoding, alphabet: Alphabet) -> None:
    written = entry("any", property_, encoding, alphabet)
    (read,) = parse(to_text([written]))
    assert (read.label, read.subject, read.encoding) == (written.label, written.subject, written.encoding)
    assert read.certificate.formula == written.certificate.formula
    assert read.certificate.assumption == written.certificate.assumption
    assert check(read.certificate) == check(written.certificate)
    assert read.program == written.program


def test_a_certificate_reads_as_a_page() -> None:
    (_, page) = TEXT.split("\n\n", 1)
    start = ["property stop_at_sign", "line 1", "encoding episode", "a0 d < 1", "a1 d > 3", "a2 speed == 0"]
    assert page.splitlines()[: len(start)] == start
    assert "violated" in page


def test_an_assumption_is_written_as_in_the_language() -> None:
    far_or_stopped = And(Or(FAR, STOPPED), Not(And(FAR, STOPPED)))
    assert in_words(far_or_stopped) == "(d > 3 or speed == 0) and not (d > 3 and speed == 0)"
    assert in_words(Or(And(NEAR, Not(FAR)), TRUE)) == "d < 1 and not d > 3 or true"


def test_comments_and_empty_lines_mean_nothing() -> None:
    spaced = "\n".join(f"# about the next line\n\n{line}" for line in TEXT.splitlines())
    assert parse(spaced) == parse(TEXT)


@pytest.mark.parametrize("end", range(0, len(TEXT) - 1, 7))
def test_a_truncated_certificate_is_refused(end: int) -> None:
    with pytest.raises(UnreadableError):
        parse(TEXT[:end])


FIRST_FORMULA = next(k for k, line in enumerate(TEXT.splitlines()) if line.startswith("f0 "))


def with_first_formula(words: str) -> str:
    """The text with something else for the first formula."""
    lines = TEXT.splitlines()
    lines[FIRST_FORMULA] = f"f0 {words}"
    return "\n".join(lines) + "\n"


END, BRANCH, PAIR = (TEXT.splitlines().index(line) + 1 for line in ("end", "b0 a0 then b1 else o0", "pair s0 q0"))
WRONG = {
    "nothing": ("", 1),
    "another file": ("#!/bin/sh\necho\n", 2),
    "another version": (TEXT.replace("certificate 1", "certificate 2"), 1),
    "no count": (TEXT.replace("properties 2", "properties"), 2),
    "a wrong count": (TEXT.replace("properties 2", "properties 3"), len(TEXT.splitlines()) + 1),
    "an unknown encoding": (TEXT.replace("encoding episode", "encoding epic", 1), 6),
    "an atom without a name": (TEXT.replace("a0 d < 1", "a0"), 7),
    "an atom twice": (TEXT.replace("a1 d > 3", "a1 d < 1"), END),
    "atoms out of order": (TEXT.replace("a0 d < 1", "a1 d < 1"), 7),
    "an unknown atom": (with_first_formula("a9"), FIRST_FORMULA + 1),
    "a formula before its parts": (with_first_formula("not f1"), FIRST_FORMULA + 1),
    "a huge number": (with_first_formula("a" + "9" * 5000), FIRST_FORMULA + 1),
    "a Greek digit": (TEXT.replace("line 1", "line \u0663", 1), 5),
    "a branch that does not exist": (TEXT.replace("s0 presumably_satisfied b0", "s0 presumably_satisfied b99", 1), END),
    "a clock that does not exist": (TEXT.replace("b0 a0 then", "b0 c0 then", 1), BRANCH),
    "a clock that is not set to anything": (TEXT.replace("\no0 s0\n", "\no0 s0 c0\n", 1), BRANCH + 5),
    "a pair before its state": (TEXT.replace("pair s0 q0", "pair s9 q0", 1), PAIR),
    "a second encoding": (TEXT.replace("encoding episode", "encoding episode\nencoding episode", 1), 7),
}


@pytest.mark.parametrize(("text", "line"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_told_with_its_line(text: str, line: int) -> None:
    with pytest.raises(UnreadableError) as caught:
        parse(text)
    assert caught.value.line == line


def test_a_deeply_nested_formula_is_no_reason_to_fall_over() -> None:
    lines = TEXT.splitlines()
    first = FIRST_FORMULA + 1
    last = next(k for k in range(first, len(lines)) if not lines[k].startswith("f"))
    count = last - first + 1
    chain = [f"f{k} next f{k - 1}" for k in range(count, count + 4000)]
    deep = [*lines[:last], *chain, *lines[last:]]
    formula = next(k for k, line in enumerate(deep) if line.startswith("formula "))
    deep[formula] = f"formula f{count + 3999}"
    assert not check(parse("\n".join(deep))[0].certificate).certified


def test_a_formula_that_doubles_at_every_line_is_refused() -> None:
    lines = TEXT.splitlines()
    first = FIRST_FORMULA + 1
    with pytest.raises(UnreadableError, match="too large"):
        parse("\n".join([*lines[:first], *(f"f{k} and f{k - 1} f{k - 1}" for k in range(1, 60)), *lines[first:]]))


def mangled(text: str, chance: random.Random) -> str:
    """The text with a few words exchanged, lines lost, doubled or moved."""
    lines = text.splitlines()
    for _ in range(chance.randint(1, 3)):
        here, there = chance.randrange(len(lines)), chance.randrange(len(lines))
        words, other = lines[here].split(" "), lines[there].split(" ")
        change = chance.randrange(4)
        if change == 0:
            words[chance.randrange(len(words))] = chance.choice(other)
            lines[here] = " ".join(words)
        elif change == 1:
            del lines[here]
        elif change == 2:
            lines.insert(there, lines[here])
        else:
            lines[here] = lines[here][: chance.randrange(len(lines[here]) + 1)]
    return "\n".join(lines) + "\n"


@given(st.randoms(use_true_random=False))
def test_a_mangled_certificate_is_refused_or_answered(chance: random.Random) -> None:
    with suppress(UnreadableError):
        for each in parse(mangled(TEXT, chance)):
            check(each.certificate)


@given(st.text())
def test_any_text_is_refused(text: str) -> None:
    with pytest.raises(UnreadableError):
        parse(f"ltlc-certificate 1\nproperties 1\n{text}")


def test_a_name_with_a_line_break_cannot_be_written() -> None:
    with pytest.raises(ValueError, match="line"):
        to_text([entry("any", Never(Now(Atom("two\nlines"))))])
