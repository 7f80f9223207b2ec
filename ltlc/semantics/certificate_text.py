"""The text form of certificates: what `ltlc build --certificate` writes and both checkers read.

One item a line; `#` starts a comment line. Every part has a number and is used by it: atoms a0 …, formulas f0 …,
parts of the property p0 …, states q0 …, decisions d0 …. `docs/assurance.md` describes the lines; `proofs/checker`
reads the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ltlc.semantics import ltl, properties
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.conditions import Conditions
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Target
from ltlc.semantics.properties import Property
from ltlc.semantics.words import Word

HEADER = "ltlc-certificate 1"


@dataclass(frozen=True, slots=True)
class Entry:
    """The certificate of one property of a specification; `line` is where the property stands in it."""

    label: str
    line: int
    subject: Property
    encoding: str
    certificate: Certificate


def to_text(entries: Iterable[Entry]) -> str:
    """The certificates as a text. Raises ValueError if a name does not fit on a line."""
    entries = tuple(entries)
    lines = [HEADER, f"properties {len(entries)}"]
    for entry in entries:
        lines += ["", *_Writer(entry).lines()]
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
    return "true", 3


def is_name(text: str) -> bool:
    """Whether `text` can be a label or the name of an atom: it fits on a line and has no blanks around it."""
    return bool(text) and text == text.strip(" ") and not any(c < " " or c == "\x7f" for c in text)


class _Writer:
    """Numbers the parts of one entry as they are first used."""

    def __init__(self, entry: Entry) -> None:
        self.entry = entry
        certificate = entry.certificate
        used = [*ltl.atoms(certificate.assumption), *properties.atoms(entry.subject), *ltl.atoms(certificate.formula)]
        self.atoms = {a: number for number, a in enumerate(dict.fromkeys([*certificate.monitor.atoms, *used]))}
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
        yield f"subject p{self._property(self.entry.subject)}"
        yield f"formula {self._formula(certificate.formula)}"
        yield f"assumption {self._formula(certificate.assumption)}"
        for state, (verdict, edge) in enumerate(zip(monitor.verdicts, monitor.edges, strict=True)):
            remains = self._formulas_of(certificate.annotations[state])
            yield f"q{state} {verdict.value} {_target(edge)}{f' remains {remains}' if remains else ''}"
        for number, (atom, low, high) in enumerate(monitor.decisions):
            yield f"d{number} a{atom} then {_target(high)} else {_target(low)}"
        for level in certificate.levels:
            never = f" never {self._formula(level.eventuality)}" if level.eventuality is not None else ""
            yield f"dead {self._formulas_of(level.members)}{never}"
        for state, words in enumerate(certificate.witnesses):
            for word in words:
                stem = "".join(f"{letter} " for letter in self._letters(word.stem))
                yield f"witness q{state} {stem}loop {' '.join(self._letters(word.loop))}"

    def _formulas_of(self, formulas: Iterable[Formula]) -> str:
        return " ".join(self._formula(formula) for formula in formulas)

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
        line = f"p{len(self.property_lines)} {PROPERTY_WORDS[type(property_)]} {' '.join(parts)}"
        self.property_lines.append(line)
        return len(self.property_lines) - 1

    def _letters(self, word: Word) -> list[str]:
        known = [sorted(self.atoms[atom] for atom in letter if atom in self.atoms) for letter in word]
        return ["{" + ",".join(f"a{number}" for number in letter) + "}" for letter in known]


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
}
"""What each kind of property is called in a certificate: its keyword, or `now` and `throughout` for a predicate."""
