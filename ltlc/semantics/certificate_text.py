"""The text form of certificates: what `ltlc build --certificate` writes and both checkers read.

One item a line; `#` starts a comment line. Every part has a number and is used by it: atoms a0 …, definitions of timed
atoms t0 …, formulas f0 …, parts of the property p0 …, states of the reset machine k0 …, states q0 …, decisions d0 …;
and, of what runs, clocks c0 …, states s0 …, branches b0 … and outcomes o0 ….
That a clock is late is defined by the property, whose encoding the reader computes anew. `docs/assurance.md` describes
the lines; `proofs/checker` reads the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field

from ltlc.dataclass import dataclass
from ltlc.semantics import ltl, properties
from ltlc.semantics.certificate import Certificate, Place, Progress, all_members
from ltlc.semantics.conditions import Conditions
from ltlc.semantics.control import Followed
from ltlc.semantics.control_text import program_atoms, program_lines
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Target
from ltlc.semantics.properties import Property
from ltlc.semantics.reset_machine import WITHOUT_CLOCKS, Clocks
from ltlc.semantics.timed_atoms import (
    Age,
    Historically,
    News,
    Once,
    Previously,
    Since,
    atoms_within,
    duration_of,
    operands,
)
from ltlc.semantics.trackers import Phase
from ltlc.semantics.words import Word

HEADER = "ltlc-certificate 1"
BEGUN = "begun"
"""What a clock does that runs, but has for no time."""


@dataclass(frozen=True, slots=True)
class Entry:
    """The certificate of one property of a specification; `line` is where the property stands in it.

    `program` is what runs, and how it follows the monitor, if that is there, too. `remarks` are for people only.
    """

    label: str
    line: int
    subject: Property
    encoding: str
    certificate: Certificate
    program: Followed | None = None
    remarks: tuple[str, ...] = field(default=(), compare=False)


def to_text(entries: Iterable[Entry], guards: Sequence[Sequence[str]] = ()) -> str:
    """The certificates as a text, then the lines of guards. Raises ValueError if a name does not fit on a line."""
    entries = tuple(entries)
    lines = [HEADER, f"properties {len(entries)}" + (f" guards {len(guards)}" if guards else "")]
    for some in (*(_Writer(entry).lines() for entry in entries), *guards):
        lines += ["", *some]
    return "\n".join(lines) + "\n"


def in_words(predicate: Formula) -> str:
    """A state predicate as the language writes it."""
    return Conditions().fold(predicate, _in_words)[0]


def _in_words(predicate: Formula, parts: list[tuple[str, int]]) -> tuple[str, int]:
    """The text of `predicate` and how tightly it binds, from those of its parts."""

    def within(strength: int) -> list[str]:
        return [f"({text})" if own < strength else text for text, own in parts]

    match predicate:
        case ltl.Atom(name):
            return name, 3
        case ltl.Not():
            return f"not {within(2)[0]}", 2
        case ltl.And():
            return " and ".join(within(1)), 1
        case ltl.Or():
            return " or ".join(within(0)), 0
        case _:
            return "true", 3


def is_name(text: str) -> bool:
    """Whether `text` can be a label or the name of an atom: it fits on a line and has no blanks around it."""
    return bool(text) and text == text.strip(" ") and not any(c < " " or c == "\x7f" for c in text)


class _Writer:
    """Numbers the parts of one entry as they are first used."""

    def __init__(self, entry: Entry) -> None:
        self.entry = entry
        certificate = entry.certificate
        deciding = {a.name: a for p in properties.predicates(entry.subject) for a in atoms_within(p)}
        used = [*ltl.atoms(certificate.assumption), *properties.atoms(entry.subject), *ltl.atoms(certificate.formula)]
        asked = () if entry.program is None else program_atoms(entry.program.control)
        self.atoms = {a: n for n, a in enumerate(dict.fromkeys([*certificate.monitor.atoms, *used, *deciding, *asked]))}
        self.timed = [atom for atom in deciding.values() if isinstance(atom, Defined)]
        places = [*all_members(certificate.levels), *(place for some in certificate.annotations for place in some)]
        clocks = dict.fromkeys(place.clocks for place in places if place.clocks != WITHOUT_CLOCKS)
        known = {each.states for each in clocks}
        stands = () if entry.program is None else (pair.stand for pair in entry.program.pairs)
        clocks |= dict.fromkeys(Clocks(False, stand) for stand in stands if stand and stand not in known)
        self.clocks = {each: number for number, each in enumerate(clocks)}
        self.formula_lines: list[str] = []
        self._formulas: dict[str, int] = {}
        self._seen: dict[int, tuple[Formula, int]] = {}
        self.property_lines: list[str] = []

    def lines(self) -> Iterator[str]:
        """The lines of the entry."""
        entry, certificate = self.entry, self.entry.certificate
        body = list(self._body())
        for name in (entry.label, *self.atoms):
            if not is_name(name):
                raise ValueError(f"not a name that fits on a line: {name!r}")
        yield f"property {entry.label}"
        yield from (f"# {_shortened(remark)}" for remark in entry.remarks)
        yield f"line {entry.line}"
        yield f"encoding {entry.encoding}"
        yield from (f"a{number} {name}" for name, number in self.atoms.items())
        yield f"# {_shortened(str(certificate.formula))}"
        yield from self.formula_lines
        yield from self.property_lines
        yield from body
        yield "end"

    def _body(self) -> Iterator[str]:
        certificate, monitor = self.entry.certificate, self.entry.certificate.monitor
        for number, timed in enumerate(self.timed):
            self.formula_lines.append(f"t{number} {self._definition(timed)}")
        yield f"subject p{self._property(self.entry.subject)}"
        yield f"formula {self._formula(certificate.formula)}"
        yield f"assumption {self._formula(certificate.assumption)}"
        for clocks, number in self.clocks.items():
            yield f"k{number} {clocks_in_words(clocks)}"
        for state, (verdict, edge) in enumerate(zip(monitor.verdicts, monitor.edges, strict=True)):
            remains = self._places(certificate.annotations[state])
            yield f"q{state} {verdict.value} {_target(edge)}{f' remains {remains}' if remains else ''}"
        for number, (atom, low, high) in enumerate(monitor.decisions):
            yield f"d{number} a{atom} then {_target(high)} else {_target(low)}"
        for level in certificate.levels:
            yield f"dead {self._places(level.members)}{self._progress(level.progress)}"
        for state, words in enumerate(certificate.witnesses):
            for word in words:
                stem = "".join(f"{letter} " for letter in self._letters(word.stem))
                yield f"witness q{state} {stem}loop {' '.join(self._letters(word.loop))}"
        if self.entry.program is not None:
            states = {clocks.states: number for clocks, number in self.clocks.items()}
            yield from program_lines(self.entry.program, self.atoms, states, self._formula)

    def _definition(self, atom: Defined) -> str:
        """What a timed atom is: its keyword, the state predicates that decide it, a duration."""
        words = [f"a{self.atoms[atom.name]}", TIMED_WORDS[type(atom)], *map(self._formula, operands(atom))]
        duration = duration_of(atom)
        return " ".join(words if duration is None else [*words, str(duration)])

    def _places(self, places: Iterable[Place]) -> str:
        """Each with the state of the reset machine before a dot, if there is one."""
        return " ".join(
            ("" if clocks == WITHOUT_CLOCKS else f"k{self.clocks[clocks]}.") + self._formula(remains)
            for clocks, remains in places
        )

    def _progress(self, progress: Progress) -> str:
        match progress:
            case None:
                return ""
            case int(fair_set):
                return f" clock {fair_set}"
            case _:
                return f" never {self._formula(progress)}"

    def _formula(self, formula: Formula) -> str:
        """The number of a formula, whose parts get lines before it."""
        stack = [formula]
        while stack:
            current = stack[-1]
            missing = [part for part in ltl.children(current) if id(part) not in self._seen]
            if id(current) not in self._seen and missing:
                stack.extend(missing)
                continue
            stack.pop()
            if id(current) not in self._seen:
                self._seen[id(current)] = (current, self._formula_line(current))
        return f"f{self._seen[id(formula)][1]}"

    def _formula_line(self, formula: Formula) -> int:
        match formula:
            case ltl.Truth():
                line = "true"
            case ltl.Atom(name):
                line = f"a{self.atoms[name]}"
            case _:
                parts = (f" f{self._seen[id(part)][1]}" for part in ltl.children(formula))
                line = type(formula).__name__.lower() + "".join(parts)
        if line not in self._formulas:
            self._formulas[line] = len(self._formulas)
            self.formula_lines.append(f"f{self._formulas[line]} {line}")
        return self._formulas[line]

    def _property(self, property_: Property) -> int:
        parts = [f"p{self._property(part)}" for part in properties.children(property_)]
        match property_:
            case properties.Now(predicate) | properties.Throughout(predicate):
                parts = [self._formula(predicate)]
            case properties.After(event, _) | properties.Until(event, _):
                parts = [self._formula(event), *parts]
            case properties.AfterUntil(opening, closing, _):
                parts = [self._formula(opening), self._formula(closing), *parts]
            case properties.Within(duration, _):
                parts = [str(duration), *parts]
            case _:
                pass
        line = f"p{len(self.property_lines)} {PROPERTY_WORDS[type(property_)]} {' '.join(parts)}"
        self.property_lines.append(line)
        return len(self.property_lines) - 1

    def _letters(self, word: Word) -> list[str]:
        known = [sorted(self.atoms[atom] for atom in letter if atom in self.atoms) for letter in word]
        return ["{" + ",".join(f"a{number}" for number in letter) + "}" for letter in known]


def clocks_in_words(clocks: Clocks) -> str:
    """Whether a letter has been read, then the phase of each tracker, with how many bounds have passed if it runs."""
    words = ["unread" if clocks.is_first else "read"]
    for number, (phase, passed) in enumerate(clocks.states):
        running = BEGUN if number in clocks.begun else f"{phase.value} {passed}"
        words.append(running if phase is Phase.RUNNING else phase.value)
    return " ".join(words)


def _target(target: Target) -> str:
    return f"q{target}" if target >= 0 else f"d{~target}"


def _shortened(text: str, most: int = 200) -> str:
    return text if len(text) <= most else text[: most - 1] + "…"


PROPERTY_WORDS: dict[type[Property], str] = {
    properties.Now: "now",
    properties.Throughout: "throughout",
    properties.Not: "not",
    properties.And: "and",
    properties.Or: "or",
    properties.Implies: "implies",
    properties.Always: "always",
    properties.Never: "never",
    properties.Eventually: "eventually",
    properties.After: "after",
    properties.Until: "until",
    properties.AfterUntil: "after_until",
    properties.Within: "within",
}
"""What each kind of property is called in a certificate: its keyword, or `now` and `throughout` for a predicate."""

Defined = News | Previously | Once | Historically | Since | Age
"""A timed atom that a certificate defines: to it, a count is an atom of letters, which may change at any instant."""

TIMED_WORDS: dict[type[Defined], str] = {
    News: "news",
    Previously: "previously",
    Once: "once",
    Historically: "historically",
    Since: "since",
    Age: "age",
}
"""What each kind of timed atom is called in a certificate."""
