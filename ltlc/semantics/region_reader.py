"""Reading regions from the lines of guards in a file of certificates, for an arena that is known."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from typing import NamedTuple

from ltlc.dataclass import dataclass
from ltlc.semantics.arenas import Arena, Joint, Outcome, Part, Place, Sent, Standing, Ticks
from ltlc.semantics.certificate_reader import UnreadableError, clocks_of_words
from ltlc.semantics.certificate_words import WrongError, arguments, natural, next_number, refer
from ltlc.semantics.diagrams import Diagram, Diagrams
from ltlc.semantics.reset_machine import WITHOUT_CLOCKS, Clocks

MOST_PLACES = 100_000


class Spot(NamedTuple):
    """Of a joint place: where the guards rest, which fallback they send at once where, and before which clocks pass."""

    rests: Diagram
    answers: Mapping[int, Diagram]
    acts: dict[tuple[Ticks, int], Diagram]


@dataclass(slots=True)
class RegionRead:
    """A region as it was read; the first of its joint places is where the guards start.

    Levels of `diagrams` are the atoms of the arena in their order. `heading` are the lines that say what the game is
    played on.
    """

    heading: list[str] = field(default_factory=list)
    diagrams: Diagrams = field(default_factory=Diagrams)
    assumption: Diagram | None = None
    spots: dict[Joint, Spot] = field(default_factory=dict)


def guards_of(text: str) -> Iterator[list[tuple[int, str]]]:
    """The numbered lines of each guard in a file of certificates that can be read."""
    lines: list[tuple[int, str]] = []
    for number, line in enumerate(text.split("\n"), start=1):
        if lines or line.startswith("guard "):
            lines.append((number, line))
        if lines and line == "end":
            yield [each for each in lines if each[1] and not each[1].startswith("#")]
            lines = []


def read_region(lines: Iterable[tuple[int, str]], arena: Arena) -> RegionRead:
    """The region of the guards of `arena`. Raises UnreadableError, and nothing else."""
    reader = _Reader(arena)
    for number, line in lines:
        try:
            reader.read(line)
        except WrongError as error:
            raise UnreadableError(number, str(error)) from None
    if reader.found.assumption is None or not reader.found.spots:
        raise UnreadableError(number, "the guard lacks a line")
    return reader.found


_STAGES = tuple("heading d assumption k r ahead end".split())  # noqa: SIM905
_HEADING = frozenset(("guard", "lead", "m", "a", "n", "g", "u"))


class _Reader:
    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        self.found = RegionRead()
        self.stage = 0
        self.decisions: list[Diagram] = []
        self.clocks: list[Clocks] = []
        self.places: list[Joint] = []

    def read(self, line: str) -> None:
        """One line. Raises WrongError."""
        words = line.split(" ")
        kind = words[0] if words[0].isalpha() else words[0][:1]
        stage = "heading" if kind in _HEADING else kind
        if stage not in _STAGES or _STAGES.index(stage) < self.stage:
            raise WrongError(f"'{words[0][:40]}' starts no line of a guard, or comes too late")
        self.stage = _STAGES.index(stage)
        match stage:
            case "heading":
                self.found.heading.append(line)
            case "d":
                self.decisions.append(self._decision(words))
            case "assumption":
                if self.found.assumption is not None:
                    raise WrongError("a second 'assumption'")
                self.found.assumption = self._predicate(arguments(words, 2)[1])
            case "k":
                refer(words[0], "k", len(self.clocks) + 1)
                next_number(words[0], len(self.clocks))
                self.clocks.append(clocks_of_words(words[1:]))
            case "r":
                self._place(words)
            case "ahead":
                self._act(words[1:])
            case _:
                arguments(words, 1)

    def _decision(self, words: list[str]) -> Diagram:
        if len(words) != 6 or words[2] != "then" or words[4] != "else":
            raise WrongError("a decision reads: d0 a0 then true else false")
        refer(words[0], "d", len(self.decisions) + 1)
        next_number(words[0], len(self.decisions))
        atom = refer(words[1], "a", len(self.arena.read))
        diagrams = self.found.diagrams
        return diagrams.choose(diagrams.variable(atom), self._predicate(words[3]), self._predicate(words[5]))

    def _predicate(self, word: str) -> Diagram:
        if word in ("true", "false"):
            return self.found.diagrams.true if word == "true" else self.found.diagrams.false
        return self.decisions[refer(word, "d", len(self.decisions))]

    def _place(self, words: list[str]) -> None:
        number, count = len(self.places), len(self.arena.parts)
        if words[0] != f"r{number}" or number == MOST_PLACES:
            raise WrongError(f"'{words[0][:40]}' should be r{number}, or there are too many places")
        if words[2 + count : 3 + count] != ["rests"] or len(words) < 4 + count or len(words) % 2 != count % 2:
            raise WrongError("a place says how many messages have left, where each property is, and where to rest")
        standings = map(self._standing, self.arena.parts, words[2 : 2 + count])
        joint = Joint(self._sent(words[1]), tuple(standings))
        if joint in self.found.spots:
            raise WrongError("there is a second line for this place")
        rest = words[4 + count :]
        fallbacks = [refer(word, "g", len(self.arena.fallbacks)) for word in rest[::2]]
        _ascending([(fallback,) for fallback in fallbacks])
        answers = dict(zip(fallbacks, map(self._predicate, rest[1::2]), strict=True))
        self.places.append(joint)
        self.found.spots[joint] = Spot(self._predicate(words[3 + count]), answers, {})

    def _sent(self, word: str) -> Sent:
        if word == "silent":
            return None
        counts = tuple(natural(each) for each in word.split(","))
        if len(counts) != len(self.arena.outs):
            raise WrongError("there is one number of messages for each guard")
        return counts

    def _standing(self, part: Part, word: str) -> Standing:
        if word in ("waits", "satisfied"):
            return Outcome.WAITING if word == "waits" else Outcome.SATISFIED
        clocks, dot, state = word.rpartition(".")
        at = self.clocks[refer(clocks, "k", len(self.clocks))] if dot else WITHOUT_CLOCKS
        trackers = part.time.trackers
        if len(at.states) != len(trackers) or any(
            s.passed > len(t.bounds) for s, t in zip(at.states, trackers, strict=True)
        ):
            raise WrongError("this is no state of the clocks of the property")
        return Place(refer(state, "q", len(part.monitor.verdicts)), at)

    def _act(self, words: list[str]) -> None:
        if len(words) < 4:
            raise WrongError("an act ahead has a place, clocks, a fallback and a predicate")
        joint = self.places[refer(words[0], "r", len(self.places))]
        clocks = [self._clock(word) for word in words[1:-2]]
        _ascending(clocks)
        key = frozenset(clocks), refer(words[-2], "g", len(self.arena.fallbacks))
        diagrams, acts = self.found.diagrams, self.found.spots[joint].acts
        acts[key] = diagrams.disjunction(acts.get(key, diagrams.false), self._predicate(words[-1]))

    def _clock(self, word: str) -> tuple[int, int]:
        part, _, number = word.partition(".")
        clock = natural(part), natural(number)
        if clock[0] >= len(self.arena.parts) or clock[1] >= len(self.arena.parts[clock[0]].time.trackers):
            raise WrongError(f"there is no clock '{word[:40]}'")
        return clock


def _ascending(found: Sequence[tuple[int, ...]]) -> None:
    """Raises WrongError where things are not named in their order, each once."""
    if list(found) != sorted(set(found)):
        raise WrongError("what is listed is not in its order")
