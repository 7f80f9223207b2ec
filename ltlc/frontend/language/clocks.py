"""Bounds that one clock cannot measure: why, and another way to write what they probably mean."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.base.diagnostics import Help, Label
from ltlc.base.fixes import write, writing
from ltlc.frontend.language.built import Built
from ltlc.frontend.language.names import Checker
from ltlc.semantics import ltl
from ltlc.semantics import properties as p
from ltlc.semantics.diagrams import Diagrams, of_predicate
from ltlc.semantics.encodings import EPISODE, Encoding, ManyClocksError, encode
from ltlc.semantics.timed_atoms import News, Previously
from ltlc.specification.text import predicate_text
from ltlc.specification.timed import historically


def has_clocks(checker: Checker, built: Built, is_whole: bool) -> bool:
    """Whether every bound of a property has a clock; one that has none is reported. It may be that of an `each`."""
    bound = _without_clock(built.property, EPISODE)
    if bound is not None:
        _many_clocks(checker, _way(built, bound) or [built, built], is_whole)
        return False
    bound = _without_clock(built.property, checker.encoding)
    if bound is not None:
        _no_clock_of(checker, _way(built, bound) or [built])
        return False
    return True


def _without_clock(property_: p.Property, encoding: Encoding) -> p.Within | None:
    try:
        encode(property_, encoding)
    except ManyClocksError as error:
        return error.bound
    return None


def _way(built: Built, bound: p.Within) -> list[Built]:
    """The parts from the whole property down to `bound`; none if that is not written there, but an interval."""
    if built.node is bound:
        return [built]
    inside = next((way for part in built.parts if (way := _way(part, bound))), None)
    return [built, *inside] if inside else []


def _many_clocks(checker: Checker, way: Sequence[Built], is_whole: bool) -> None:
    bounded, around = way[-1], way[-2]
    written = checker.source.excerpt(bounded.span)
    message = f"`{written}` would need an unlimited number of clocks: one for each obligation that can be open at once"
    label = "can begin anew at each step, and no single event fulfils all that have begun"
    secondary = (Label(around.span, "here"),) if around.span != bounded.span else ()
    anew = _from_each_message(checker, way[0]) if is_whole else None
    help = anew or _with_the_past(way) or _in_a_response(checker, way)
    help = help or f"judge it once per episode, with one clock: `after_until BEGIN, END, {written}`"
    checker.report("LTL310", bounded.span, message, *secondary, label=label, help=help)


def _with_the_past(way: Sequence[Built]) -> str:
    """What lasts for some time, sought from each step on, is what has lasted for that time at some step."""
    keywords: dict[type, str] = {p.Eventually: "eventually", p.Never: "never"}
    keyword = keywords.get(type(way[-2].node))
    bounded = way[-1].node
    (body,) = way[-1].parts
    assert isinstance(bounded, p.Within)
    if keyword is None or bounded.start or not isinstance(body.node, p.Always | p.Never):
        return ""
    if not isinstance(body.node.operand, p.Now):
        return ""
    predicate = body.node.operand.predicate
    lasting = predicate if isinstance(body.node, p.Always) else ltl.Not(predicate)
    return f"write `{keyword} {historically(lasting, bounded.duration).name}`"


def _from_each_message(checker: Checker, whole: Built) -> Help | None:
    """The fix for a property of the rest of the run that is demanded at every message: `each new`."""
    match whole.node:
        case p.Always(p.Implies(p.Now(News() as trigger), body)):
            begin, then = (checker.source.excerpt(part.span) for part in whole.parts[0].parts)
            has_clock = _without_clock(p.After(trigger, body), EPISODE) is None
            if begin.startswith("new ") and has_clock and not _has_states(body):
                return write(writing(whole.span, f"each {begin}: {then}"))
        case _:
            pass
    return None


def _has_states(property_: p.Property) -> bool:
    """Whether a state predicate stands in it that no temporal keyword stands before."""
    match property_:
        case p.Now():
            return True
        case p.Not(operand):
            return _has_states(operand)
        case p.And(left, right) | p.Or(left, right) | p.Implies(left, right):
            return _has_states(left) or _has_states(right)
        case _:
            return False


def _in_a_response(checker: Checker, way: Sequence[Built]) -> str:
    """Of an answer to something that lasts, each stretch of it may be meant."""
    for built in reversed(way):
        match built.node:
            case p.Implies(p.Now(trigger)):
                begin, answer = predicate_text(trigger), checker.source.excerpt(built.parts[1].span)
                body = built.node.right
                if _without_clock(p.AfterUntil(trigger, ltl.Not(trigger), body), EPISODE) is not None:
                    return ""
                if not can_last(trigger):
                    return f"judge it once per episode, with one clock: `after_until {begin}, END, {answer}`"
                stretch = f"{begin}, {predicate_text(ltl.Not(trigger))}"
                return f"to judge each stretch of `{begin}` once, write `after_until {stretch}, {answer}`"
            case _:
                pass
    return ""


def can_last(predicate: ltl.Formula) -> bool:
    """Whether `predicate` can hold for longer than an instant: when news is over and `previously` has caught up."""
    held, diagrams = _held(predicate), Diagrams()
    levels = {atom: level for level, atom in enumerate(ltl.atoms(held))}
    return of_predicate(held, diagrams, levels) != diagrams.false


def _held(predicate: ltl.Formula) -> ltl.Formula:
    """What `predicate` is at an instant like the one before."""
    match predicate:
        case News():
            return ltl.FALSE
        case Previously():
            return _held(predicate.operand)
        case ltl.Not(operand):
            return ltl.Not(_held(operand))
        case ltl.And(left, right):
            return ltl.And(_held(left), _held(right))
        case ltl.Or(left, right):
            return ltl.Or(_held(left), _held(right))
        case _:
            return predicate


def _no_clock_of(checker: Checker, way: Sequence[Built]) -> None:
    message = f"`{checker.source.excerpt(way[-1].span)}` has no clock under the encoding `{checker.encoding.name}`"
    label = "this reading begins it anew at each step"
    help = "omit `--encoding`: `episode` judges each scope once, with one clock"
    checker.report("LTL326", way[-1].span, message, label=label, help=help)
