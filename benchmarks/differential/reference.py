"""The reference: what the properties of a specification are on a recording, from `docs/language.md` alone.

It shares with ltlc the parser, and nothing that comes after.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from operator import and_, not_, or_
from typing import Any, Protocol, TypeVar

from benchmarks.differential import judge, past
from benchmarks.differential.arrivals import Trial, Unit
from benchmarks.differential.forms import (
    Age,
    Count,
    Form,
    Leaf,
    Logic,
    News,
    Past,
    asks_openings_in,
    is_state,
    is_untimed,
    truth,
)
from benchmarks.differential.names import Said, nanoseconds, number, said
from benchmarks.differential.samples import Reads, Recording, Run, ended, renewed, run_of
from benchmarks.differential.values import Computed, Frame, Key, Latched, NoValueError, Reader
from ltlc.frontend.syntax import tree as s

Made = TypeVar("Made")

SOME = 50
"""So many instants are judged at first, and more if none of these has a permanent verdict, which nothing changes."""


@dataclass
class Property:
    """A property, read: its state predicates, its bounds, and what it takes from a recording.

    `waits` is the time after which all intervals have begun that begin with the run.
    """

    names: Said
    tree: s.Node
    forms: dict[tuple[int, int, int], Form] = field(default_factory=dict)
    bounds: set[int] = field(default_factory=set)
    waits: int = 0
    keys: set[Key] = field(default_factory=set)
    made: dict[str, Latched | Computed] = field(default_factory=dict)
    topics: set[str] = field(default_factory=set)
    ages: dict[str, set[int]] = field(default_factory=dict)
    asked: set[int] = field(default_factory=set)
    leaves: list[Leaf] = field(default_factory=list)
    scopes: dict[int, int] = field(default_factory=dict)
    units: set[Unit] = field(default_factory=set)
    looked_back: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._part(self.tree, _Reading(self), False, 1, 0)

    @cached_property
    def reads(self) -> Reads:
        """What is read."""
        kept = {key for key in self.keys if key[0] in self.looked_back}
        literals = (part for part, _ in s.walk(self.tree) if isinstance(part, s.NumberLiteral | s.StringLiteral))
        constants = {part.value if isinstance(part, s.StringLiteral) else number(part) for part in literals}
        trial = Trial(list(self._predicates()), self.names, constants, self.made)
        excused = frozenset(unit for unit in self.units if not unit & kept and trial.is_excused(unit))
        return Reads(frozenset(self.keys), frozenset(self.topics), self.names, self.units - excused, excused, self.made)

    def _predicates(self) -> Iterator[Form]:
        """The state predicates, and the operands of past operators in them."""
        inside = {id(each) for form in self.forms.values() if isinstance(form, Logic) for each in form.arguments}
        return (form for form in self.forms.values() if id(form) not in inside)

    @property
    def asks_news_or_previous(self) -> bool:
        """Whether something holds for one nanosecond: news, or the moment after a change."""
        forms = list(self.forms.values())
        return any(isinstance(f, News) or (isinstance(f, Past) and f.keyword == "previously") for f in forms)

    def form(self, node: s.Node, favour: int, scope: int) -> Form:
        """A state predicate, which is known by its place, on its side of negations and in its scope."""
        key = (id(node), favour, scope)
        if key not in self.forms:
            self.forms[key] = self._form(node, favour, scope)
        return self.forms[key]

    def _form(self, node: s.Node, favour: int, scope: int) -> Form:
        if is_untimed(node) and not isinstance(node, s.Connective | s.Negation):
            reader = Reader(self.names, scope, favour, made=self.made)
            computed = any(_is_computed(part) for part, _ in s.walk(node))
            asked = reader.predicate(node)
            found = Leaf(asked, bool(reader.scopes), len(self.leaves), frozenset(reader.keys), computed)
            self.asked |= reader.scopes
            self.keys |= reader.keys
            self.units |= reader.units
            self.looked_back |= reader.past
            self.leaves.append(found)
            return found
        match node:
            case s.Negation(_, operand):
                return Logic(not_, (self.form(operand, -favour, scope),))
            case s.Connective(_, left, operator, right):
                sides = (
                    self.form(left, -favour if operator.text == "implies" else favour, scope),
                    self.form(right, favour, scope),
                )
                of = {"and": and_, "or": or_, "implies": lambda a, b: not a or b}[operator.text]
                return Logic(of, sides)
            case s.News(_, signal):
                return News(self._topic(signal))
            case s.Past(_, _, (counted,), bound, s.NumberLiteral() as times):
                within = None if bound is None else nanoseconds(bound.duration)
                return Count(self.form(counted, favour, scope), int(times.text), within)
            case s.Rate(_, signal, operator, hertz, time):
                within = nanoseconds(time)
                messages = int(Fraction(hertz.text) * within / 10**9)
                rate = Count(News(self._topic(signal)), messages, within, presumed=True)
                return rate if operator.text == ">=" else Logic(not_, (rate,))
            case s.Past(_, keyword, arguments, bound):
                inner = tuple(self.form(each, favour, scope) for each in arguments)
                return Past(keyword.text, inner, None if bound is None else nanoseconds(bound.duration))
            case s.Comparison(_, s.Call(_, _, (signal,)), operator, right):
                duration, topic = nanoseconds(right), self._topic(signal)
                fresh = Age(topic, duration - (operator.text in ("<", ">=")))
                self.ages.setdefault(topic, set()).add(fresh.duration)
                return fresh if operator.text in ("<", "<=") else Logic(not_, (fresh,))
            case _:
                raise AssertionError(node)

    def _topic(self, signal: s.Node) -> str:
        assert isinstance(signal, s.Reference)
        name = signal.name.text
        of = self.names.signals[name if name in self.names.signals else f"{name}.position.x"]
        assert of.topic is not None
        self.topics.add(of.topic)
        return of.topic

    def _part(self, node: s.Node, make: _Maker[Made], is_now: bool, favour: int, scope: int) -> Made:
        """A part of the property, made by `make`; directly under a keyword that goes from step to step `is_now`."""
        if is_state(node):
            now = make.now(self.form(node, favour, scope))
            return now if is_now else make.always(now, False)
        match node:
            case s.Negation(_, operand):
                return make.negation(self._part(operand, make, is_now, -favour, scope))
            case s.Connective(_, left, operator, right):
                flipped = -favour if operator.text == "implies" else favour
                a = self._part(left, make, is_now, flipped, scope)
                b = self._part(right, make, is_now, favour, scope)
                if operator.text == "implies":
                    return make.both(make.negation(a), b, True)
                return make.both(a, b, operator.text == "or")
            case s.Within(_, time, body):
                return make.within(*_period(time), self._part(body, make, is_now, favour, scope))
            case s.Temporal(_, keyword, arguments, bound):
                found = self._temporal(node, keyword.text, arguments, make, favour, scope)
                return found if bound is None else make.within(*_period(bound.duration), found)
            case _:
                raise AssertionError(node)

    def _temporal(
        self, node: s.Node, keyword: str, arguments: Sequence[s.Node], make: _Maker[Made], favour: int, scope: int
    ) -> Made:
        mine = self.scopes.setdefault(id(node), len(self.scopes) + 1)
        last = arguments[-1]
        match keyword:
            case "always":
                return make.always(self._part(last, make, True, favour, scope), False)
            case "eventually":
                return make.always(self._part(last, make, True, favour, scope), True)
            case "never":
                return make.always(make.negation(self._part(last, make, True, -favour, scope)), False)
            case "initially":
                return make.initially(self.form(last, favour, scope))
            case "after":
                event = self.form(arguments[0], -favour, scope)
                return make.after(event, self._part(last, make, False, favour, mine), mine)
            case "until":
                return make.until(self.form(arguments[0], favour, scope), self._part(last, make, False, favour, scope))
            case "after_until":
                opens, closes = self.form(arguments[0], -favour, scope), self.form(arguments[1], favour, mine)
                return make.after_until(opens, closes, self._part(last, make, False, favour, mine), mine)
            case _:
                raise AssertionError(keyword)

    def run(self, recording: Recording) -> Run:
        """Its steps on a recording."""
        return run_of(self.reads, recording, self._truths)

    def _truths(self, samples: Mapping[Key, Any]) -> list[bool] | None:
        """What holds of the leaves; those that look at openings are drawn so that they have a value, and come later."""
        frame = Frame(samples)
        try:
            return [not leaf.asks_openings and _holds(leaf, frame) for leaf in self.leaves]
        except NoValueError:
            return None

    def verdicts(self, run: Run, recording: Recording) -> tuple[judge.Instants, list[str]]:
        """The instants that matter, up to one with a permanent verdict, and the verdict after each."""
        held = renewed(run, self.ages, recording.begin)
        on = list(pairwise([*(step.time for step in held.run.steps), recording.end]))
        truths = {id(form): truth(form, held.run, on, recording.begin) for form in self._whole()}
        segments = self._places(on, truths.values())
        places = [(held.numbers[k], time) for k, time in segments]
        looked = SOME
        while True:
            instants = judge.Instants(places[:looked], run.steps, segments[:looked])
            root = self._part(self.tree, _Making(self, instants, truths), False, 1, 0)
            found = judge.verdicts(root)
            if looked >= len(places) or found[-1] in ("violated", "satisfied"):
                return instants, found
            looked *= 4

    def _whole(self) -> Iterator[Form]:
        return (form for form in self.forms.values() if not asks_openings_in(form))

    def _places(self, on: Sequence[past.Segment], truths: Any) -> list[judge.Instant]:
        """The instants to be looked at."""
        changes: list[set[int]] = [{start} for start, _ in on]
        for each in truths:
            for k, pieces in enumerate(each.pieces):
                changes[k].update(start for start, _ in pieces)
        late = {c + d + more for d in self.bounds for of in changes for c in of for more in (0, 1)}
        ordered, found = sorted(late), []
        place = 0
        for k, (start, last) in enumerate(on):
            here = set(changes[k])
            if (self.bounds or self.asked) and last > start:
                here |= {start + 1}
            if self.asked:
                here |= {c + 1 for c in changes[k] if c < last}
            while place < len(ordered) and ordered[place] < start:
                place += 1
            at = place
            while at < len(ordered) and ordered[at] <= last:
                here.add(ordered[at])
                at += 1
            if self.bounds:
                here |= {c - 1 for c in here if c > start} | {last}
            found += [(k, time) for time in sorted(here)]
        return found


def _holds(leaf: Leaf, frame: Frame) -> bool:
    """Whether a leaf holds; not where samples that it reads have not come. Raises NoValueError."""
    try:
        holds = bool(leaf.of(frame))
    except KeyError:
        return False
    return holds and frame.samples.keys() >= leaf.keys


def _is_computed(node: s.Node) -> bool:
    """Whether ltlc takes it for something that may hold or not: what is computed, or compared with itself."""
    match node:
        case s.Comparison(_, s.Reference(_, left), _, s.Reference(_, right)):
            return left.text == right.text
        case _:
            return isinstance(node, s.Arithmetic | s.Call | s.Quantified)


def _period(time: s.Node) -> tuple[int, int]:
    """From when to when a bound lasts."""
    if isinstance(time, s.Interval):
        return nanoseconds(time.start), nanoseconds(time.end)
    return 0, nanoseconds(time)


class _Maker(Protocol[Made]):
    """Makes the parts of a property."""

    def now(self, form: Form, /) -> Made: ...
    def initially(self, form: Form, /) -> Made: ...
    def always(self, inner: Made, is_some: bool, /) -> Made: ...
    def negation(self, inner: Made, /) -> Made: ...
    def both(self, left: Made, right: Made, is_or: bool, /) -> Made: ...
    def within(self, start: int, end: int, inner: Made, /) -> Made: ...
    def after(self, event: Form, body: Made, scope: int, /) -> Made: ...
    def until(self, event: Form, body: Made, /) -> Made: ...
    def after_until(self, opens: Form, closes: Form, body: Made, scope: int, /) -> Made: ...


@dataclass
class _Reading:
    """Takes note of what a property has: makes nothing."""

    of: Property

    def within(self, start: int, end: int, inner: None) -> None:
        self.of.bounds.update({start, end} - {0})
        self.of.waits += start

    def now(self, *_: Any) -> None: ...

    always = negation = both = initially = after = until = after_until = now


@dataclass
class _Making:
    """Makes the parts that are judged."""

    of: Property
    on: judge.Instants
    truths: Mapping[int, past.Truth]

    def state(self, form: Form) -> judge.State:
        places, steps = self.on.places, self.on.steps

        def holds(i: int, opened: judge.Opened, form: Form = form) -> bool:
            if id(form) in self.truths:
                return self.truths[id(form)].at(*self.on.segments[i])
            if isinstance(form, Leaf):
                frame = judge.frame(steps, places[i][0], opened)
                return frame.samples.keys() >= form.keys and bool(form.of(frame))
            assert isinstance(form, Logic), form
            return form.of(*(holds(i, opened, each) for each in form.arguments))

        return judge.State(self.on, holds)

    def now(self, form: Form) -> judge.Part:
        return judge.Now(self.on, self.state(form))

    def initially(self, form: Form) -> judge.Part:
        return judge.Initially(self.on, self.state(form))

    def always(self, inner: judge.Part, is_some: bool) -> judge.Part:
        return judge.Always(self.on, inner, is_some)

    def negation(self, inner: judge.Part) -> judge.Part:
        return judge.Not(self.on, inner)

    def both(self, left: judge.Part, right: judge.Part, is_or: bool) -> judge.Part:
        return judge.Both(self.on, left, right, is_or)

    def within(self, start: int, end: int, inner: judge.Part) -> judge.Part:
        return judge.Within(self.on, start, end, inner)

    def after(self, event: Form, body: judge.Part, scope: int) -> judge.Part:
        return judge.After(self.on, self.state(event), body, self._asked(scope))

    def until(self, event: Form, body: judge.Part) -> judge.Part:
        return judge.Until(self.on, self.state(event), body)

    def after_until(self, opens: Form, closes: Form, body: judge.Part, scope: int) -> judge.Part:
        return judge.AfterUntil(self.on, self.state(opens), self.state(closes), body, self._asked(scope))

    def _asked(self, scope: int) -> int | None:
        return scope if scope in self.of.asked else None


@dataclass(frozen=True)
class Judged:
    """What a property is on a recording: its changes of verdict with the number of steps so far, and how it ends."""

    changes: list[tuple[int, str]]
    steps: int
    invalid: int
    run: Run
    instants: Sequence[judge.Instant]
    verdicts: Sequence[str]
    is_news_or_previous: bool = False

    @property
    def verdict(self) -> str:
        """At the end."""
        return self.verdicts[-1] if self.verdicts else "not_started"

    @property
    def at_steps(self) -> list[str]:
        """The verdict after each step, up to a permanent one."""
        seen: dict[int, str] = {}
        for (k, _), verdict in zip(self.instants, self.verdicts, strict=True):
            seen.setdefault(k, verdict)
        return list(seen.values())


def properties(text: str) -> dict[str, Property]:
    """The properties of a specification."""
    names = said(text)
    return {label: Property(names, tree) for label, tree in names.properties.items()}


def judged(of: Mapping[str, Property], recording: Recording) -> dict[str, Judged]:
    """Every property on a recording."""
    recording = whole_run(of, recording)
    return {label: judged_alone(each, recording) for label, each in of.items()}


def whole_run(of: Mapping[str, Property], recording: Recording) -> Recording:
    """What there is of a recording up to the end of the run, `_timeout_` after the first step of any property."""
    timeout = next(iter(of.values())).names.timeout
    if timeout is None:
        return recording
    runs = [each.run(recording) for each in of.values()]
    return ended(recording, min((run.steps[0].time for run in runs if run.steps), default=None), timeout)


def judged_alone(of: Property, recording: Recording) -> Judged:
    """A property on the whole of a recording."""
    return _judged(of, of.run(recording), recording)


def _judged(of: Property, run: Run, recording: Recording) -> Judged:
    if not run.steps:
        return Judged([], 0, run.invalid, run, [], [])
    instants, verdicts = of.verdicts(run, recording)
    changes: list[tuple[int, str]] = []
    for (_, time), verdict in zip(instants.places, verdicts, strict=True):
        if not changes or changes[-1][1] != verdict:
            changes.append((time, verdict))
    return Judged(changes, len(run.steps), run.invalid, run, instants.places, verdicts, of.asks_news_or_previous)
