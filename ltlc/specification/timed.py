"""Timed atoms by their names: each is called as the language writes it, so that equal names are equal definitions."""

from __future__ import annotations

from ltlc.semantics.diagrams import Diagrams, of_predicate
from ltlc.semantics.durations import Nanoseconds, duration_text
from ltlc.semantics.ltl import Formula, atoms
from ltlc.semantics.timed_atoms import Age, Historically, News, Occurred, Once, Previously, Since, news_of
from ltlc.specification.expressions import New, Signal
from ltlc.specification.text import Strength, predicate_text, text

_SO_FAR = " so far"
"""What distinguishes a count without a bound from its `once`."""


def news(signal: Signal) -> News:
    """`new signal`."""
    return News(text(New(signal)))


def message(signal: Signal) -> News:
    """A message on the topic of `signal`, from which ages count: unlike `new signal`, also where it makes no step."""
    return News(f"message on {signal.heard}")


def age(signal: Signal, duration: Nanoseconds, *, strictly: bool) -> Age:
    """`age(signal) <= duration`, or `<`."""
    name = f"age({signal.heard}) {'<' if strictly else '<='} {duration_text(duration)}"
    return Age(name, message(signal), duration - strictly)


def previously(operand: Formula) -> Previously:
    """`previously operand`."""
    return Previously(f"previously {predicate_text(operand, Strength.NOT)}", operand)


def once(operand: Formula, within: Nanoseconds | None) -> Once:
    """`once operand`, or `once operand within …`."""
    if isinstance(operand, Occurred) and operand.within is None and within is None:
        return Once(operand.name.removesuffix(_SO_FAR), operand, None)
    return Once(f"once {_bounded(operand, Strength.NOT, 'within', within)}", operand, within)


def count(operand: Formula, times: int, within: Nanoseconds | None) -> Occurred:
    """`once operand times times within …`; without a bound, the operand of the `once` that makes it stay."""
    counted = f"once {predicate_text(operand, Strength.ATOM)} {times} times"
    name = f"{counted}{_SO_FAR}" if within is None else f"{counted} within {duration_text(within)}"
    return Occurred(name, operand, times, within, not _needs_news(operand))


def rate(news: News, hertz: str, times: int, within: Nanoseconds) -> Occurred:
    """`rate(s) >= hertz Hz over …`: so many messages of `news`, or no more than that has passed."""
    name = f"rate({news.name.removeprefix('new ')}) >= {hertz} Hz over {duration_text(within)}"
    return Occurred(name, news, times, within, begins=False, presumed=True)


def has_news_apart(operand: Formula) -> bool:
    """Whether `operand` depends on news and can hold without any: then the end of news, which is no step, counts."""
    return bool(news_of(operand)) and not _needs_news(operand)


def _needs_news(operand: Formula) -> bool:
    diagrams = Diagrams()
    levels = {name: level for level, name in enumerate(atoms(operand))}
    silent = {levels[each.name]: False for each in news_of(operand)}
    return bool(silent) and diagrams.given(silent, of_predicate(operand, diagrams, levels)) == diagrams.false


def historically(operand: Formula, lasting: Nanoseconds | None) -> Historically:
    """`historically operand`, or `historically operand for …`."""
    return Historically(f"historically {_bounded(operand, Strength.NOT, 'for', lasting)}", operand, lasting)


def since(kept: Formula, start: Formula, within: Nanoseconds | None) -> Since:
    """`kept since start`, or `kept since start within …`."""
    left, right = predicate_text(kept, Strength.NOT), _bounded(start, Strength.NOT, "within", within)
    return Since(f"{left} since {right}", kept, start, within)


def _bounded(operand: Formula, context: Strength, keyword: str, duration: Nanoseconds | None) -> str:
    """`operand` and a bound after it, which must not be read as the bound of a keyword inside `operand`."""
    if duration is None:
        return predicate_text(operand, context)
    return f"{predicate_text(operand, Strength.ATOM)} {keyword} {duration_text(duration)}"
