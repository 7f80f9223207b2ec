"""Ways to get a study, what the analyses are asked about, without a file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from ltlc.analysis.letters import Letters
from ltlc.analysis.subjects import Study, Subject
from ltlc.automata import translate
from ltlc.base.source import Source, Span
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.encodings import EPISODE, encode
from ltlc.semantics.ltl import Formula
from ltlc.semantics.properties import Property
from ltlc.semantics.timed_atoms import TimedAtom, atoms_within, news_of
from ltlc.semantics.words import Lasso, Word, all_words
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import Comparison, Current, Field, IsTrue, New, Number, Relation, Signal, ValueType
from ltlc.specification.specification import PropertySpecification, Specification, parts


def number(name: str) -> Current:
    """The latest sample of a number on a topic of its own."""
    return Current(Signal(name, ValueType.NUMBER, Field(f"/{name}", "std_msgs/msg/Float64", ("data",))))


def news(name: str) -> Atom:
    """The atom of a `new s`."""
    return Atom(name, IsTrue(New(number(name.removeprefix("new ")).signal)), Span(0, 0))


def study(alphabet: Alphabet, *properties: Property) -> Study:
    """A study of `properties` over the letters of `alphabet`, as if each atom `a` were `a > 0`."""
    source = Source("props.txt", "x" * len(properties))
    known = {a: Atom(a, Comparison(number(a), Relation.GREATER, Number(0.0)), Span(0, 0)) for a in alphabet.atoms}
    subjects = []
    for n, each in enumerate(properties):
        formula = encode(each, EPISODE)
        used = [atom.name for atom in atoms_within(formula) if not isinstance(atom, TimedAtom)]
        known |= {a.name: news(a.name) for a in news_of(formula)}
        own = (*(known[a] for a in used), *(known[a.name] for a in news_of(formula)))
        spans = dict.fromkeys(paths(each), Span(n, n + 1))
        restricted = alphabet.restricted_to(used)
        stated = PropertySpecification(f"p{n}", 1, Span(n, n + 1), str(n), each, own, restricted, spans)
        subjects.append(Subject(n, stated, formula, restricted, translate(formula, restricted)))
    specification = Specification(source, tuple(s.specification for s in subjects), ())
    return Study(specification, EPISODE, Letters(tuple(known.values()), alphabet.groups, {}), tuple(subjects), {})


def paths(node: Property | Formula, path: tuple[int, ...] = ()) -> Iterator[tuple[int, ...]]:
    """The way to each part of a property."""
    yield path
    for index, part in enumerate(parts(node)):
        yield from paths(part, (*path, index))


def short_words(alphabet: Alphabet, longest: int) -> list[Word]:
    """Every word of existing letters, not empty, up to a length."""
    letters = list(alphabet.letters())
    return list(chain.from_iterable(all_words(letters, length) for length in range(1, longest + 1)))


def short_lassos(alphabet: Alphabet, longest: int) -> list[Lasso]:
    """Every lasso word of existing letters with at most so many different steps."""
    return [Lasso(word[:k], word[k:]) for word in short_words(alphabet, longest) for k in range(len(word))]


def names(findings: Sequence[object]) -> list[str]:
    """The codes of what was found."""
    return [finding.code for finding in findings]  # type: ignore[attr-defined]
