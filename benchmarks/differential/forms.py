"""State predicates with the past, ages and news, and when they hold on a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from benchmarks.differential import past
from benchmarks.differential.samples import Run
from benchmarks.differential.values import Key, Value
from ltlc.frontend.syntax import tree as s


@dataclass(frozen=True)
class Leaf:
    """What is read at each step, and held."""

    of: Value
    asks_openings: bool
    number: int
    keys: frozenset[Key] = frozenset()
    is_computed: bool = False


@dataclass(frozen=True)
class News:
    """`new s`."""

    topic: str


@dataclass(frozen=True)
class Age:
    """`age(s) <= duration`."""

    topic: str
    duration: int


@dataclass(frozen=True)
class Past:
    """An operator of the past."""

    keyword: str
    arguments: tuple[Form, ...]
    bound: int | None


@dataclass(frozen=True)
class Count:
    """`once p N times`; a rate is `presumed` at first."""

    of: Form
    times: int
    bound: int | None
    presumed: bool = False


@dataclass(frozen=True)
class Logic:
    """A connective of one or two."""

    of: Callable[..., bool]
    arguments: tuple[Form, ...]


Form = Leaf | News | Age | Past | Count | Logic
"""A state predicate."""


def is_untimed(node: s.Node) -> bool:
    """Whether neither the past nor messages are asked for, but for those on which values are taken."""
    if isinstance(node, s.Past | s.News | s.Rate) or _is_age(node):
        return False
    inside = (node.signal,) if isinstance(node, s.Latch) else s.children(node)
    return all(map(is_untimed, inside))


def _is_age(node: s.Node) -> bool:
    return isinstance(node, s.Call) and node.function.text == "age"


def is_state(node: s.Node) -> bool:
    return not any(isinstance(part, s.Temporal | s.Within) for part, _ in s.walk(node))


def asks_openings_in(form: Form) -> bool:
    if isinstance(form, Leaf):
        return form.asks_openings
    return isinstance(form, Past | Logic) and any(asks_openings_in(each) for each in form.arguments)


def parts(form: Form) -> Iterator[Form]:
    """What a predicate is put together of by connectives."""
    if isinstance(form, Logic):
        for each in form.arguments:
            yield from parts(each)
    else:
        yield form


def value(form: Form, holds: Mapping[Form, bool]) -> bool:
    """Whether it holds, given which of its parts do."""
    return bool(form.of(*(value(each, holds) for each in form.arguments))) if isinstance(form, Logic) else holds[form]


def is_of_messages(form: Form) -> bool:
    """Whether it cannot hold without news, by what holds and not by its form."""
    found = list(dict.fromkeys(parts(form)))
    news: dict[Form, bool] = {part: False for part in found if isinstance(part, News)}
    others = [part for part in found if part not in news]
    return not any(
        value(form, {**news, **dict(zip(others, each, strict=True))})
        for each in product((False, True), repeat=len(others))
    )


def truth(form: Form, run: Run, on: Sequence[past.Segment], began: int) -> past.Truth:
    """When a state predicate that does not look at openings holds."""
    match form:
        case Leaf(_, _, number):
            return past.constant(on, [step.truths[number] for step in run.steps])
        case News(topic):
            return past.news(on, [topic in step.news for step in run.steps])
        case Age(topic, duration):
            return past.age_at_most(on, run.heard.get(topic, []), began, duration)
        case Logic(of, arguments):
            return past.combined(of, *(truth(each, run, on, began) for each in arguments))
        case Count(of, times, bound, presumed):
            return past.counted(truth(of, run, on, began), is_of_messages(of), times, bound, presumed)
        case Past(keyword, arguments, bound):
            inner = [truth(each, run, on, began) for each in arguments]
            match keyword:
                case "previously":
                    return past.previously(inner[0])
                case "once":
                    return past.once(inner[0], bound)
                case "historically":
                    return past.historically(inner[0], bound)
                case _:
                    return past.since(inner[0], inner[1], bound)
