"""The text of guards in a file of certificates: what their game is played on, and their region.

`docs/assurance.md` describes the lines; `proofs/checker` reads them, and has a proved checker of regions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.dataclass import dataclass
from ltlc.semantics.arenas import Arena, Joint, Outcome, Part, Region, Sent, Standing
from ltlc.semantics.certificate_text import clocks_in_words, is_name
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import FALSE, Formula, atoms
from ltlc.semantics.reset_machine import Clocks
from ltlc.semantics.timed_atoms import counts_of


@dataclass(frozen=True, slots=True)
class GuardEntry:
    """The region of guards that are one game.

    `guards` has the line, RAW and OUT of each; `properties` the number of the certificate of each part of the arena.
    """

    guards: tuple[tuple[int, str, str], ...]
    lead: Nanoseconds
    arena: Arena
    region: Region
    properties: tuple[int, ...]


def guard_lines(entry: GuardEntry) -> list[str]:
    """The lines of an entry. Raises ValueError if a name does not fit on a line."""
    return _Writer(entry).lines()


def heading(entry: GuardEntry) -> list[str]:
    """The lines that say what its game is played on, the region apart."""
    return _Writer(entry).heading()


class _Writer:
    """Numbers predicates and states of clocks as they are first used."""

    def __init__(self, entry: GuardEntry) -> None:
        self.entry, self.arena, self.region = entry, entry.arena, entry.region
        self.topics = (*self.arena.outs, *self.arena.others)
        self.atoms = {name: number for number, name in enumerate(self.arena.read)}
        self.diagrams = Diagrams()
        self.decisions: dict[Diagram, int] = {}
        self.predicate_lines: list[str] = []
        self.clocks: dict[Clocks, int] = {}
        places = dict.fromkeys([self.arena.start, *self.region.rests, *(joint for joint, _ in self.region.answers)])
        self.places = {j: n for n, j in enumerate(j for j in places if self.arena.outcome(j) is None)}

    def lines(self) -> list[str]:
        assumption = f"assumption {self._predicate(self.arena.alphabet.as_formula())}"
        places = [self._place(joint, number) for joint, number in self.places.items()]
        acts = list(self._acts())
        clocks = [f"k{number} {clocks_in_words(clocks)}" for clocks, number in self.clocks.items()]
        return [*self.heading(), *self.predicate_lines, assumption, *clocks, *places, *acts, "end"]

    def heading(self) -> list[str]:
        news = {name: topic for part in self.arena.parts for name, topic in part.news.items()}
        for name in (*self.topics, *self.atoms, *news):
            if not is_name(name):
                raise ValueError(f"not a name that fits on a line: {name!r}")
        return [
            *(f"guard {line} {raw} to {out}" for line, raw, out in self.entry.guards),
            f"lead {self.entry.lead}",
            *(f"m{number} {topic}" for number, topic in enumerate(self.topics)),
            *(f"a{number} {self._reading(name)} {name}" for name, number in self.atoms.items()),
            *(f"n{number} m{self.topics.index(topic)} {name}" for number, (name, topic) in enumerate(news.items())),
            *self._fallbacks(),
            *(f"u{number} {self._part(part, number)}" for number, part in enumerate(self.arena.parts)),
        ]

    def _reading(self, name: str) -> str:
        """The topics that an atom reads."""
        read = self.arena.read[name] | self._counted(name)
        topics = ",".join(f"m{number}" for number, topic in enumerate(self.topics) if topic in read)
        return f"loose {topics}" if name in self.arena.loose else topics

    def _counted(self, name: str) -> frozenset[str]:
        """The topics that are read for a count."""
        found = set[str]()
        for part in self.arena.parts:
            for count in counts_of(part.formula):
                if count.name == name:
                    for atom in atoms(count.operand):
                        found |= {part.news[atom]} if atom in part.news else self.arena.read[atom]
        return frozenset(found)

    def _fallbacks(self) -> Iterator[str]:
        for number, fallback in enumerate(self.arena.fallbacks):
            words = [f"g{number} m{self.topics.index(fallback.out)} {fallback.name}"]
            for name, atom in self.atoms.items():
                value = fallback.effect[name]
                if value is not None and fallback.out in self.arena.read[name]:
                    words.append(
                        f"a{atom} {str(value).lower() if isinstance(value, bool) else f'a{self.atoms[value]}'}"
                    )
            yield " ".join(words)

    def _part(self, part: Part, number: int) -> str:
        verb = "assumes" if part.is_assumed else "keeps"
        awaited = part.waits.intersection(self.arena.outs)
        counts = ",".join(str(part.history + 1 if out in awaited else 0) for out in self.arena.outs)
        begins = (counts if awaited else "silent") if part.waits else "session"
        return f"{verb} {self.entry.properties[number]} begins {begins}"

    def _place(self, joint: Joint, number: int) -> str:
        words = [f"r{number} {_sent(joint.sent)}", *map(self._standing, joint.standings)]
        words += ["rests", self._predicate(self.region.rests.get(joint, FALSE))]
        for fallback in range(len(self.arena.fallbacks)):
            if (joint, fallback) in self.region.answers:
                words += [f"g{fallback}", self._predicate(self.region.answers[joint, fallback])]
        return " ".join(words)

    def _standing(self, at: Standing) -> str:
        if isinstance(at, Outcome):
            return "waits" if at is Outcome.WAITING else "satisfied"
        clocks = at.clocks
        return f"k{self.clocks.setdefault(clocks, len(self.clocks))}.q{at.state}" if clocks.states else f"q{at.state}"

    def _acts(self) -> Iterator[str]:
        for (joint, passing, fallback), letters in self.region.acts.items():
            clocks = " ".join(f"{part}.{clock}" for part, clock in sorted(passing))
            yield f"ahead r{self.places[joint]} {clocks} g{fallback} {self._predicate(letters)}"

    def _predicate(self, predicate: Formula) -> str:
        """The name of a predicate, whose decisions get lines before it."""
        root = of_predicate(predicate, self.diagrams, self.atoms)
        for node in _from_below(self.diagrams, root):
            if node not in self.decisions:
                self.decisions[node] = len(self.decisions)
                atom, low, high = self.diagrams.split(node)
                ways = f"then {self._name(high)} else {self._name(low)}"
                self.predicate_lines.append(f"d{self.decisions[node]} a{atom} {ways}")
        return self._name(root)

    def _name(self, diagram: Diagram) -> str:
        if self.diagrams.is_terminal(diagram):
            return str(self.diagrams.value(diagram)).lower()
        return f"d{self.decisions[diagram]}"


def _from_below(diagrams: Diagrams, root: Diagram) -> Sequence[Diagram]:
    """The decisions of a diagram, those that come last in it first."""
    decisions = (node for node in diagrams.reachable(root) if not diagrams.is_terminal(node))
    return sorted(decisions, key=lambda node: -diagrams.split(node)[0])


def _sent(sent: Sent) -> str:
    return "silent" if sent is None else ",".join(map(str, sent))
