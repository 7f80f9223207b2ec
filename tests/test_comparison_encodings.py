"""Encodings from a file and those that have been published."""

import itertools

import pytest
from hypothesis import given, settings
from strategies import formulas, properties, words

from ltlc.analysis.comparison.encoding_file import read_encodings
from ltlc.analysis.comparison.equations import parse_equation
from ltlc.analysis.comparison.published import FORMULAS, LETTERS, PUBLISHED, Pattern, Scope, UndefinedError, formula
from ltlc.automata.queries import implies
from ltlc.base.limits import Budget
from ltlc.base.source import Source, Span
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import READINGS, satisfies
from ltlc.semantics.encodings import ENCODINGS, Encoding, encode
from ltlc.semantics.finite import holds
from ltlc.semantics.ltl import Atom, Formula, is_next_free, to_text
from ltlc.semantics.properties import AfterUntil, Always, Eventually, Now, Property, Throughout
from ltlc.semantics.words import Word, all_letters, all_words

P, Q, R, S, T = (Atom(letter) for letter in LETTERS)

OWN = """
encoding literal
after X, Z          = G(X -> G Z)
until X, Z          = Z U X
after_until X, Y, Z = G(X -> (Z W Y))
bare

encoding segments   # episode, written with rel
after X, Z          = !X W (X & Z)
until X, Z          = F X ∧ rel(X, Z)
after_until X, Y, Z = (!(X & !Y) W (X & !Y & rel(Y, Z))) & [](Y -> (!(X & !Y) W (X & !Y & rel(Y, Z))))
"""


def read(text: str) -> tuple[list[Encoding], list[tuple[str, int, int]]]:
    source = Source("own.txt", text)
    encodings, problems = read_encodings(source, frozenset(ENCODINGS), Budget())
    places = [(p.code, source.position(p.primary.span.start)) for p in problems if p.primary]
    return encodings, [(code, place.line, place.column) for code, place in places]


@settings(max_examples=60)
@given(properties(depth=2))
def test_an_encoding_in_a_file_is_the_one_it_writes_out(property_: Property) -> None:
    literal, segments = read(OWN)[0]
    assert encode(property_, literal) == encode(property_, ENCODINGS["pointwise"])
    for word in itertools.islice(all_words(all_letters(("a", "b", "c")), 2), 0, None, 5):
        assert holds(encode(property_, segments), word) == satisfies(word, property_)


@settings(max_examples=150)
@given(formulas(max_leaves=5).filter(is_next_free), words())
def test_an_equation_is_read_as_the_formula_it_writes_out(formula: Formula, word: Word) -> None:
    text = to_text(formula)
    equation = parse_equation(Source("equation", text), Span(0, len(text)), "abc", "abc")
    assert holds(equation.of({name: Atom(name) for name in "abc"}), word) == holds(formula, word)


@pytest.mark.parametrize(
    ("text", "other"),
    [
        ("a | b & c", "a | (b & c)"),
        ("a & b -> c | a -> b", "(a & b) -> ((c | a) -> b)"),
        ("a U b U c & a", "(a U (b U c)) & a"),
        ("!a U b", "(!a) U b"),
        ("F a & G b", "(F a) & (G b)"),
        ("¬a ∧ b → c ∨ a", "((!a) && b) => (c || a)"),
        ("[]<>a <-> b", "(G F a) <=> b"),
        ("rel(c, F a & G b)", "(!c U (!c & a)) & !(!c U (!c & !(!c & b)))"),
    ],
)
def test_operators_bind_as_in_spot(text: str, other: str) -> None:
    meaning = {name: Atom(name) for name in "abc"}
    left, right = (parse_equation(Source("", t), Span(0, len(t)), "abc", "abc").of(meaning) for t in (text, other))
    assert all(holds(left, word) == holds(right, word) for n in (1, 2, 3) for word in all_words(all_letters("abc"), n))


@pytest.mark.parametrize(
    ("equation", "code", "column"),
    [
        ("after_until X, Y, Z = G(X -> (Z W Q))", "LTL322", 35),
        ("after_until X, Y, Z = G(X -> (Z W Y)", "LTL321", 24),
        ("after_until X, Y, Z = G(X -> Z W Y))", "LTL321", 36),
        ("after_until X, Y, Z = X -> Z Y", "LTL321", 30),
        ("after_until X, Y, Z =", "LTL321", 22),
        ("after_until X, Z = G(X -> Z)", "LTL324", 1),
        ("after_until X, Y, Z = rel(Z, Y)", "LTL324", 23),
        ("after_until X, Y, Z = rel(F Y, Z)", "LTL324", 23),
        ("after_until X, Y, Z = rel(Y, Z, X)", "LTL324", 23),
        ("after_until X, Y, Z = rel Z", "LTL321", 23),
        (f"after_until X, Y, Z = {'G ' * 200}Z", "LTL321", 123),
        (f"after_until X, Y, Z = {'!' * 600}Z", "LTL321", 73),
        (f"after_until X, Y, Z = {'(' * 60}Z{')' * 60}", "LTL321", 73),
        (f"after_until X, Y, Z = {'X -> ' * 60}Z", "LTL321", 275),
        (f"after_until X, Y, Z = {'next(' * 60}Z{')' * 60}", "LTL321", 277),
        ("after_untl X, Y, Z = Z", "LTL322", 1),
        ("after_until X, Y, Z = GX & Z & Y", "LTL322", 23),
        ("after_until", "LTL321", 1),
    ],
)
def test_an_equation_that_makes_no_sense_is_refused_at_its_place(equation: str, code: str, column: int) -> None:
    encodings, problems = read(f"encoding own\nafter X, Z = G(X -> G Z)\nuntil X, Z = Z U X\n{equation}\n")
    assert not encodings
    assert problems[0] == (code, 4, column)


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ("", "LTL323", 1),
        ("# nothing\n", "LTL323", 1),
        ("after X, Z = G Z", "LTL323", 1),
        ("encoding episode", "LTL323", 1),
        ("encoding two words", "LTL321", 1),
        ("encoding own\nafter X, Z = Z & X\nuntil X, Z = Z & X\n", "LTL323", 1),
        ("encoding own\nafter X, Z = Z & X\nafter X, Z = Z & X\n", "LTL323", 3),
    ],
)
def test_an_incomplete_file_is_refused(text: str, code: str, line: int) -> None:
    encodings, problems = read(text)
    assert not encodings
    assert problems[0][:2] == (code, line)


def test_an_equation_without_its_body_or_that_never_fails_gets_a_warning() -> None:
    text = "encoding own\nafter X, Z = X | !X\nuntil X, Z = F X\nafter_until X, Y, Z = G(X -> rel(Y, Z))\n"
    encodings, problems = read(text)
    assert [e.name for e in encodings] == ["own"]
    assert problems == [("LTL325", 2, 1), ("LTL325", 3, 1)]


@pytest.mark.parametrize("property_", [AfterUntil(Q, R, Throughout(P)), AfterUntil(Q, R, Eventually(Now(P)))])
def test_the_second_edition_opens_a_scope_at_every_step_as_the_encoding_dwyer_does(property_: Property) -> None:
    second, every_step = encode(property_, PUBLISHED["dwyer-2"]), encode(property_, ENCODINGS["dwyer"])
    alphabet = Alphabet(("q", "r", "p"))
    assert implies(second, every_step, alphabet)
    assert implies(every_step, second, alphabet)
    for word in all_words(all_letters(("p", "q", "r")), 3):
        assert holds(second, word) == satisfies(word, property_, READINGS["dwyer"])


def test_the_editions_part_where_the_body_comes_with_the_closing_event() -> None:
    run = (frozenset("q"), frozenset("pr"))
    first, second = (formula(Pattern.EXISTENCE, Scope.AFTER_UNTIL, k, p=P, q=Q, r=R, s=S) for k in (1, 2))
    assert holds(first, run)
    assert not holds(second, run)


def test_a_published_encoding_is_undefined_for_a_body_that_is_no_pattern() -> None:
    with pytest.raises(UndefinedError, match="state predicate"):
        encode(AfterUntil(Q, R, Always(Eventually(Now(P)))), PUBLISHED["dwyer-1"])


def test_every_published_formula_can_be_read() -> None:
    meaning: dict[str, Formula] = dict(zip(LETTERS, (P, Q, R, S, T), strict=True))
    for pattern, scope in FORMULAS:
        for edition in (1, 2):
            assert formula(pattern, scope, edition, **meaning)
