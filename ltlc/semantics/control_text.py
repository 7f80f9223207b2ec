"""What runs as lines of a certificate: its clocks, states, branches and outcomes, and the pairs in which it follows."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field

from ltlc.dataclass import dataclass
from ltlc.semantics.certificate_words import (
    VERDICTS,
    WrongError,
    arguments,
    duration,
    exists,
    later,
    next_number,
    refer,
)
from ltlc.semantics.control import Base, Branch, Control, Followed, Outcome, Pair, Setting, Stance, Way
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import TRUE, Atom, Formula, is_propositional
from ltlc.semantics.reset_machine import Clocks
from ltlc.semantics.trackers import State

PROGRAM_KINDS = frozenset(("c", "s", "b", "o", "pair"))
_BASES = {base.value: base for base in Base}


def program_atoms(control: Control) -> list[str]:
    """The atoms that `control` asks for."""
    return [branch.asked for branch in control.branches if isinstance(branch.asked, str)]


def program_lines(
    program: Followed,
    atoms: Mapping[str, int],
    clocks: Mapping[tuple[State, ...], int],
    formula: Callable[[Formula], str],
) -> Iterator[str]:
    """The lines of `program`; atoms, states of trackers and formulas are numbered as in the certificate."""
    control = program.control
    for number, first in enumerate(control.first_due):
        yield f"c{number}" if first is None else f"c{number} first {first}"
    for number, (verdict, step, clock_step) in enumerate(control.stances):
        expires = "" if clock_step is None else f" expires {_way(clock_step)}"
        yield f"s{number} {verdict.value} {_way(step)}{expires}"
    for number, (asked, if_so, if_not) in enumerate(control.branches):
        question = f"c{asked}" if isinstance(asked, int) else f"a{atoms[asked]}"
        yield f"b{number} {question} then {_way(if_so)} else {_way(if_not)}"
    for number, (state, settings, again) in enumerate(control.outcomes):
        words = [f"o{number}", f"s{state}", *map(_setting, settings), *(["again"] if again else [])]
        yield " ".join(words)
    for state, judged, stand, looks_again, last_letter in program.pairs:
        words = [f"pair s{state} q{judged}"]
        words += [f"k{clocks[stand]}"] if stand else []
        words += ["again"] if looks_again else []
        words += [formula(last_letter)] if last_letter != TRUE else []
        yield " ".join(words)


def _way(way: Way) -> str:
    return f"o{way}" if way >= 0 else f"b{~way}"


def _setting(setting: Setting) -> str:
    lasts = "" if setting.base is Base.NEVER else f" {setting.duration}"
    return f"c{setting.clock} {setting.base.value}{lasts}"


@dataclass(frozen=True, slots=True)
class Parts:
    """What lines of a program refer to: the atoms, formulas, states of trackers and number of states read so far."""

    atoms: Sequence[Atom]
    formulas: Sequence[Formula]
    clocks: Sequence[Clocks]
    states: int


@dataclass(slots=True)
class ControlDraft:
    """What has been read of a program, line by line."""

    first_due: list[Nanoseconds | None] = field(default_factory=list)
    stances: list[Stance] = field(default_factory=list)
    branches: list[Branch] = field(default_factory=list)
    outcomes: list[Outcome] = field(default_factory=list)
    pairs: list[Pair] = field(default_factory=list)

    def read(self, words: list[str], parts: Parts) -> None:
        """One line, in a certificate with these `parts`. Raises WrongError."""
        if words[0] == "pair":
            self.pairs.append(self._pair(words[1:], parts))
            return
        match words[0][0]:
            case "c":
                next_number(words[0], len(self.first_due))
                self.first_due.append(self._first(words[1:]))
            case "s":
                next_number(words[0], len(self.stances))
                self.stances.append(self._stance(words[1:]))
            case "b":
                next_number(words[0], len(self.branches))
                self.branches.append(self._branch(words[1:], parts.atoms))
            case _:
                next_number(words[0], len(self.outcomes))
                self.outcomes.append(self._outcome(words[1:]))

    def _first(self, words: list[str]) -> Nanoseconds | None:
        if words and (len(words) != 2 or words[0] != "first"):
            raise WrongError("a clock says 'first' and a duration, or nothing")
        return duration(words[1]) if words else None

    def _stance(self, words: list[str]) -> Stance:
        if len(words) not in (2, 4) or words[0] not in VERDICTS or words[2:3] not in ([], ["expires"]):
            raise WrongError("a state of a program reads: s0 satisfied o0, or with 'expires' and where that leads")
        ways = [later(word, "o", "b") for word in words[1::2]]
        return Stance(VERDICTS[words[0]], *ways)

    def _branch(self, words: list[str], atoms: Sequence[Atom]) -> Branch:
        if len(words) != 5 or words[1] != "then" or words[3] != "else":
            raise WrongError("a branch reads: b0 a0 then o1 else o2")
        is_clock = words[0].startswith("c")
        asked = refer(words[0], "c", len(self.first_due)) if is_clock else atoms[refer(words[0], "a", len(atoms))].name
        return Branch(asked, later(words[2], "o", "b"), later(words[4], "o", "b"))

    def _outcome(self, words: list[str]) -> Outcome:
        if not words:
            raise WrongError("an outcome has a state")
        again = words[-1] == "again"
        settings = []
        rest = iter(words[1 : len(words) - again])
        for clock in rest:
            number = refer(clock, "c", len(self.first_due))
            base = _BASES.get(next(rest, ""))
            if base is None:
                raise WrongError(f"a clock is set to {', '.join(_BASES)}")
            settings.append(Setting(number, base, 0 if base is Base.NEVER else duration(next(rest, ""))))
        return Outcome(refer(words[0], "s", len(self.stances)), tuple(settings), again)

    def _pair(self, words: list[str], parts: Parts) -> Pair:
        """Two states, then where the trackers are, whether a clock step comes next, and what the last letter has."""
        state, judged = arguments(words[:2], 2)
        rest = words[2:]
        stand = parts.clocks[refer(rest.pop(0), "k", len(parts.clocks))].states if _starts_with(rest, "k") else ()
        looks_again = rest[:1] == ["again"]
        last = [refer(word, "f", len(parts.formulas)) for word in rest[looks_again:]]
        if len(last) > 1 or not all(is_propositional(parts.formulas[number]) for number in last):
            raise WrongError("a pair reads: pair s0 q0 k0 again f0, where f0 is a state predicate")
        last_letter = parts.formulas[last[0]] if last else TRUE
        numbers = refer(state, "s", len(self.stances)), refer(judged, "q", parts.states)
        return Pair(*numbers, stand, looks_again, last_letter)

    def followed(self) -> Followed | None:
        """What has been read; None if nothing has. Raises WrongError if a part is missing."""
        if not (self.first_due or self.stances or self.branches or self.outcomes or self.pairs):
            return None
        ways = [way for stance in self.stances for way in stance[1:] if way is not None]
        ways += [way for branch in self.branches for way in branch[1:]]
        for way in ways:
            exists(way, "o", len(self.outcomes), "b", len(self.branches))
        if not self.stances:
            raise WrongError("the program has no state")
        control = Control(tuple(self.stances), tuple(self.branches), tuple(self.outcomes), tuple(self.first_due))
        return Followed(control, tuple(self.pairs))


def _starts_with(words: list[str], sort: str) -> bool:
    return bool(words) and words[0].startswith(sort)
