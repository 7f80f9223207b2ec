"""Reading certificates: any text gives certificates or the line that is wrong, in bounded time, without recursion."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NoReturn

from ltlc.semantics import ltl, properties
from ltlc.semantics.certificate import Progress
from ltlc.semantics.certificate_draft import (
    DEEPEST_PREDICATE,
    DEEPEST_PROPERTY,
    LARGEST_ENCODING,
    ONCE,
    Draft,
    Spot,
    bound_of,
)
from ltlc.semantics.certificate_text import BEGUN, HEADER, PROPERTY_WORDS, TIMED_WORDS, Defined, Entry, is_name
from ltlc.semantics.certificate_words import (
    PART,
    VERDICTS,
    WrongError,
    arguments,
    duration,
    later,
    natural,
    next_number,
    refer,
)
from ltlc.semantics.control_text import PROGRAM_KINDS, Parts
from ltlc.semantics.encodings import ENCODINGS
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Decision
from ltlc.semantics.properties import Property
from ltlc.semantics.reset_machine import Clocks
from ltlc.semantics.timed_atoms import Age, News, Previously, Since
from ltlc.semantics.trackers import Phase, State
from ltlc.semantics.words import Lasso, Letter


class UnreadableError(Exception):
    """A line that is not as a certificate demands."""

    def __init__(self, line: int, message: str) -> None:
        super().__init__(f"line {line}: {message}")
        self.line = line
        self.message = message


def parse(text: str) -> tuple[Entry, ...]:
    """The certificates in `text`. Raises UnreadableError, and nothing else."""
    return _Reader().read(text)


_LETTER = re.compile(r"\{(a[0-9]{1,9}(,a[0-9]{1,9})*)?\}")
_STAGES = tuple("property line encoding a f p subject formula assumption k q d dead witness c s b o pair end".split())  # noqa: SIM905
_PROPERTIES: dict[str, Callable[..., Property]] = {word: kind for kind, word in PROPERTY_WORDS.items()}
_DEFINITIONS: dict[str, Callable[..., Defined]] = {word: kind for kind, word in TIMED_WORDS.items()}
_OPERANDS: dict[Callable[..., Defined], int] = {News: 0, Since: 2}
"""How many state predicates define an atom of a kind; of all other kinds, one."""
_PHASES = {phase.value: phase for phase in Phase}
_CONNECTIVES: dict[str, tuple[Callable[..., Formula], int]] = {
    "not": (ltl.Not, 1),
    "next": (ltl.Next, 1),
    "and": (ltl.And, 2),
    "or": (ltl.Or, 2),
    "until": (ltl.Until, 2),
}
_EVENTS: dict[Callable[..., Property], int] = {
    properties.Now: 1,
    properties.Throughout: 1,
    properties.After: 1,
    properties.Until: 1,
    properties.AfterUntil: 2,
}
"""How many of the parts of a kind of property are state predicates or events, and come first."""


def clocks_of_words(words: list[str]) -> Clocks:
    """A state of the clocks, as `clocks_in_words` has it. Raises WrongError."""
    if words[:1] not in (["read"], ["unread"]):
        raise WrongError("a state of the clocks says 'read' or 'unread' first")
    states: list[State] = []
    begun: set[int] = set()
    rest = iter(words[1:])
    for word in rest:
        phase = Phase.RUNNING if word == BEGUN else _PHASES.get(word)
        if phase is None:
            raise WrongError(f"'{word[:40]}' is not what a clock can do: {', '.join((*_PHASES, BEGUN))}")
        if word == BEGUN:
            begun.add(len(states))
        states.append(State(phase, natural(next(rest, "")) if word == Phase.RUNNING.value else 0))
    return Clocks(words[0] == "unread", tuple(states), frozenset(begun))


class _Reader:
    def __init__(self) -> None:
        self.number = 0
        self.entries: list[Entry] = []
        self.draft: Draft | None = None
        self.stage = ""
        self.guards = 0
        self.in_guard = False

    def fail(self, message: str) -> NoReturn:
        raise UnreadableError(self.number, message)

    def read(self, text: str) -> tuple[Entry, ...]:
        """Every line in turn; the first two say what the text is and how many entries it has.

        Those of guards, which come last, are only counted here: `region_reader` reads them.
        """
        expected: tuple[int, int] | None = None
        started = False
        for self.number, line in enumerate(text.split("\n"), start=1):
            words = line.split(" ")
            if line.startswith("#") or not line:
                continue
            if not started:
                started = line == HEADER or self.fail(f"a certificate starts with '{HEADER}'")
                continue
            try:
                if expected is None:
                    expected = self.expected(words)
                elif self.in_guard or (self.draft is None and words[0] == "guard"):
                    self.in_guard = line != "end"
                    self.guards += line == "end"
                else:
                    self.item(line, words)
            except WrongError as error:
                self.fail(str(error))
        if self.draft is not None or self.in_guard or expected is None:
            self.fail("the text ends in the middle of a certificate")
        if (len(self.entries), self.guards) != expected:
            self.fail(f"there are {len(self.entries)} properties and {self.guards} guards, not as many as it says")
        return tuple(self.entries)

    def expected(self, words: list[str]) -> tuple[int, int]:
        """How many properties and guards there are."""
        if words[0] != "properties" or len(words) not in (2, 4) or words[2:3] not in ([], ["guards"]):
            self.fail("the second line says 'properties' and how many, then 'guards' and how many, if there are any")
        return natural(words[1]), natural(words[3]) if len(words) == 4 else 0

    def item(self, line: str, words: list[str]) -> None:
        """One line of an entry."""
        part = PART.fullmatch(words[0])
        kind = part[1] if part else words[0]
        stage = "f" if kind == "t" else kind
        if stage not in _STAGES or (len(kind) == 1 and part is None):
            self.fail(f"'{words[0][:40]}' starts no line of a certificate")
        if self.draft is None:
            if self.guards:
                self.fail("properties come before guards")
            if kind != "property":
                self.fail("a property starts with 'property'")
            self.draft, self.stage = Draft(self.name(line, "property")), stage
            return
        if kind == "property" or _STAGES.index(stage) < _STAGES.index(self.stage):
            self.fail(f"'{words[0]}' comes too late")
        if kind in ONCE and kind == self.stage:
            self.fail(f"a second '{kind}'")
        self.stage = stage
        getattr(self, f"read_{'program' if kind in PROGRAM_KINDS else kind}")(self.draft, line, words)

    def name(self, line: str, keyword: str) -> str:
        """The rest of a line, after its keyword."""
        name = line[len(keyword) + 1 :]
        return name if is_name(name) else self.fail("a name is missing, or has blanks around it or control characters")

    def formula_numbers(self, draft: Draft, words: list[str]) -> list[int]:
        return [refer(word, "f", len(draft.formulas)) for word in words]

    def read_line(self, draft: Draft, _: str, words: list[str]) -> None:
        draft.line = natural(arguments(words, 2)[1])

    def read_encoding(self, draft: Draft, _: str, words: list[str]) -> None:
        draft.encoding = arguments(words, 2)[1]
        if draft.encoding not in ENCODINGS:
            self.fail(f"no encoding is called '{draft.encoding[:40]}'")

    def read_a(self, draft: Draft, line: str, words: list[str]) -> None:
        next_number(words[0], len(draft.atoms))
        draft.atoms.append(ltl.Atom(self.name(line, words[0])))

    def read_t(self, draft: Draft, _: str, words: list[str]) -> None:
        next_number(words[0], len(draft.definitions))
        kind = _DEFINITIONS.get(words[2]) if len(words) > 2 else None
        if kind is None:
            self.fail(f"a definition has an atom, one of {', '.join(_DEFINITIONS)}, formulas and a duration")
        number = refer(words[1], "a", len(draft.atoms))
        count = _OPERANDS.get(kind, 1)
        operands = self.formula_numbers(draft, arguments(words[3 : 3 + count], count))
        durations = [duration(word) for word in words[3 + count :]]
        allowed = (1,) if kind is Age else (0,) if kind in (News, Previously) else (0, 1)
        if len(durations) not in allowed or (0 in durations and kind is not Age):
            self.fail("a duration is missing, too small or too many")
        formulas = [draft.formulas[operand] for operand in operands]
        if not all(map(ltl.is_propositional, formulas)) or (kind is Age and not isinstance(formulas[0], News)):
            self.fail("an age is that of news, any other timed atom is decided by state predicates")
        draft.define(number, kind(draft.atoms[number].name, *formulas, *durations), operands)

    def read_f(self, draft: Draft, _: str, words: list[str]) -> None:
        next_number(words[0], len(draft.formulas))
        if words[1:] == ["true"]:
            draft.add_formula(ltl.TRUE, ())
        elif len(words) == 2:
            number = refer(words[1], "a", len(draft.atoms))
            draft.add_formula(draft.atoms[number], [draft.definitions[number]] if number in draft.definitions else ())
        else:
            make, count = _CONNECTIVES.get(words[1], (None, 0)) if len(words) > 1 else (None, 0)
            if make is None:
                self.fail("a formula is true, an atom, or not, next, and, or, until of formulas")
            parts = self.formula_numbers(draft, arguments(words[2:], count))
            draft.add_formula(make(*(draft.formulas[part] for part in parts)), map(draft.measure, parts))

    def read_p(self, draft: Draft, _: str, words: list[str]) -> None:
        next_number(words[0], len(draft.properties))
        kind = _PROPERTIES.get(words[1]) if len(words) > 1 else None
        if kind is None:
            self.fail("not a kind of property")
        events = _EVENTS.get(kind, 0)
        bodies = 2 if kind in (properties.And, properties.Or, properties.Implies) else 1
        if kind in (properties.Now, properties.Throughout):
            bodies = 0
        durations = [duration(word) for word in words[2:3]] if kind is properties.Within else []
        parts = arguments(words[2 + len(durations) :], events + bodies)
        predicates = self.formula_numbers(draft, parts[:events])
        below = [refer(word, "p", len(draft.properties)) for word in parts[events:]]
        draft.depths.append(1 + max((draft.depths[number] for number in below), default=0))
        inner = [draft.properties[number] for number in below]
        try:
            property_ = kind(*(draft.formulas[number] for number in predicates), *durations, *inner)
        except ValueError:
            self.fail("a state predicate must not contain next or until, and a bound is more than 0")
        sizes, bounds = [draft.sizes[n] for n in predicates], [draft.bounds[n] for n in below]
        draft.bounds.append(bound_of(property_, sizes, bounds))
        deepest = max((draft.heights[number] for number in predicates), default=0)
        if draft.depths[-1] > DEEPEST_PROPERTY or deepest > DEEPEST_PREDICATE or sum(draft.bounds) > LARGEST_ENCODING:
            self.fail("the property is too large")
        draft.properties.append(property_)

    def read_subject(self, draft: Draft, _: str, words: list[str]) -> None:
        draft.subject = refer(arguments(words, 2)[1], "p", len(draft.properties))

    def read_formula(self, draft: Draft, _: str, words: list[str]) -> None:
        draft.formula = refer(arguments(words, 2)[1], "f", len(draft.formulas))

    def read_assumption(self, draft: Draft, _: str, words: list[str]) -> None:
        draft.assumption = refer(arguments(words, 2)[1], "f", len(draft.formulas))
        if not ltl.is_propositional(draft.formulas[draft.assumption]):
            self.fail("an assumption must not contain next or until")

    def read_k(self, draft: Draft, _: str, words: list[str]) -> None:
        next_number(words[0], len(draft.clocks))
        draft.clocks.append(clocks_of_words(words[1:]))

    def spots(self, draft: Draft, words: list[str]) -> list[Spot]:
        """Places: formulas, each after a state of the clocks and a dot if there are clocks."""
        found: list[Spot] = []
        for word in words:
            clocks, dot, formula = word.rpartition(".")
            number = refer(clocks, "k", len(draft.clocks)) if dot else None
            found.append((number, refer(formula, "f", len(draft.formulas))))
        return found

    def read_q(self, draft: Draft, _: str, words: list[str]) -> None:
        next_number(words[0], len(draft.verdicts))
        if len(words) < 3 or words[1] not in VERDICTS or words[3:4] not in ([], ["remains"]) or len(words) == 4:
            self.fail("a state has a verdict, the state or decision that follows, and 'remains' with formulas")
        draft.verdicts.append(VERDICTS[words[1]])
        draft.edges.append(later(words[2], "q", "d"))
        draft.annotations.append(self.spots(draft, words[4:]))

    def read_d(self, draft: Draft, _: str, words: list[str]) -> None:
        next_number(words[0], len(draft.decisions))
        if len(words) != 6 or words[2] != "then" or words[4] != "else":
            self.fail("a decision reads: d0 a0 then q1 else q2")
        atom = refer(words[1], "a", len(draft.atoms))
        draft.decisions.append(Decision(atom, later(words[5], "q", "d"), later(words[3], "q", "d")))

    def read_dead(self, draft: Draft, _: str, words: list[str]) -> None:
        members = words[1:]
        progress: Progress = None
        if words[-2:-1] == ["never"]:
            members, eventuality = words[1:-2], draft.formulas[refer(words[-1], "f", len(draft.formulas))]
            if not isinstance(eventuality, ltl.Until):
                self.fail("what never happens must be an until formula")
            progress = eventuality
        elif words[-2:-1] == ["clock"]:
            members, progress = words[1:-2], natural(words[-1])
        draft.levels.append((self.spots(draft, members), progress))

    def read_witness(self, draft: Draft, _: str, words: list[str]) -> None:
        if len(words) < 4 or words.count("loop") != 1 or words[-1] == "loop":
            self.fail("a witness has a state, letters, 'loop' and letters")
        state = refer(words[1], "q", len(draft.verdicts))
        middle = words.index("loop")
        letters = [self.letter(draft, word) for word in [*words[2:middle], *words[middle + 1 :]]]
        word = Lasso(tuple(letters[: middle - 2]), tuple(letters[middle - 2 :]))
        draft.witnesses.setdefault(state, []).append(word)

    def letter(self, draft: Draft, word: str) -> Letter:
        """A letter: the atoms that hold, in braces."""
        if not _LETTER.fullmatch(word):
            self.fail(f"'{word[:40]}' is not a letter: {{a0,a2}}")
        names = word[1:-1].split(",") if len(word) > 2 else []
        return frozenset(draft.atoms[refer(name, "a", len(draft.atoms))].name for name in names)

    def read_program(self, draft: Draft, _: str, words: list[str]) -> None:
        draft.program.read(words, Parts(draft.atoms, draft.formulas, draft.clocks, len(draft.verdicts)))

    def read_end(self, draft: Draft, _: str, words: list[str]) -> None:
        arguments(words, 1)
        self.entries.append(draft.entry())
        self.draft = None
