"""How often the four encodings part, on sentences with a scope, and how long a comparison takes.

`python -m benchmarks.encodings`: each scope keyword around each of eight bodies, with events that exclude each other
and with events that do not; all four encodings, all pairs, infinite and finite runs.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator
from functools import partial

from ltlc.analysis.comparison.answer import answer
from ltlc.analysis.comparison.results import Answer, Candidate, Question, Related, Runs, SeparatingRun
from ltlc.automata import Budget
from ltlc.semantics.alphabet import Alphabet, Group
from ltlc.semantics.denotation import READINGS, satisfies
from ltlc.semantics.encodings import ENCODINGS, encode
from ltlc.semantics.ltl import Atom
from ltlc.semantics.properties import (
    After,
    AfterUntil,
    Always,
    And,
    Eventually,
    Implies,
    Never,
    Now,
    Property,
    Throughout,
    Until,
)

P, S, X, Y = (Atom(name) for name in ("p", "s", "x", "y"))

BODIES: dict[str, Property] = {
    "p": Throughout(P),
    "never p": Never(Now(P)),
    "eventually p": Eventually(Now(P)),
    "always (p implies eventually s)": Always(Implies(Now(P), Eventually(Now(S)))),
    "(never p) and (eventually s)": And(Never(Now(P)), Eventually(Now(S))),
    "after s, never p": After(S, Never(Now(P))),
    "until s, eventually p": Until(S, Eventually(Now(P))),
    "after_until s, p, eventually x": AfterUntil(S, P, Eventually(Now(X))),
}


def questions() -> Iterator[Question]:
    exclusive = Group(("x", "y"), (frozenset(), frozenset("x"), frozenset("y")))
    for groups in ((), (exclusive,)):
        alphabet = Alphabet(("x", "y", "p", "s"), groups)
        for name, body in BODIES.items():
            for keyword, sentence in (
                ("after x", After(X, body)),
                ("until x", Until(X, body)),
                ("after_until x, y", AfterUntil(X, Y, body)),
            ):
                yield question(f"{keyword}, {name}", sentence, alphabet)


def question(text: str, sentence: Property, alphabet: Alphabet) -> Question:
    candidates = tuple(
        Candidate(name, encode(sentence, encoding), partial(satisfies, property_=sentence, reading=READINGS[name]))
        for name, encoding in ENCODINGS.items()
    )
    return Question(text, None, text, alphabet, alphabet, candidates)


def main() -> None:
    asked = list(questions())
    start = time.perf_counter()
    answers = answer(asked, Budget(seconds=60.0))
    seconds = time.perf_counter() - start
    print(f"{len(asked)} sentences in {seconds:.1f} s, {1000 * seconds / len(asked):.0f} ms each\n")
    report(answers)


def report(answers: list[Answer]) -> None:
    relations: dict[tuple[str, str], Counter[str]] = {}
    lengths: Counter[int] = Counter()
    runs = 0
    for each in answers:
        for comparison in each.comparisons:
            for kind in Runs:
                related = comparison.related[kind]
                assert isinstance(related, Related), related
                relations.setdefault((comparison.left, comparison.right), Counter())[related.relation.value] += 1
                lengths.update(len(run.letters) for run in separating(related))
                runs += related.confirmation.runs
    names = ("equivalent", "stronger", "weaker", "incomparable")
    print("| left | right |", " | ".join(names), "|\n|---|---|---|---|---|---|")
    for (left, right), counted in relations.items():
        print(f"| `{left}` | `{right}` |", " | ".join(str(counted[name]) for name in names), "|")
    print("\nshortest separating runs by number of steps:", dict(sorted(lengths.items())))
    print(f"runs judged by the reference interpreters: {runs:,}")


def separating(related: Related) -> list[SeparatingRun]:
    return [run for run in (related.left_only, related.right_only) if run is not None]


if __name__ == "__main__":
    main()
