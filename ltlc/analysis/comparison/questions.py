"""What is compared: the sentences of a specification under several encodings, or formulas as they are given."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from itertools import count
from typing import TYPE_CHECKING

from ltlc.analysis.comparison.published import PUBLISHED, UndefinedError
from ltlc.analysis.comparison.results import Candidate, Question, Values
from ltlc.analysis.comparison.timed import satisfies_in_time
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.denotation import READINGS, satisfies
from ltlc.semantics.durations import duration_text
from ltlc.semantics.encodings import ENCODINGS, Encoding, ManyClocksError, encode, reads_time
from ltlc.semantics.ltl import Formula, atoms, children, conjunction, is_next_free
from ltlc.semantics.words import Letter, Word
from ltlc.specification.atoms import Atom
from ltlc.specification.specification import PropertySpecification, Specification

if TYPE_CHECKING:
    from ltlc.analysis.letters import Letters

MOST_NODES = 20_000
"""A larger formula of core LTL is not written out."""

KNOWN: Mapping[str, Encoding] = {**ENCODINGS, **PUBLISHED}
"""The encodings that come with ltlc, by name: the four of the language, then the published ones."""


def questions_of(specification: Specification, encodings: Sequence[Encoding]) -> list[Question]:
    """A question for each property: how its `encodings` relate."""
    return [_question(property_, encodings) for property_ in specification.properties]


def _question(property_: PropertySpecification, encodings: Sequence[Encoding]) -> Question:
    candidates, undefined = [], {}
    for encoding in encodings:
        try:
            formula = encode(property_.property, _bounded(encoding))
            _check_time(property_, formula)
        except UndefinedError as error:
            undefined[encoding.name] = str(error)
            continue
        except ManyClocksError as error:
            bound = duration_text(error.bound.duration)
            undefined[encoding.name] = f"it begins the {bound} anew at each step, which no single clock can measure"
            continue
        candidates.append(Candidate(encoding.name, formula, _reading(property_, encoding)))
    letters = _letters(property_)
    return Question(
        property_.label,
        property_.line,
        property_.text,
        property_.alphabet,
        letters.alphabet(property_.alphabet.atoms),
        tuple(candidates),
        undefined,
        lru_cache(partial(_values, property_, letters)),
    )


def _check_time(property_: PropertySpecification, formula: Formula) -> None:
    """Raise UndefinedError for a formula about the next step, where time passes between steps."""
    if reads_time(property_.property) and not is_next_free(formula):
        raise UndefinedError("it refers to the next step, but the property to time, which passes between steps")


def _letters(property_: PropertySpecification) -> Letters:
    """The letters that the numbers allow, with values that make them."""
    from ltlc.analysis.letters import letters_of, with_messages

    def solve(atoms: Sequence[Atom]) -> list[Letter] | None:
        from ltlc.analysis import solving  # brings z3 along

        return solving.valuations(atoms)

    return with_messages(letters_of([property_.atoms], solve), property_.messages(), is_rated=False)


def _bounded(encoding: Encoding) -> Encoding:
    """`encoding`, undefined where a formula grows too large: scopes inside scopes multiply it."""

    def checked(formula: Formula) -> Formula:
        if _tree_size(formula, {}) > MOST_NODES:
            raise UndefinedError(f"its formula has more than {MOST_NODES:,} nodes")
        return formula

    return replace(
        encoding,
        after=lambda event, body: checked(encoding.after(event, body)),
        until=lambda event, body: checked(encoding.until(event, body)),
        after_until=lambda opening, closing, body: checked(encoding.after_until(opening, closing, body)),
    )


def _tree_size(formula: Formula, known: dict[int, int]) -> int:
    """As `size`, but counting what is shared inside `formula` once and adding it up."""
    if id(formula) not in known:
        known[id(formula)] = 1 + sum(_tree_size(child, known) for child in children(formula))
    return known[id(formula)]


def _reading(property_: PropertySpecification, encoding: Encoding) -> Callable[[Word], bool] | None:
    """What the sentence means on finite words under `encoding`, if that is known."""
    reading = READINGS.get(encoding.name)
    if reading is None:
        return None
    judge = satisfies_in_time if reads_time(property_.property) else satisfies
    return partial(judge, property_=property_.property, reading=reading)


def _values(
    property_: PropertySpecification, letters: Letters, word: Word, loop: int | None
) -> tuple[Values, ...] | None:
    """Values of the signals of `property_` that give the letters of `word`, if they are found."""
    from ltlc.analysis.examples import Setting, values_of

    setting = Setting(property_.atoms, letters, False, property_.openings(), bool(property_.counts()))
    found = values_of(setting, word, loop)
    return None if found is None else tuple(found)


def unused_name(name: str, taken: Collection[str]) -> str:
    """`name`, or `name (2)` and so on where it is taken."""
    numbered = (f"{name} ({number})" for number in count(2))
    return name if name not in taken else next(other for other in numbered if other not in taken)


def question_of_formulas(label: str, line: int | None, formulas: Mapping[str, Formula]) -> Question:
    """The question how `formulas`, by name, relate; their atoms are free."""
    alphabet = Alphabet(atoms(conjunction(formulas.values())))
    candidates = tuple(Candidate(name, formula) for name, formula in formulas.items())
    return Question(label, line, " / ".join(formulas), alphabet, alphabet, candidates)
