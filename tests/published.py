"""What others have published in linear temporal logic, beside sentences of ours: how the two relate, in words."""

from __future__ import annotations

import re
from collections.abc import Iterator

from language_support import compiled

from ltlc.analysis.comparison.reference import shown
from ltlc.analysis.comparison.shortest import shortest_lasso
from ltlc.automata import queries
from ltlc.automata.spot_syntax import parse
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, atoms, conjunction, globally, implies, renamed
from ltlc.semantics.words import Lasso

LETTERS = ("l1", "l2", "l3", "m", "p", "q", "r", "s")
PLACES = frozenset(("l1", "l2", "l3"))
DECLARED = "".join(f"decl {letter} /{letter} Bool.data\n" for letter in LETTERS)

_LOOKS_BACK = re.compile(r"(previously|once|@\{)(?: ?new)? ?(\w+)(?:, -1\})?")


def equivalent(left: Formula, right: Formula) -> Formula:
    return And(implies(left, right), implies(right, left))


def relation(published: str, sentence: str, apart: frozenset[str] = PLACES) -> str:
    """How the infinite runs of the formula `published`, in Spot's syntax, relate to those of `sentence`, in words.

    At one step, at most one of the letters `apart` holds. A sentence about the past is read where each instant is a
    step; one with `@{p, -1}` has its first step at the second of the run. `new p` is a letter like others.
    """
    (property_,) = compiled(DECLARED + sentence).properties
    ours = encode(property_.property, EPISODE)
    ours = renamed(ours, {name: name.removeprefix("new ") for name in atoms(ours)})
    known = conjunction(_known(ours))
    begins_later = any(name.startswith("@") for name in atoms(ours))
    theirs, ours = And(parse(published), known), And(Next(ours) if begins_later else ours, known)
    return _in_words(theirs, ours, _alphabet(And(theirs, ours), apart))


def _known(formula: Formula) -> Iterator[Formula]:
    """What the atoms of `formula` that look back have to do with those that they look back at."""
    for name in atoms(formula):
        if not (found := _LOOKS_BACK.fullmatch(name)):
            continue
        now, then = Atom(found[2]), Atom(name)
        if found[1] == "once":
            yield equivalent(then, now)
            yield globally(equivalent(Next(then), Or(then, Next(now))))
            continue
        yield globally(equivalent(Next(then), now))
        if found[1] == "previously":
            yield Not(then)


def _in_words(theirs: Formula, ours: Formula, alphabet: Alphabet) -> str:
    found = {"the formula": _only(theirs, ours, alphabet), "ours": _only(ours, theirs, alphabet)}
    told = [f"only {who} accepts `{shown(_without_past(run))}`" for who, run in found.items() if run]
    stays = [globally(implies(Atom(p), Next(Not(Atom(p))))) for p in alphabet.atoms if p in PLACES]
    theirs, ours = (conjunction([formula, *stays]) for formula in (theirs, ours))
    if told and queries.implies(theirs, ours, alphabet) and queries.implies(ours, theirs, alphabet):
        told.append("the same where no stay lasts two steps")
    return "; ".join(told) or "the same"


def _only(left: Formula, right: Formula, alphabet: Alphabet) -> Lasso | None:
    """A shortest infinite run that satisfies `left` and not `right`, if there is one."""
    difference = And(left, Not(right))
    if not queries.is_satisfiable(difference, alphabet):
        return None
    run = shortest_lasso(queries.buchi(difference, alphabet))
    assert run is not None
    assert holds_on_lasso(left, run)
    assert not holds_on_lasso(right, run)
    return run


def _without_past(run: Lasso) -> Lasso:
    stem, loop = (tuple(letter.intersection(LETTERS) for letter in part) for part in (run.stem, run.loop))
    return Lasso(stem, loop)


def _alphabet(formula: Formula, apart: frozenset[str]) -> Alphabet:
    used = tuple(sorted(atoms(formula)))
    group = tuple(name for name in used if name in apart)
    valuations = (frozenset[str](), *(frozenset((name,)) for name in group))
    return Alphabet(used, (Group(group, valuations),) if group else ())
