"""Two guards side by side: a shortest run after which one lets a command through that the other does not.

Both are followed in one game, in which the properties of both are: from where both may rest, by what comes, and by what
both let through, so that they differ for the first time at the command that is found.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

from ltlc.analysis.errors import NotDecidedError
from ltlc.analysis.examples import Example, rows_of, shown
from ltlc.analysis.guards.game import Game, Step
from ltlc.analysis.guards.passing import condition_text, move_of, rows_along, word_of
from ltlc.analysis.guards.plays import Turn, letter_of
from ltlc.analysis.guards.reasons import Reasons, setting_of
from ltlc.analysis.guards.solution import MOST_PLACES
from ltlc.analysis.thresholds import Values
from ltlc.analysis.wording import listed
from ltlc.dataclass import dataclass
from ltlc.semantics.arenas import Joint, Outcome, Place
from ltlc.semantics.diagrams import Diagram, of_predicate
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.ltl import FALSE
from ltlc.semantics.timed_atoms import Age
from ltlc.semantics.words import Letter
from ltlc.specification.arenas import Property, arena_of, conditions_held, is_in_game
from ltlc.specification.atoms import Atom
from ltlc.specification.expressions import Current, Field, operands
from ltlc.specification.expressions import reads as reads_in
from ltlc.specification.fallbacks import value_in
from ltlc.specification.guards import Fallback, Guard
from ltlc.specification.specification import topics_of


@dataclass(frozen=True)
class Side:
    """One of two guards: the `name` of its file, those in its game, and the properties of its file."""

    name: str
    guards: tuple[Guard, ...]
    properties: tuple[Property, ...]
    reasons: Reasons

    @property
    def labels(self) -> frozenset[str]:
        """The labels of the properties in its game."""
        return frozenset(part.label for part in self.reasons.solution.game.arena.parts)


@dataclass(frozen=True)
class Difference:
    """A run at whose end the guard of one file lets a command through, and the other one's does not, for a `reason`.

    Its `events` are messages on `topics`, or time passes, where that is None; each comes after one of the `delays`. The
    first row of the `example` is before. A run found `by_trying` has times instead.
    """

    passes: str
    refuses: str
    reason: str
    events: tuple[str, ...]
    topics: tuple[str | None, ...]
    delays: tuple[Nanoseconds, ...]
    example: Example | None
    by_trying: bool = False


class _View:
    """One side as it is seen in the game of both: where its guards rest, and why they do not."""

    def __init__(self, game: Game, side: Side, parts: Sequence[int], names: Mapping[str, str]) -> None:
        """`parts` are the numbers of its properties there, `names` those of its atoms."""
        self.side, self._game, self._parts, self._names = side, game, parts, names
        self._region = side.reasons.solution.region()
        self._levels = {name: game.atoms.index(other) for name, other in names.items()}
        self._arena = side.reasons.solution.game.arena
        self._resting: dict[Joint, Diagram] = {}

    def at(self, joint: Joint) -> Joint:
        """Where it is, of where both are."""
        sent = None
        if joint.sent is not None:
            counts = dict(zip(self._game.arena.outs, joint.sent, strict=True))
            sent = tuple(min(counts[o], most) for o, most in zip(self._arena.outs, self._arena.most, strict=True))
        return Joint(sent, tuple(joint.standings[n] for n in self._parts))

    def resting(self, joint: Joint) -> Diagram:
        """The letters at which it may be silent."""
        own = self.at(joint)
        if own not in self._resting:
            formula = self._region.rests.get(own, FALSE)
            is_over = self._arena.outcome(own) is not None
            self._resting[own] = of_predicate(FALSE if is_over else formula, self._game.diagrams, self._levels)
        return self._resting[own]

    def reason(self, joint: Joint, letter: Letter) -> str:
        """Why it does not let a command through that leads there."""
        own = self.at(joint)
        pairs = list(zip(self._arena.parts, own.standings, strict=True))
        violated = [part.label for part, at in pairs if at is Outcome.VIOLATED]
        if violated:
            return f"it would violate {listed([f'`{label}`' for label in violated])}"
        held = frozenset(name for name, other in self._names.items() if other in letter)
        play = self.side.reasons(own, held, frozenset(), {})
        if play is None:
            return "a violation could no longer be avoided after it"
        return f"a violation of {play.labels} could no longer be avoided after it: {play.text(whole=False)}"


class Beside:
    """The guards of two files that send on `out`, in one game. Raises NotDecidedError."""

    def __init__(self, left: Side, right: Side, out: str) -> None:
        self._out = out
        sides = (left, right)
        self._guards = guards = _merged(left.guards, right.guards)
        stated = [(side, each) for side in sides for each in side.properties]
        self._conditions = conditions = conditions_held(guards, (each.specification for _, each in stated))
        self._setting = setting_of(conditions, is_known=True)
        self._game = Game(arena_of(guards, (each for _, each in stated)))
        kept = [(side, each.specification.label) for side, each in stated if is_in_game(each.specification, guards)]
        self._views = [
            _View(
                self._game,
                side,
                [n for n, (of, label) in enumerate(kept) if of is side and label in side.labels],
                _names(side, conditions, self._game),
            )
            for side in sides
        ]
        if self._game.arena.loose:
            raise NotDecidedError("one of them counts, or reads values at openings")
        self.is_partial = False
        """Whether runs were left out in which clocks run side by side."""
        self._seen: dict[Joint, Diagram] = {}
        self._layers: list[dict[Joint, Diagram]] = []

    def differences(self) -> list[Difference]:
        """A shortest run for each side that lets a command through which the other one does not."""
        found: dict[str, Difference] = {}
        layer = {self._game.arena.start: self._game.possible}
        while layer and len(found) < 2:
            self._layers.append(layer)
            for joint, letters in layer.items():
                self._seen[joint] = self._game.any_of((letters, self._seen.get(joint, self._game.diagrams.false)))
            if len(self._seen) > MOST_PLACES:
                raise NotDecidedError(f"the game of both has more than {MOST_PLACES:,} places")
            self._look(found, len(self._layers), begun=True)
            layer = self._next(layer)
        for depth in range(1, len(self._layers) + 1):
            self._look(found, depth, begun=False)
        return list(found.values())

    def _look(self, found: dict[str, Difference], depth: int, *, begun: bool) -> None:
        """Look for what was not `found` yet in the layer so deep: once all have `begun`, or where something begins."""
        for one, other in (self._views, self._views[::-1]):
            if one.side.name not in found:
                difference = self._first(self._layers[:depth], one, other, begun)
                found |= {} if difference is None else {one.side.name: difference}

    def _first(
        self, layers: Sequence[Mapping[Joint, Diagram]], one: _View, other: _View, begun: bool
    ) -> Difference | None:
        """A command that `one` lets through and the `other` does not, from the last of the `layers`."""
        d = self._game.diagrams
        for joint, letters in layers[-1].items():
            if joint.sent is None or (Outcome.WAITING not in joint.standings) != begun:
                continue
            for step, led in self._after(joint, letters, self._out):
                if Outcome.WAITING in step.joint.standings:
                    continue
                passes = d.conjunction(one.resting(step.joint), d.negation(other.resting(step.joint)))
                letter = letter_of(self._game, d.conjunction(led, passes), {})
                if letter is not None:
                    return self._difference(layers, joint, Turn(self._out, step, letter, ()), one, other)
        return None

    def _next(self, layer: Mapping[Joint, Diagram]) -> dict[Joint, Diagram]:
        """Where both come next, by what comes and what both let through, that was not seen before."""
        d, found = self._game.diagrams, dict[Joint, Diagram]()
        for joint, letters in layer.items():
            for topic in self._topics(joint):
                for step, led in self._after(joint, letters, topic):
                    good = d.conjunction(led, self._both(joint, step, topic))
                    seen = self._game.any_of(of.get(step.joint, d.false) for of in (self._seen, found))
                    new = d.conjunction(good, d.negation(seen))
                    if self._game.exists(new):
                        found[step.joint] = self._game.any_of((new, found.get(step.joint, d.false)))
        return found

    def _topics(self, joint: Joint) -> tuple[str | None, ...]:
        sending = () if joint.sent is None else self._game.arena.outs
        return (None, *self._game.arena.others, *sending)

    def _after(self, joint: Joint, letters: Diagram, topic: str | None) -> Iterator[tuple[Step, Diagram]]:
        """The steps by a message on `topic`, or by time, with what is held after them."""
        held = self._game.after_message(topic, letters)
        for step, led in self._game.steps(joint, topic).items():
            yield step, self._game.all_of((held, led, self._game.possible))

    def _both(self, joint: Joint, step: Step, topic: str | None) -> Diagram:
        """The letters at which both sides do the same: they are silent, let a command through, or begin alike."""
        if not self._may_have_begun(joint, step.joint) or (topic is None and not self._may_pass(joint, step)):
            return self._game.diagrams.false
        resting = self._game.all_of(view.resting(step.joint) for view in self._views)
        if topic not in self._game.arena.outs or Outcome.WAITING not in step.joint.standings:
            return resting
        if topic not in self._common:
            return self._game.diagrams.false
        return self._game.diagrams.conjunction(resting, self._common[topic][0])

    def _may_have_begun(self, before: Joint, joint: Joint) -> bool:
        """Whether some topics have spoken on which all begin that have: what waits for no more than another, has.

        What begins does so in time: no clock has passed a bound before.
        """
        outs = self._game.arena.outs
        begun = (at for was, at in zip(before.standings, joint.standings, strict=True) if was is Outcome.WAITING)
        if any(state.passed for at in begun if isinstance(at, Place) for state in at.clocks.states):
            return False
        pairs = zip(self._game.arena.parts, joint.standings, strict=True)
        waits = [(part.waits, at is Outcome.WAITING) for part, at in pairs if part.waits.isdisjoint(outs)]
        return not any(
            is_waiting and not has_begun and own <= other for own, is_waiting in waits for other, has_begun in waits
        )

    def _may_pass(self, joint: Joint, step: Step) -> bool:
        """Whether it is known that the clocks pass first that do: all that run have started with the same event."""
        parts, running = self._game.arena.parts, dict[tuple[int, int], tuple[object, int]]()
        for k, at in ((k, at) for k, at in enumerate(joint.standings) if isinstance(at, Place)):
            for n, tracker in enumerate(parts[k].time.trackers):
                state = at.clocks.states[n]
                if tracker.bounds and tracker.is_running(state):
                    subject = tracker.subject
                    event = subject.news if isinstance(subject, Age) else (subject, parts[k].waits)
                    running[k, n] = event, tracker.bounds[state.passed]
        first = min((bound for _, bound in running.values()), default=0)
        is_known = len({event for event, _ in running.values()}) <= 1
        self.is_partial |= bool(step.passing) and not is_known
        passing = {of for of, (_, bound) in running.items() if bound == first}
        return not step.passing or (is_known and step.passing == passing)

    @cached_property
    def _common(self) -> dict[str, tuple[Diagram, Fallback]]:
        """By topic the first fallback that both sides have, with the letters after it."""
        found: dict[str, tuple[Diagram, Fallback]] = {}
        left, right = ({(g.out, content_of(f)) for g in v.side.guards for f in g.fallbacks} for v in self._views)
        sendings = iter(self._game.arena.fallbacks)
        for out, fallback in ((guard.out, fallback) for guard in self._guards for fallback in guard.fallbacks):
            effect = next(sendings).effect
            if (out, content_of(fallback)) in left & right:
                known = [(a, holds) for a, holds in effect.items() if isinstance(holds, bool)]
                d = self._game.diagrams
                led = self._game.all_of(self._game.atom(a) if h else d.negation(self._game.atom(a)) for a, h in known)
                found.setdefault(out, (led, fallback))
        return found

    def _difference(
        self, layers: Sequence[Mapping[Joint, Diagram]], joint: Joint, last: Turn, one: _View, other: _View
    ) -> Difference:
        turns = [last]
        before = self._before(layers[-1][joint], last)
        for layer in layers[-2::-1]:
            turn, joint, letter = self._led(layer, joint, before)
            turns.insert(0, turn)
            before = letter
        arena = self._game.arena
        events = [move_of(arena, turn, {}).event for turn in turns]
        events = [self._sent(turn) or event for turn, event in zip(turns, events, strict=True)]
        reason = other.reason(last.step.joint, last.letter)
        example = self._example(before, turns, events)
        events[-1] += f" where {self._words(turns[-1].letter)}"
        topics, delays = tuple(turn.topic for turn in turns), tuple(map(self._delay, turns))
        return Difference(one.side.name, other.side.name, reason, tuple(events), topics, delays, example)

    def _delay(self, turn: Turn) -> Nanoseconds:
        """How long before a turn nothing comes: until the clocks have passed their bounds that do."""
        parts = self._game.arena.parts
        return 1 + max((parts[k].time.trackers[n].bounds[-1] for k, n in turn.step.passing), default=0)

    def _words(self, letter: Letter) -> str:
        """What the conditions of properties say of a command."""
        stated = {atom.name for view in self._views for p in view.side.properties for atom in p.specification.atoms}
        own = [a for a in self._conditions if a in stated and self._out in self._game.arena.read.get(a, ())]
        return listed([condition_text(a, self._conditions, holds=a in letter) for a in own] or ["anything holds"])

    def _sent(self, turn: Turn) -> str:
        """What a turn is called at which something leaves both, or one, of them; empty if none does."""
        if turn.topic not in self._game.arena.outs:
            return ""
        if Outcome.WAITING in turn.step.joint.standings:
            return f"`{self._common[turn.topic][1].name}` on {turn.topic}, with which both begin"
        return f"a command on {turn.topic}"

    def _before(self, letters: Diagram, turn: Turn) -> Letter:
        """What may have been held before a turn, of these letters."""
        arena = self._game.arena
        kept = {a for a, of in arena.read.items() if turn.topic not in of} - arena.loose
        found = letter_of(self._game, letters, {atom: atom in turn.letter for atom in kept})
        assert found is not None, "there is a way to what was reached"
        return found

    def _led(self, layer: Mapping[Joint, Diagram], joint: Joint, letter: Letter) -> tuple[Turn, Joint, Letter]:
        """A turn that leads to where `letter` is held at `joint`, and from where."""
        d = self._game.diagrams
        for start, letters in layer.items():
            for topic in self._topics(start):
                for step, led in self._after(start, letters, topic):
                    good = d.conjunction(led, self._both(start, step, topic))
                    is_it = {atom: atom in letter for atom in self._game.atoms}
                    if step.joint == joint and letter_of(self._game, good, is_it) is not None:
                        turn = Turn(topic, step, letter, ())
                        return turn, start, self._before(letters, turn)
        raise AssertionError("there is a way to what was reached")

    def _begun(self, turn: Turn, row: Values) -> Values:
        """Values at a turn: of a fallback with which both begin, those that it has."""
        if turn.topic not in self._common or Outcome.WAITING not in turn.step.joint.standings:
            return row
        _, fallback = self._common[turn.topic]
        own = (read for read in row if isinstance(read, Current) and turn.topic in topics_of(read.signal))
        values = {read: value_in(fallback, read.signal) for read in own}
        return {**row, **{read: constant.value for read, constant in values.items() if constant is not None}}

    def _example(self, first: Letter, turns: Sequence[Turn], events: Sequence[str]) -> Example | None:
        reads = (r for a in self._setting.atoms for operand in operands(a.condition) for r in reads_in(operand))
        if not all(isinstance(read.signal.definition, Field) for read in reads):
            return None  # what is computed follows from samples before, too
        word = word_of(self._setting, first, turns)
        for linked in (False, True):  # as if each message brought all signals: a way to numbers, which are checked
            found = rows_of(replace(self._setting, linked=linked), word, None)
            if found is not None:
                found = [found[0], *(self._begun(turn, row) for turn, row in zip(turns, found[1:], strict=True))]
            rows = None if found is None else rows_along(self._setting, first, turns, found, linked=True)
            if rows is not None:
                values = shown(self._setting, rows)
                remarks = ("before", *events[:-1], self._sent(turns[-1]))
                return Example("", tuple(values[0]), tuple(tuple(row.values()) for row in values), remarks)
        return None


def content_of(fallback: Fallback) -> frozenset[object]:
    """What only equal fallbacks have."""
    return frozenset(fallback.values.items())


def _merged(left: Sequence[Guard], right: Sequence[Guard]) -> tuple[Guard, ...]:
    """The guards of both, those on one topic as one with the fallbacks of both."""
    found = {guard.out: guard for guard in left}
    for guard in right:
        own = found.setdefault(guard.out, guard)
        found[guard.out] = replace(own, fallbacks=(*own.fallbacks, *(f for f in guard.fallbacks if own is not guard)))
    return tuple(found.values())


def _names(side: Side, conditions: Mapping[str, Atom], game: Game) -> dict[str, str]:
    """What the atoms of one side are called in the game of both. Raises NotDecidedError."""
    found = {name: name for name in side.reasons.solution.game.atoms}
    for name, atom in side.reasons.conditions.items():
        same = (other for other, one in conditions.items() if one.condition == atom.condition)
        if (other := next(same, None)) is None:
            raise NotDecidedError(f"`{name}` is not the same condition in both files")
        found[name] = other
    return {name: other for name, other in found.items() if other in game.atoms}
