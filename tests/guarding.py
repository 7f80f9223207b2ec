"""Guards for tests: drawn ones, where a run of one is in its game, and the game once more by brute force.

The brute-force game shares nothing with the solver but the front end: its moves are messages with values and explicit
times, a fallback is a message as any other, and `ltlc.monitor` judges what has left the guard.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

import ltlc
from ltlc.analysis.guards.game import Game
from ltlc.assurance.evidence.certified import entry_of
from ltlc.assurance.exactness import checked_certificate
from ltlc.automata import Budget
from ltlc.base.source import Source
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load_text
from ltlc.interfaces.building.guards import guard_entries, guard_programs
from ltlc.program.guards import GuardProgram
from ltlc.semantics import finite
from ltlc.semantics.arenas import Arena, Joint, Outcome, Place, Standing, standing
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.certificate_text import to_text
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.region_text import GuardEntry, guard_lines
from ltlc.semantics.timed_run import TimedRun
from ltlc.semantics.words import Letter
from ltlc.specification import evaluation
from ltlc.specification.arenas import Property, arena_of, together
from ltlc.specification.specification import Specification

MS = 1_000_000

Event = tuple[int, str, tuple[tuple[str, object], ...]]
"""A message: its time in ns, its topic, and the values of the signals on it."""


def loaded(text: str) -> tuple[Specification, list[Arena]]:
    """The specification in `text`, and the arenas of its guards."""
    specification, problems = load_text(Source("guard", text))
    assert specification is not None, [(each.code, each.message) for each in problems]
    compiled, _ = compile_specification(specification, EPISODE, Budget())
    properties = [Property(each.specification, each.formula, each.monitor) for each in compiled]
    games = together(specification.guards, specification.properties)
    return specification, [arena_of(guards, properties) for guards in games]


def certified(text: str) -> tuple[list[Arena], str]:
    """The arenas of the guards in `text`, and the file of certificates with their regions."""
    specification, problems = load_text(Source("guard", text))
    assert specification is not None, [(each.code, each.message) for each in problems]
    compiled, _ = compile_specification(specification, EPISODE, Budget())
    found = [(each, checked_certificate(each)) for each in compiled]
    entries = [entry_of(each, certificate) for each, certificate in found if isinstance(certificate, Certificate)]
    guards = guard_entries(specification, compiled)
    assert len(entries) == len(compiled)
    return [each.arena for each in guards], to_text(entries, [guard_lines(each) for each in guards])


@dataclass
class Drawn:
    """A guard that was drawn: its text, and what may come on each topic, by signals; fallbacks by their values."""

    text: str
    values: Mapping[str, Mapping[str, Sequence[object]]]
    fallbacks: Mapping[str, Mapping[str, object]]
    bounds: Sequence[int]
    out: str = "/cmd"

    @property
    def judged(self) -> str:
        """The properties alone, those that are assumed among them."""
        lines = (line.removeprefix("assume ") for line in self.text.splitlines())
        return "\n".join(line for line in lines if not line.startswith(("guard ", "message ")))

    def messages(self, topic: str) -> Iterator[tuple[tuple[str, object], ...]]:
        """Every message that may come on `topic`."""
        names = self.values[topic]
        return (tuple(zip(names, some, strict=True)) for some in product(*names.values()))


DECLARATIONS = """decl speed /cmd Float64.data
decl near /near Bool.data
decl limit /limit Float64.data
"""

VALUES: dict[str, dict[str, list[object]]] = {
    "/cmd": {"speed": [0.0, 1.0, 2.0]},
    "/near": {"near": [False, True]},
    "/limit": {"limit": [-1.0, 0.5, 3.0]},
}

CONDITIONS = ["speed <= 0.2", "speed >= 1", "near", "new speed", "speed <= limit", "new near"]


def drawn(chance: random.Random, *, timed: bool = True, as_one: bool = False) -> Drawn:
    """A guard with one or two properties and up to two fallbacks; without clocks unless it is `timed`.

    With two `as_one`, a property may have several clocks.
    """
    speeds = chance.sample([0.0, 1.0], chance.choice([0, 1, 1, 1, 2]))
    fallbacks: dict[str, dict[str, object]] = {f"f{n}": {"speed": speed} for n, speed in enumerate(speeds)}
    messages = "".join(f"message {name} {{data: {values['speed']}}}\n" for name, values in fallbacks.items())
    otherwise = f" else {', '.join(fallbacks)}" if fallbacks else ""
    if as_one:
        properties = f"p: ({_property(chance, timed)}) and ({_property(chance, timed)})\n"
    else:
        properties = "".join(f"p{n}: {_property(chance, timed)}\n" for n in range(chance.choice([1, 1, 2])))
    text = f"{DECLARATIONS}guard /raw to /cmd{otherwise}\n{messages}{properties}"
    read = {topic: of for topic, of in VALUES.items() if topic == "/cmd" or next(iter(of)) in properties}
    return Drawn(text, read, fallbacks, [10 * MS, 20 * MS])


def _property(chance: random.Random, timed: bool) -> str:
    def condition(depth: int = 2) -> str:
        match chance.randrange(6 if depth else 3):
            case 3:
                return f"({condition(depth - 1)} and {condition(depth - 1)})"
            case 4:
                return f"({condition(depth - 1)} or {condition(depth - 1)})"
            case 5:
                return f"previously ({condition(0)})"
            case _:
                written = chance.choice(CONDITIONS)
                return f"not {written}" if chance.random() < 0.3 else written

    about = f"({chance.choice(['speed <= 0.2', 'speed <= limit', 'new speed', 'speed >= 1'])})"
    match chance.randrange(6 if timed else 3):
        case 0:
            return f"always ({condition()} implies {about})"
        case 1:
            return f"never ({condition()} and {about})"
        case 2:
            return f"after_until near, not near, always ({condition(1)} or {about})"
        case 3:
            return f"always ({condition()} implies eventually {about} within {chance.choice([10, 20])} ms)"
        case 4:
            return f"always (new speed implies not previously once (new speed and {condition(0)}) within 10 ms)"
        case _:
            return f"always (age(speed) <= 20 ms or {condition(1)})"


@dataclass
class Followed:
    """Where a run of `arena` is in its game, by the reference interpreters."""

    specification: Specification
    game: Game
    drawn: Drawn
    joint: Joint = field(init=False)
    runs: dict[int, TimedRun] = field(default_factory=dict)
    samples: dict[str, list[object]] = field(default_factory=dict)
    heard: list[tuple[int, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.joint = self.game.arena.start
        self._conditions = {a.name: a.condition for p in self.specification.properties for a in p.atoms}

    def letter(self, samples: Mapping[str, list[object]] | None = None) -> dict[str, bool | None]:
        """What is held; None where it is not known.

        What only a fallback leads to is by definition what would hold if it were sent now.
        """
        now, arena = self.samples if samples is None else samples, self.game.arena
        found = {name: self._truth(name, now) for name in arena.read if name in self._conditions}
        for number, sending in enumerate(arena.fallbacks):
            for name, after in sending.effect.items():
                if isinstance(after, str) and after not in self._conditions and name in self._conditions:
                    values = list(self.drawn.fallbacks.values())[number]
                    sent = {**now, **{s: [v, *now.get(s, [])] for s, v in values.items()}}
                    found[after] = self._truth(name, sent)
        return found

    def _truth(self, name: str, samples: Mapping[str, list[object]]) -> bool | None:
        condition, values = self._conditions[name], {}
        for wanted in (i for p in self.specification.properties for i in p.inputs()):
            back = getattr(wanted, "samples", 0)
            if len(samples.get(wanted.signal.name, ())) > back:
                values[wanted] = samples[wanted.signal.name][back]
        try:
            return evaluation.is_true(condition, values)  # type: ignore[arg-type]
        except KeyError:
            return None

    def rests(self, rests: Mapping[Joint, int]) -> bool:
        """Whether the guard may rest, whatever the atoms are that have no value yet."""
        d = self.game.diagrams
        known = {self.game.atoms.index(name): value for name, value in self.letter().items() if value is not None}
        left = d.given(known, rests.get(self.joint, d.false))
        return d.conjunction(d.given(known, self.game.possible), d.negation(left)) == d.false

    def take(self, event: Event) -> None:
        """A message; the clock steps before it have been taken."""
        time, topic, values = event
        arena, before = self.game.arena, self.joint.sent
        self.hold(time)
        for name, value in values:
            self.samples[name] = [value, *self.samples.get(name, [])]
        self.heard.append((time, topic))
        spoken = {t for _, t in self.heard}
        awaited = {t for p in arena.parts if p.waits for t in p.topics} - {*arena.outs}
        options = arena.sent_after(before, topic)
        sent = options[-1] if before is not None or awaited <= spoken else None
        held = {name for name, value in self.letter().items() if value}
        at = list(self.joint.standings)
        for k, part in enumerate(arena.parts):
            if at[k] is Outcome.WAITING and self._begins(k, topic):
                self.runs[k] = TimedRun(part.time.trackers, part.time.news, self.heard[0][0])
                for moment, of in self.heard[:-1]:
                    list(self.runs[k].hear(moment, [n for n, t in part.news.items() if t == of]))
                at[k] = Place(0, part.time.initial)
            elif topic not in part.topics:
                continue
            news = {name for name, of in part.news.items() if of == topic}
            own = frozenset({*held.intersection(part.monitor.atoms), *news})
            if k in self.runs:
                at[k] = self._along(k, at[k], self.runs[k].step(time, own))
        self.joint = Joint(sent, tuple(at))

    def _begins(self, k: int, topic: str) -> bool:
        """Whether all has come that part k waits for, as `docs/language.md` says, just now or at its first message."""
        part, came = self.game.arena.parts[k], Counter(of for _, of in self.heard)
        awaited = {of: part.history if of in self.game.arena.outs else 0 for of in part.waits}
        return all(came[of] > before for of, before in awaited.items()) and (not awaited or topic in part.topics)

    def hold(self, until: int) -> None:
        """The clock steps up to and including `until`."""
        at = list(self.joint.standings)
        for k, run in self.runs.items():
            at[k] = self._along(k, at[k], run.hold(until))
        self.joint = Joint(self.joint.sent, tuple(at))

    def _along(self, k: int, at: Standing, letters: Iterator[Letter]) -> Standing:
        part = self.game.arena.parts[k]
        for letter in letters:
            if isinstance(at, Place):
                (move,) = part.time.moves(at.clocks, (letter,), lambda w, p: w if finite.holds(p, w) else None)
                at = standing(part, part.monitor.step(at.state, letter), move.target)
        return at


class Brute:
    """The game about a guard by brute force, a few moves deep."""

    def __init__(self, of: Drawn) -> None:
        self.drawn = of
        signals = [name for names in of.values.values() for name in names]
        self._run = ltlc.monitor(of.judged, signals=signals)
        self._known: dict[tuple[tuple[Event, ...], int], bool] = {}

    def is_violated(self, events: tuple[Event, ...], until: int) -> bool:
        """Whether a property is violated by the time `until`."""
        if (events, until) not in self._known:
            self._run.reset()
            for time, _, values in events:
                self._run.step(dict(values), time_ns=time)
            self._run.step({}, time_ns=until)
            self._known[events, until] = ltlc.Verdict.VIOLATED in self._run.verdicts.values()
        return self._known[events, until]

    def is_forced(self, events: tuple[Event, ...], now: int, depth: int) -> bool:
        """Whether the world, to move, forces a violation within `depth` messages of its own and of the guard's.

        It may wait until a clock could pass a bound, and so on: waiting alone counts for nothing.
        """
        if depth == 0:
            return False
        for topic in self.drawn.values:
            if topic != self.drawn.out:
                for values in self.drawn.messages(topic):
                    if self.is_lost((*events, (now, topic, values)), now, depth - 1):
                        return True
        starts = {time for time, _, _ in events}
        dues = [t for s in starts for b in (0, *self.drawn.bounds) if (t := s + b + 1) > now]
        return bool(dues) and self._is_lost_in_time(events, now, min(dues), depth)

    def _is_lost_in_time(self, events: tuple[Event, ...], now: int, due: int, depth: int) -> bool:
        """Whether waiting until `due` is lost for the guard: it may send one fallback before, not another one later."""
        if not self.is_lost(events, due, depth):
            return False
        before = max(now, due - 1)
        return not any(
            self._is_safe(after, before, depth - 1) and not self.is_lost(after, due, depth - 1)
            for after in self._answers(events, before)
        )

    def is_lost(self, events: tuple[Event, ...], now: int, depth: int) -> bool:
        """Whether the guard, to move, can do nothing."""
        if self._is_safe(events, now, depth):
            return False
        if self.is_violated(events, now):
            return True
        return not any(self._is_safe(after, now, depth - 1) for after in self._answers(events, now))

    def _is_safe(self, events: tuple[Event, ...], now: int, depth: int) -> bool:
        return not self.is_violated(events, now) and not self.is_forced(events, now, max(0, depth))

    def _answers(self, events: tuple[Event, ...], now: int) -> Iterator[tuple[Event, ...]]:
        return ((*events, (now, self.drawn.out, tuple(v.items()))) for v in self.drawn.fallbacks.values())


def programs(text: str) -> tuple[Specification, list[Compiled], list[GuardEntry], list[GuardProgram]]:
    """The specification in `text`, its properties, and the regions and programs of its guards."""
    specification, problems = load_text(Source("guard", text))
    assert specification is not None, [(each.code, each.message) for each in problems]
    compiled, _ = compile_specification(specification, EPISODE, Budget())
    entries = guard_entries(specification, compiled)
    return specification, compiled, entries, guard_programs(specification, compiled, entries)
