"""Reading certificates: any text gives certificates or the line that is wrong, in bounded time, without recursion."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NoReturn

from ltlc.semantics import ltl, properties
from ltlc.semantics.certificate import Certificate, Level
from ltlc.semantics.certificate_text import HEADER, PROPERTY_WORDS, Entry, is_name
from ltlc.semantics.encodings import ENCODINGS
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Decision, Monitor, Target
from ltlc.semantics.properties import Property
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Letter

LARGEST_FORMULA = 100_000
"""Nodes of a formula written out as a tree."""
MOST_TEMPORAL = 5_000
"""Different next and until formulas of one property."""
DEEPEST_PROPERTY = 40
DEEPEST_PREDICATE = 300
LARGEST_ENCODING = 1_000_000
"""A bound on the nodes of the formulas that a property and its parts are encoded as."""
LARGEST_TASK = 500_000_000
"""A bound on the work of evaluating witnesses, and of comparing dead formulas, for one property."""


class UnreadableError(Exception):
    """A line that is not as a certificate demands."""

    def __init__(self, line: int, message: str) -> None:
        super().__init__(f"line {line}: {message}")
        self.line = line
        self.message = message


@dataclass(slots=True)
class _Draft:
    """What has been read of one entry."""

    label: str
    line: int | None = None
    encoding: str | None = None
    atoms: list[str] = field(default_factory=list)
    formulas: list[Formula] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    heights: list[int] = field(default_factory=list)
    temporal: int = 0
    properties: list[Property] = field(default_factory=list)
    depths: list[int] = field(default_factory=list)
    bounds: list[int] = field(default_factory=list)
    subject: int | None = None
    formula: int | None = None
    assumption: int | None = None
    verdicts: list[Verdict] = field(default_factory=list)
    edges: list[Target] = field(default_factory=list)
    annotations: list[list[int]] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    levels: list[tuple[list[int], int | None]] = field(default_factory=list)
    witnesses: dict[int, list[Lasso]] = field(default_factory=dict)


def parse(text: str) -> tuple[Entry, ...]:
    """The certificates in `text`. Raises UnreadableError, and nothing else."""
    return _Reader().read(text)


_NUMBER = re.compile(r"(0|[1-9][0-9]{0,8})")
_PART = re.compile(r"([afpqd])(0|[1-9][0-9]{0,8})")
_LETTER = re.compile(r"\{(a[0-9]{1,9}(,a[0-9]{1,9})*)?\}")
_STAGES = tuple("property line encoding a f p subject formula assumption q d dead witness end".split())  # noqa: SIM905
_ONCE = ("line", "encoding", "subject", "formula", "assumption")
_VERDICTS = {v.value: v for v in Verdict if v is not Verdict.NOT_STARTED}
_PROPERTIES = {word: kind for kind, word in PROPERTY_WORDS.items()}
_CONNECTIVES: dict[str, tuple[Callable[..., Formula], int]] = {
    "not": (ltl.Not, 1),
    "next": (ltl.Next, 1),
    "and": (ltl.And, 2),
    "or": (ltl.Or, 2),
    "until": (ltl.Until, 2),
}
_EVENTS: dict[type[Property], int] = {
    properties.Now: 1,
    properties.Throughout: 1,
    properties.After: 1,
    properties.Until: 1,
    properties.AfterUntil: 2,
}
"""How many of the parts of a kind of property are state predicates or events, and come first."""


class _Reader:
    def __init__(self) -> None:
        self.number = 0
        self.entries: list[Entry] = []
        self.draft: _Draft | None = None
        self.stage = ""

    def fail(self, message: str) -> NoReturn:
        raise UnreadableError(self.number, message)

    def read(self, text: str) -> tuple[Entry, ...]:
        """Every line in turn; the first two say what the text is and how many entries it has."""
        expected: int | None = None
        started = False
        for self.number, line in enumerate(text.split("\n"), start=1):
            words = line.split(" ")
            if line.startswith("#") or not line:
                continue
            if not started:
                started = line == HEADER or self.fail(f"a certificate starts with '{HEADER}'")
            elif expected is None:
                expected = self.count(words[1]) if words[0] == "properties" and len(words) == 2 else None
                if expected is None:
                    self.fail("the second line says 'properties' and how many")
            else:
                self.item(line, words)
        if self.draft is not None or expected is None:
            self.fail("the text ends in the middle of a certificate")
        if len(self.entries) != expected:
            self.fail(f"there are {len(self.entries)} properties, not {expected}")
        return tuple(self.entries)

    def item(self, line: str, words: list[str]) -> None:
        """One line of an entry."""
        part = _PART.fullmatch(words[0])
        kind = part[1] if part else words[0]
        if kind not in _STAGES or (kind in ("a", "f", "p", "q", "d") and part is None):
            self.fail(f"'{words[0][:40]}' starts no line of a certificate")
        if self.draft is None:
            if kind != "property":
                self.fail("a property starts with 'property'")
            self.draft, self.stage = _Draft(self.name(line, "property")), kind
            return
        if kind == "property" or _STAGES.index(kind) < _STAGES.index(self.stage):
            self.fail(f"'{words[0]}' comes too late")
        if kind in _ONCE and kind == self.stage:
            self.fail(f"a second '{kind}'")
        self.stage = kind
        getattr(self, f"read_{kind}")(self.draft, line, words)

    def name(self, line: str, keyword: str) -> str:
        """The rest of a line, after its keyword."""
        name = line[len(keyword) + 1 :]
        return name if is_name(name) else self.fail("a name is missing, or has blanks around it or control characters")

    def count(self, word: str) -> int:
        """A number."""
        return int(word) if _NUMBER.fullmatch(word) else self.fail(f"'{word[:40]}' is not a number")

    def refer(self, word: str, sort: str, count: int) -> int:
        """The number in a reference to something of a sort, of which there are `count`."""
        part = _PART.fullmatch(word)
        if part is None or part[1] != sort or int(part[2]) >= count:
            self.fail(
                f"'{word[:40]}' is not one of {sort}0 … {sort}{count - 1}" if count else f"there is no '{word[:40]}'"
            )
        return int(part[2])

    def next_number(self, word: str, count: int) -> None:
        """Things of a sort are numbered in order."""
        if int(word[1:]) != count:
            self.fail(f"'{word}' should be {word[0]}{count}")

    def arguments(self, words: list[str], count: int) -> list[str]:
        """What follows on the line, as many words as `count`."""
        return (
            words
            if len(words) == count
            else self.fail(f"'{words[0][:40] if words else ''}': expected {count} parts here")
        )

    def formula_numbers(self, draft: _Draft, words: list[str]) -> list[int]:
        return [self.refer(word, "f", len(draft.formulas)) for word in words]

    def read_line(self, draft: _Draft, _: str, words: list[str]) -> None:
        draft.line = self.count(self.arguments(words, 2)[1])

    def read_encoding(self, draft: _Draft, _: str, words: list[str]) -> None:
        draft.encoding = self.arguments(words, 2)[1]
        if draft.encoding not in ENCODINGS:
            self.fail(f"no encoding is called '{draft.encoding[:40]}'")

    def read_a(self, draft: _Draft, line: str, words: list[str]) -> None:
        self.next_number(words[0], len(draft.atoms))
        draft.atoms.append(self.name(line, words[0]))

    def read_f(self, draft: _Draft, _: str, words: list[str]) -> None:
        self.next_number(words[0], len(draft.formulas))
        size, height = 1, 1
        if words[1:] == ["true"]:
            draft.formulas.append(ltl.TRUE)
        elif len(words) == 2:
            draft.formulas.append(ltl.Atom(draft.atoms[self.refer(words[1], "a", len(draft.atoms))]))
        else:
            make, count = _CONNECTIVES.get(words[1], (None, 0)) if len(words) > 1 else (None, 0)
            if make is None:
                self.fail("a formula is true, an atom, or not, next, and, or, until of formulas")
            parts = self.formula_numbers(draft, self.arguments(words[2:], count))
            draft.formulas.append(make(*(draft.formulas[part] for part in parts)))
            size += sum(draft.sizes[part] for part in parts)
            height += max(draft.heights[part] for part in parts)
        draft.temporal += words[1] in ("next", "until")
        if size > LARGEST_FORMULA or draft.temporal > MOST_TEMPORAL:
            self.fail("the formula is too large")
        draft.sizes.append(size)
        draft.heights.append(height)

    def read_p(self, draft: _Draft, _: str, words: list[str]) -> None:
        self.next_number(words[0], len(draft.properties))
        kind = _PROPERTIES.get(words[1]) if len(words) > 1 else None
        if kind is None:
            self.fail("not a kind of property")
        events = _EVENTS.get(kind, 0)
        bodies = 2 if kind in (properties.And, properties.Or, properties.Implies) else 1
        if kind in (properties.Now, properties.Throughout):
            bodies = 0
        parts = self.arguments(words[2:], events + bodies)
        predicates = self.formula_numbers(draft, parts[:events])
        below = [self.refer(word, "p", len(draft.properties)) for word in parts[events:]]
        draft.depths.append(1 + max((draft.depths[number] for number in below), default=0))
        draft.bounds.append(_bound(kind, [draft.sizes[n] for n in predicates], [draft.bounds[n] for n in below]))
        deepest = max((draft.heights[number] for number in predicates), default=0)
        if draft.depths[-1] > DEEPEST_PROPERTY or deepest > DEEPEST_PREDICATE or sum(draft.bounds) > LARGEST_ENCODING:
            self.fail("the property is too large")
        try:
            formulas = [draft.formulas[number] for number in predicates]
            draft.properties.append(kind(*formulas, *(draft.properties[number] for number in below)))
        except ValueError:
            self.fail("a state predicate must not contain next or until")

    def read_subject(self, draft: _Draft, _: str, words: list[str]) -> None:
        draft.subject = self.refer(self.arguments(words, 2)[1], "p", len(draft.properties))

    def read_formula(self, draft: _Draft, _: str, words: list[str]) -> None:
        draft.formula = self.refer(self.arguments(words, 2)[1], "f", len(draft.formulas))

    def read_assumption(self, draft: _Draft, _: str, words: list[str]) -> None:
        draft.assumption = self.refer(self.arguments(words, 2)[1], "f", len(draft.formulas))
        if not ltl.is_propositional(draft.formulas[draft.assumption]):
            self.fail("an assumption must not contain next or until")

    def read_q(self, draft: _Draft, _: str, words: list[str]) -> None:
        self.next_number(words[0], len(draft.verdicts))
        if len(words) < 3 or words[1] not in _VERDICTS or words[3:4] not in ([], ["remains"]) or len(words) == 4:
            self.fail("a state has a verdict, the state or decision that follows, and 'remains' with formulas")
        draft.verdicts.append(_VERDICTS[words[1]])
        draft.edges.append(self.target(words[2]))
        draft.annotations.append(self.formula_numbers(draft, words[4:]))

    def target(self, word: str) -> Target:
        """A state or a decision that may come later; `complete` looks whether it does."""
        part = _PART.fullmatch(word)
        if part is None or part[1] not in ("q", "d"):
            self.fail(f"'{word[:40]}' is not a state or a decision")
        return int(part[2]) if part[1] == "q" else ~int(part[2])

    def read_d(self, draft: _Draft, _: str, words: list[str]) -> None:
        self.next_number(words[0], len(draft.decisions))
        if len(words) != 6 or words[2] != "then" or words[4] != "else":
            self.fail("a decision reads: d0 a0 then q1 else q2")
        atom = self.refer(words[1], "a", len(draft.atoms))
        draft.decisions.append(Decision(atom, self.target(words[5]), self.target(words[3])))

    def read_dead(self, draft: _Draft, _: str, words: list[str]) -> None:
        eventuality = None
        members = words[1:]
        if words[-2:-1] == ["never"]:
            members = words[1:-2]
            eventuality = self.refer(words[-1], "f", len(draft.formulas))
            if not isinstance(draft.formulas[eventuality], ltl.Until):
                self.fail("what never happens must be an until formula")
        draft.levels.append((self.formula_numbers(draft, members), eventuality))

    def read_witness(self, draft: _Draft, _: str, words: list[str]) -> None:
        if len(words) < 4 or words.count("loop") != 1 or words[-1] == "loop":
            self.fail("a witness has a state, letters, 'loop' and letters")
        state = self.refer(words[1], "q", len(draft.verdicts))
        middle = words.index("loop")
        letters = [self.letter(draft, word) for word in [*words[2:middle], *words[middle + 1 :]]]
        word = Lasso(tuple(letters[: middle - 2]), tuple(letters[middle - 2 :]))
        draft.witnesses.setdefault(state, []).append(word)

    def letter(self, draft: _Draft, word: str) -> Letter:
        """A letter: the atoms that hold, in braces."""
        if not _LETTER.fullmatch(word):
            self.fail(f"'{word[:40]}' is not a letter: {{a0,a2}}")
        names = word[1:-1].split(",") if len(word) > 2 else []
        return frozenset(draft.atoms[self.refer(name, "a", len(draft.atoms))] for name in names)

    def read_end(self, draft: _Draft, _: str, words: list[str]) -> None:
        self.arguments(words, 1)
        self.complete(draft)
        assert draft.line is not None
        assert draft.encoding is not None
        assert draft.subject is not None
        assert draft.formula is not None
        assert draft.assumption is not None
        formulas = draft.formulas
        certificate = Certificate(
            formulas[draft.formula],
            formulas[draft.assumption],
            Monitor(tuple(draft.atoms), tuple(draft.verdicts), tuple(draft.edges), tuple(draft.decisions)),
            tuple(tuple(formulas[n] for n in numbers) for numbers in draft.annotations),
            tuple(
                Level(_until(formulas, eventuality), tuple(formulas[n] for n in members))
                for members, eventuality in draft.levels
            ),
            tuple(tuple(draft.witnesses.get(state, [])) for state in range(len(draft.verdicts))),
        )
        subject = draft.properties[draft.subject]
        self.entries.append(Entry(draft.label, draft.line, subject, draft.encoding, certificate))
        self.draft = None

    def complete(self, draft: _Draft) -> None:
        """Whether all is there, and not too large to be checked."""
        for keyword in _ONCE:
            if getattr(draft, keyword) is None:
                self.fail(f"the property has no '{keyword}'")
        if not draft.verdicts:
            self.fail("the property has no state")
        if len(set(draft.atoms)) < len(draft.atoms):
            self.fail("two atoms have one name")
        targets = [*draft.edges, *(t for decision in draft.decisions for t in (decision.low, decision.high))]
        for target in targets:
            if target >= len(draft.verdicts) or ~target >= len(draft.decisions):
                self.fail(f"there is no {f'q{target}' if target >= 0 else f'd{~target}'}")
        if _task(draft) > LARGEST_TASK:
            self.fail("the certificate is too large to be checked")


def _until(formulas: list[Formula], number: int | None) -> ltl.Until | None:
    found = None if number is None else formulas[number]
    assert found is None or isinstance(found, ltl.Until)
    return found


def _bound(kind: type[Property], predicates: list[int], bodies: list[int]) -> int:
    """A bound on the nodes of the encoding of a property, from the sizes of its predicates and its bodies' bounds."""
    if kind is properties.AfterUntil:
        opening, closing = predicates
        return 2 * (2 * (opening + closing) + bodies[0] * (2 * closing + 6) + 14) + closing + 10
    if kind in (properties.After, properties.Until):
        return 2 * predicates[0] + bodies[0] * (2 * predicates[0] + 6) + 12
    return sum(predicates) + sum(bodies) + 6


def _task(draft: _Draft) -> int:
    """About how much evaluation the certificate asks for, beyond what the checker counts itself."""
    task = 0
    for state, numbers in enumerate(draft.annotations):
        annotated = sum(draft.sizes[number] for number in numbers) + 1
        positions = [len(word.stem) + len(word.loop) for word in draft.witnesses.get(state, [])]
        assert draft.assumption is not None
        task += annotated + sum(n * n * (annotated + draft.sizes[draft.assumption]) for n in positions)
    dead = [number for members, _ in draft.levels for number in members]
    return task + (len(dead) + len(draft.levels)) * sum(draft.sizes[number] + 1 for number in dead)
