"""The specification patterns of Dwyer, Avrunin and Corbett in linear temporal logic, in both editions.

M. B. Dwyer, G. S. Avrunin, J. C. Corbett: *Patterns in property specifications for finite-state verification*, 1999.
The formulas are those of two pages of the authors': the first edition at people.cs.ksu.edu/~dwyer/SPAT/ltl.html, the
second at matthewbdwyer.github.io/psp/patterns/ltl.html. They part where a scope opens and closes at the same step, and
where what is demanded happens at the step that closes.

As encodings, `after` is the patterns' scope 'after', `until` their 'before', and `after_until` their 'after … until'
or, in the encodings that end in `-between`, their 'between'. They are defined for the bodies that the patterns have.
"""

from __future__ import annotations

from enum import Enum

from ltlc.analysis.comparison.equations import parse_equation
from ltlc.base.source import Source, Span
from ltlc.semantics import ltl
from ltlc.semantics.encodings import Encoding
from ltlc.semantics.ltl import Formula, is_propositional

LETTERS = ("p", "q", "r", "s", "t")
"""What the pattern is about, the event that opens, the one that closes, and those that precede or answer."""


class Pattern(Enum):
    """What is demanded in a scope."""

    ABSENCE = "absence"
    EXISTENCE = "existence"
    UNIVERSALITY = "universality"
    PRECEDENCE = "precedence"
    RESPONSE = "response"
    PRECEDENCE_CHAIN_2_1 = "precedence chain, s and t before p"
    PRECEDENCE_CHAIN_1_2 = "precedence chain, p before s and t"
    RESPONSE_CHAIN_2_1 = "response chain, p after s and t"
    RESPONSE_CHAIN_1_2 = "response chain, s and t after p"


class Scope(Enum):
    """Where it is demanded."""

    GLOBALLY = "globally"
    BEFORE = "before"
    AFTER = "after"
    BETWEEN = "between"
    AFTER_UNTIL = "after-until"


_CAUSES_BEFORE_P = "s & !p & next(!p U t)"
_ANSWERS_BEFORE_R = "s & !r & next(!r U t)"
_S_THEN_T, _S_THEN_T_BEFORE_R = "s & next(F t)", "s & !r & next(!r U (t & !r))"
_ANSWERED_BEFORE_R = "(s & next(!r U t)) -> next(!r U (t & F p))"

_TWO_EDITIONS: dict[tuple[Pattern, Scope], tuple[str, str]] = {
    (Pattern.ABSENCE, Scope.GLOBALLY): ("G !p", "G !p"),
    (Pattern.ABSENCE, Scope.BEFORE): ("F r -> (!p U r)", "F r -> (!p U r)"),
    (Pattern.ABSENCE, Scope.AFTER): ("G(q -> G !p)", "G(q -> G !p)"),
    (Pattern.ABSENCE, Scope.BETWEEN): ("G((q & F r) -> (!p U r))", "G((q & !r & F r) -> (!p U r))"),
    (Pattern.ABSENCE, Scope.AFTER_UNTIL): ("G(q -> (!p U (r | G !p)))", "G((q & !r) -> (!p W r))"),
    (Pattern.EXISTENCE, Scope.GLOBALLY): ("F p", "F p"),
    (Pattern.EXISTENCE, Scope.BEFORE): ("F r -> (!r U p)", "!r W (p & !r)"),
    (Pattern.EXISTENCE, Scope.AFTER): ("G !q | F(q & F p)", "G !q | F(q & F p)"),
    (Pattern.EXISTENCE, Scope.BETWEEN): ("G((q & F r) -> (!r U p))", "G((q & !r) -> (!r W (p & !r)))"),
    (Pattern.EXISTENCE, Scope.AFTER_UNTIL): ("G(q -> (!r U p))", "G((q & !r) -> (!r U (p & !r)))"),
    (Pattern.UNIVERSALITY, Scope.GLOBALLY): ("G p", "G p"),
    (Pattern.UNIVERSALITY, Scope.BEFORE): ("F r -> (p U r)", "F r -> (p U r)"),
    (Pattern.UNIVERSALITY, Scope.AFTER): ("G(q -> G p)", "G(q -> G p)"),
    (Pattern.UNIVERSALITY, Scope.BETWEEN): ("G((q & F r) -> (p U r))", "G((q & !r & F r) -> (p U r))"),
    (Pattern.UNIVERSALITY, Scope.AFTER_UNTIL): ("G(q -> (p U (r | G p)))", "G((q & !r) -> (p W r))"),
    (Pattern.PRECEDENCE, Scope.GLOBALLY): ("F p -> (!p U (s & !p))", "!p W s"),
    (Pattern.PRECEDENCE, Scope.BEFORE): ("F r -> (!p U (s | r))", "F r -> (!p U (s | r))"),
    (Pattern.PRECEDENCE, Scope.AFTER): ("G !q | F(q & (!p U (s | G !p)))", "G !q | F(q & (!p W s))"),
    (Pattern.PRECEDENCE, Scope.BETWEEN): ("G((q & F r) -> (!p U (s | r)))", "G((q & !r & F r) -> (!p U (s | r)))"),
    (Pattern.PRECEDENCE, Scope.AFTER_UNTIL): ("G(q -> ((!p U (s | r)) | G !p))", "G((q & !r) -> (!p W (s | r)))"),
    (Pattern.RESPONSE, Scope.GLOBALLY): ("G(p -> F s)", "G(p -> F s)"),
    (Pattern.RESPONSE, Scope.BEFORE): (
        "(p -> (!r U s)) U (r | G !r)",
        "F r -> ((p -> (!r U (s & !r))) U r)",
    ),
    (Pattern.RESPONSE, Scope.AFTER): ("G(q -> G(p -> F s))", "G(q -> G(p -> F s))"),
    (Pattern.RESPONSE, Scope.BETWEEN): (
        "G((q & F r) -> ((p -> (!r U s)) U r))",
        "G((q & !r & F r) -> ((p -> (!r U (s & !r))) U r))",
    ),
    (Pattern.RESPONSE, Scope.AFTER_UNTIL): (
        "G(q -> (((p -> (!r U s)) U r) | G(p -> (!r U s))))",
        "G((q & !r) -> ((p -> (!r U (s & !r))) W r))",
    ),
}
"""What the editions may write differently."""

_CHAINS: dict[Pattern, tuple[str, str, str, str, str]] = {
    Pattern.PRECEDENCE_CHAIN_2_1: (
        f"F p -> (!p U ({_CAUSES_BEFORE_P}))",
        f"F r -> (!p U (r | ({_CAUSES_BEFORE_P})))",
        f"G !q | (!q U ((q & F p) -> (!p U ({_CAUSES_BEFORE_P}))))",
        f"G((q & F r) -> (!p U (r | ({_CAUSES_BEFORE_P}))))",
        f"G(q -> (F p -> (!p U (r | ({_CAUSES_BEFORE_P})))))",
    ),
    Pattern.PRECEDENCE_CHAIN_1_2: (
        f"F({_S_THEN_T}) -> (!s U p)",
        f"F r -> (!({_S_THEN_T_BEFORE_R}) U (r | p))",
        f"G !q | (!q U (q & (F({_S_THEN_T}) -> (!s U p))))",
        f"G((q & F r) -> (!({_S_THEN_T_BEFORE_R}) U (r | p)))",
        f"G(q -> ((!({_S_THEN_T_BEFORE_R}) U (r | p)) | G !({_S_THEN_T})))",
    ),
    Pattern.RESPONSE_CHAIN_2_1: (
        f"G(({_S_THEN_T}) -> next(F(t & F p)))",
        f"F r -> (({_ANSWERED_BEFORE_R}) U r)",
        f"G(q -> G(({_S_THEN_T}) -> next(!t U (t & F p))))",
        f"G((q & F r) -> (({_ANSWERED_BEFORE_R}) U r))",
        f"G(q -> (({_ANSWERED_BEFORE_R}) U (r | G({_ANSWERED_BEFORE_R}))))",
    ),
    Pattern.RESPONSE_CHAIN_1_2: (
        f"G(p -> F({_S_THEN_T}))",
        f"F r -> ((p -> (!r U ({_ANSWERS_BEFORE_R}))) U r)",
        f"G(q -> G(p -> ({_S_THEN_T})))",
        f"G((q & F r) -> ((p -> (!r U ({_ANSWERS_BEFORE_R}))) U r))",
        f"G(q -> ((p -> (!r U ({_ANSWERS_BEFORE_R}))) U (r | G(p -> ({_S_THEN_T})))))",
    ),
}
"""The formula of each chain in each scope, which is the same in both editions."""

FORMULAS: dict[tuple[Pattern, Scope], tuple[str, str]] = {
    **_TWO_EDITIONS,
    **{
        (chain, scope): (text, text)
        for chain, texts in _CHAINS.items()
        for scope, text in zip(Scope, texts, strict=True)
    },
}
"""The formula of each pattern in each scope, in the first and in the second edition."""


class UndefinedError(ValueError):
    """The encoding does not define such a sentence; the message says why."""


def formula(pattern: Pattern, scope: Scope, edition: int, **meaning: Formula) -> Formula:
    """The published formula, with `meaning` for its letters."""
    text = FORMULAS[pattern, scope][edition - 1]
    return parse_equation(Source(f"edition {edition}", text), Span(0, len(text)), LETTERS, LETTERS).of(meaning)


def _pattern_of(body: Formula) -> tuple[Pattern, Formula]:
    """The pattern that an encoded body is, and its p. Raises UndefinedError."""
    match body:
        case ltl.Not(ltl.Until(ltl.Truth(), ltl.Not(ltl.Not(p)))) if is_propositional(p):
            return Pattern.ABSENCE, p
        case ltl.Not(ltl.Until(ltl.Truth(), ltl.Not(p))) if is_propositional(p):
            return Pattern.UNIVERSALITY, p
        case ltl.Until(ltl.Truth(), p) if is_propositional(p):
            return Pattern.EXISTENCE, p
    raise UndefinedError("the patterns have formulas only for `always`, `never` and `eventually` of a state predicate")


def _encoding(edition: int, closing: Scope) -> Encoding:
    def after(opening: Formula, body: Formula) -> Formula:
        pattern, p = _pattern_of(body)
        return formula(pattern, Scope.AFTER, edition, p=p, q=opening)

    def before(event: Formula, body: Formula) -> Formula:
        pattern, p = _pattern_of(body)
        return formula(pattern, Scope.BEFORE, edition, p=p, r=event)

    def between(opening: Formula, end: Formula, body: Formula) -> Formula:
        pattern, p = _pattern_of(body)
        return formula(pattern, closing, edition, p=p, q=opening, r=end)

    which = "first" if edition == 1 else "second"
    suffix = "-between" if closing is Scope.BETWEEN else ""
    description = f"specification patterns, {which} edition, as published; after_until is their `{closing.value}`"
    return Encoding(f"dwyer-{edition}{suffix}", description, after, before, between)


PUBLISHED = {
    encoding.name: encoding
    for encoding in (_encoding(edition, scope) for scope in (Scope.AFTER_UNTIL, Scope.BETWEEN) for edition in (1, 2))
}
"""The patterns' editions as encodings, by name."""
