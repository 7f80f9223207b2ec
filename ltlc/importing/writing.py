"""Formulas of metric temporal logic as properties of the language."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import assert_never

from ltlc.dataclass import dataclass
from ltlc.importing import formulas as f
from ltlc.semantics.durations import Nanoseconds, duration_text


class UnsayableError(Exception):
    """The language has no property for a formula; the message says why."""


AT_POINTS = "read it at points (`--reading points`)"
NO_STEPS = f"over signals there is no next or previous position: {AT_POINTS}"
NO_CLOCK = f"under `always`, an interval that begins later needs positions: {AT_POINTS}"
NO_UNTIL = "the parts of an `until` must be conditions that the positions up to now decide"


@dataclass(frozen=True)
class Reading:
    """Formulas are read at points a `step` apart, where the file has a `_rate_`; or over signals, if that is None."""

    step: Nanoseconds | None

    def duration(self, bound: int) -> str:
        """A bound of a formula, as it is written."""
        return duration_text(bound * (self.step or 1))


_LOWEST, _IMPLIES, _OR, _AND, _UNARY, _TIGHT = range(6)
_Text = tuple[str, int]
"""A text, and how tightly its outermost operator binds."""


@dataclass(frozen=True)
class Writer:
    """Writes formulas, read as `reading` says. `mark` is a condition of which only matters that it has a value.

    Inside `after`, the run that a formula is about has `began` at some position: what is asked of earlier ones is asked
    of those since then.
    """

    reading: Reading
    mark: str
    began: f.Formula = f.TRUE

    def property(self, formula: f.Formula) -> str:
        """A property that holds of a run if `formula` holds at its first position. Raises UnsayableError."""
        if f.is_state(formula):
            return f"initially {self._state(formula, _UNARY)}"
        match formula:
            case f.Not(f.Until(f.Truth(), inner, start, stop)):
                return self._always(f.negated(inner), start, stop)
            case f.Until(f.Truth(), right, start, stop):
                return self._eventually(right, start, stop)
            case f.Not(f.Until(f.Not(q), f.And(left, f.Not(again)), 0, None)) if q == again and f.is_state(left):
                kept = f"never {self._state(left)}"
                if isinstance(left, f.Not):
                    kept = f"always {self._state(left.operand)}"
                return f"({kept}) or (until {self._state(q)}, {kept})"
            case f.Not(f.Until(left, right, 0, None)) if f.is_state(left) and f.is_state(right):
                p, q = f.negated(left), f.negated(right)
                return f"(always {self._state(q)}) or (until {self._state(f.And(p, q))}, always {self._state(q)})"
            case f.Not(operand):
                return f"not ({self.property(operand)})"
            case f.And(left, right):
                return f"({self.property(left)}) and ({self.property(right)})"
            case f.Or(f.Until(f.Not(e), f.And(again, then), 0, None), never) if (
                e == again and f.is_state(e) and never == f.Not(f.eventually(e))
            ):
                inside = replace(self, began=f.Since(f.TRUE, f.conjoined(self.began, e)))
                return f"after {self._state(e)}, {inside.property(then)}"
            case f.Or(f.Not(left), right):
                return f"({self.property(left)}) implies ({self.property(right)})"
            case f.Or(left, right):
                return f"({self.property(left)}) or ({self.property(right)})"
            case f.Next(f.Next(operand, more), steps):
                return self.property(f.Next(operand, steps + more))
            case f.Next(operand, steps):
                return self._later(steps, lambda inside: inside.property(operand))
            case f.Until(left, right, start, stop):
                return self._until(left, right, start, stop)
            case _:
                raise UnsayableError(NO_UNTIL)

    def condition(self, formula: f.Formula) -> str:
        """A state predicate that holds at a position if `formula` does. Raises UnsayableError."""
        return self._state(formula)

    def _until(self, left: f.Formula, right: f.Formula, start: int, stop: int | None) -> str:
        if not f.is_state(left) or not f.is_state(right):
            raise UnsayableError(NO_UNTIL)
        if start:
            if self.reading.step is None:
                raise UnsayableError(f"an `until` whose interval begins later needs positions: {AT_POINTS}")
            later = f.Until(left, right, 0, None if stop is None else stop - start)
            return f"({self._always(left, 0, start - 1)}) and ({self.property(f.Next(later, start))})"
        kept = f"never {self._state(left.operand)}" if isinstance(left, f.Not) else f"always {self._state(left)}"
        whole = f"until {self._state(right)}, {kept}"
        return whole if stop is None else f"({whole}) and ({self._eventually(right, 0, stop)})"

    def _eventually(self, operand: f.Formula, start: int, stop: int | None) -> str:
        if stop is None:
            if start:
                return self._later(start, lambda inside: inside._eventually(operand, 0, None))
            return f"eventually {self._body(operand)}"
        operand, more = self._decided(operand)
        return f"eventually {self._state(operand, _UNARY)} within {self._interval(start + more, stop + more)}"

    def _always(self, operand: f.Formula, start: int, stop: int | None) -> str:
        if stop is not None and not f.is_state(operand):
            first = f.conjoined(self.began, f.negated(f.earlier(self.began, 1)))
            given: f.Formula = f.Since(f.TRUE, first, 0, stop)
            if start:
                given = f.And(given, f.Not(f.Since(f.TRUE, first, 0, start - 1)))
            return self._always(f.implies(given, operand), 0, None)
        if stop is not None:
            operand, more = self._decided(operand)
            if start + more == stop + more == 0:
                return f"initially {self._state(operand, _UNARY)}"
            if isinstance(operand, f.Not):
                return (
                    f"never {self._state(operand.operand, _UNARY)} within {self._interval(start + more, stop + more)}"
                )
            return f"always {self._state(operand, _UNARY)} for {self._interval(start + more, stop + more)}"
        if start:
            operand = f.disjoined(f.negated(f.earlier(self.began, start)), operand)
        clauses = list(_clauses(operand))
        texts = [self._clause(clause) for clause in clauses]
        return texts[0] if len(texts) == 1 else " and ".join(f"({text})" for text in texts)

    def _clause(self, clause: f.Formula) -> str:
        """A property that holds if `clause` holds at every position."""
        if f.is_state(clause):
            match clause:
                case f.Not(operand):
                    return f"never {self._state(operand, _UNARY)}"
                case _:
                    return f"always {self._state(clause, _UNARY)}"
        states, temporal = _parts(clause)
        given: f.Formula = f.TRUE
        for state in states:
            given = f.conjoined(given, f.negated(state))
        if len(temporal) > 1 and all(isinstance(part, f.Next) or _is_not_next(part) for part in temporal):
            temporal = [_next_of(temporal)]
        if len(temporal) > 1:
            return self._decided_later(clause)
        (then,) = temporal
        match then:
            case f.Next(operand, steps):
                return self._always(f.implies(self._shifted(given, steps), operand), 0, None)
            case f.Until(f.Truth(), operand, start, int(stop)):
                return self._within(given, operand, start, stop, "eventually")
            case f.Not(f.Until(f.Truth(), operand, start, int(stop))):
                return self._within(given, operand, start, stop, "never")
            case f.Until(left, right, 0, int(stop)) if f.is_state(left) and f.is_state(right):
                unbounded = f.implies(given, f.Until(left, right))
                return f"({self._clause(unbounded)}) and ({self._within(given, right, 0, stop, 'eventually')})"
            case f.Until(left, right, start, int(stop)) if start and self.reading.step is not None:
                first = f.implies(given, f.always(left, 0, start - 1))
                rest = f.implies(given, f.Next(f.Until(left, right, 0, stop - start), start))
                return self._always(f.And(first, rest), 0, None)
            case _ if f.horizon(then) is not None and self.reading.step is not None:
                return self._decided_later(clause)
            case _:
                body = self._body(then)
                return f"always {body}" if given == f.TRUE else f"always ({self._state(given, _OR)} implies {body})"

    def _within(self, given: f.Formula, operand: f.Formula, start: int, stop: int, keyword: str) -> str:
        """Always, if `given`, `operand` eventually or never within an interval."""
        operand, more = self._decided(operand)
        start, stop = start + more, stop + more
        if start == stop:
            then = operand if keyword == "eventually" else f.negated(operand)
            return self._clause(f.implies(self._shifted(given, start), then))
        if start:
            given = self._shifted(given, start)
        body = f"{keyword} {self._state(operand, _UNARY)} within {self._interval(0, stop - start)}"
        if keyword == "never" and isinstance(operand, f.Not):
            body = f"always {self._state(operand.operand, _UNARY)} for {self._interval(0, stop - start)}"
        if given == f.TRUE:
            return f"always {body}"
        return f"always ({self._state(given, _OR)} implies {body})"

    def _shifted(self, given: f.Formula, steps: int) -> f.Formula:
        """`given`, so many steps ago, when the run had begun. Raises UnsayableError."""
        if not steps:
            return given
        if self.reading.step is None:
            raise UnsayableError(NO_CLOCK)
        return f.earlier(f.conjoined(self.began, given), steps)

    def _later(self, steps: int, rest: Callable[[Writer], str]) -> str:
        """The `rest`, so many positions after the beginning."""
        began = f.earlier(self.began, steps)
        return f"after {self._state(began)}, {rest(replace(self, began=began))}"

    def _decided(self, operand: f.Formula) -> tuple[f.Formula, int]:
        """`operand` as the positions up to a later one decide it, and by how many that is later."""
        if f.is_state(operand):
            return operand, 0
        more = f.horizon(operand)
        if more is None or self.reading.step is None:
            raise UnsayableError("what is bounded must be a condition that the positions up to now decide")
        try:
            return f.earlier(operand, more), more
        except f.UndecidedError:
            raise UnsayableError("an `until` inside others is too long to be written out") from None

    def _decided_later(self, clause: f.Formula) -> str:
        """Always `clause`, reported once it is decided."""
        if f.horizon(clause) is None or self.reading.step is None:
            return f"always ({self._body(clause)})"
        violated, more = self._decided(f.negated(clause))
        if self.began != f.TRUE:
            violated = f.conjoined(f.earlier(self.began, more), violated)
        return self._clause(f.negated(violated))

    def _body(self, formula: f.Formula) -> str:
        """A part of a property that holds at a position if `formula` does; a condition is about this position."""
        match formula:
            case _ if f.is_state(formula):
                return self._state(formula, _UNARY)
            case f.And(left, right):
                return f"({self._body(left)} and {self._body(right)})"
            case f.Or(f.Not(left), right):
                return f"({self._body(left)} implies {self._body(right)})"
            case f.Or(left, right):
                return f"({self._body(left)} or {self._body(right)})"
            case f.Next():
                raise UnsayableError("`next` inside an unbounded `eventually` or `until`")
            case _:
                return f"({self.property(formula)})"

    def _interval(self, start: int, stop: int) -> str:
        if stop == 0:
            raise UnsayableError("an interval of one position")
        until = self.reading.duration(stop)
        return f"[{self.reading.duration(start)}, {until}]" if start else until

    def _state(self, formula: f.Formula, context: int = _LOWEST) -> str:
        text, strength = self._state_text(formula)
        return f"({text})" if strength < context else text

    def _state_text(self, formula: f.Formula) -> _Text:
        match formula:
            case f.Atom(text):
                is_bare = not any(sign in text for sign in " =<>")
                return text, _TIGHT if is_bare or (text.startswith("@{") and text.endswith("}")) else _UNARY
            case f.Truth():
                return "true", _TIGHT
            case f.Previous(operand, steps) if self.reading.step is not None and not f.is_boolean(operand):
                return self._state_text(f.earlier(operand, steps))
            case f.Previous(operand, steps):
                return self._was(operand, steps), _TIGHT
            case f.Not(f.Previous(f.Not(operand), steps)) if f.is_boolean(operand) and operand != f.TRUE:
                return self._was(operand, steps, "true"), _TIGHT
            case f.Not(f.Since(f.Truth(), operand, 0, None)):
                return f"historically {self._state(f.negated(operand), _TIGHT)}", _UNARY
            case f.Not(operand):
                return f"not {self._state(operand, _UNARY)}", _UNARY
            case f.And(left, right):
                return f"{self._state(left, _AND)} and {self._state(right, _AND)}", _AND
            case f.Or(f.Not(left), f.Or(f.Not(middle), right)):
                return self._state_text(f.Or(f.Not(f.And(left, middle)), right))
            case f.Or(f.Not(left), right):
                return f"{self._state(left, _OR)} implies {self._state(right, _IMPLIES)}", _IMPLIES
            case f.Or(left, right):
                return f"{self._state(left, _OR)} or {self._state(right, _OR)}", _OR
            case f.Since(left, right, start, stop):
                return self._since(left, right, start, stop)
            case f.Next() | f.Until():
                raise UnsayableError(NO_UNTIL)
            case _:
                assert_never(formula)

    def _since(self, left: f.Formula, right: f.Formula, start: int, stop: int | None) -> _Text:
        if start:
            if self.reading.step is None:
                raise UnsayableError(f"an interval of the past that ends earlier needs positions: {AT_POINTS}")
            longer = f.Since(left, right, 0, None if stop is None else stop - start)
            if left == f.TRUE:
                return self._state_text(f.earlier(longer, start))
            lately = f.Not(f.Since(f.TRUE, f.negated(left), 0, start - 1)) if start > 1 else left
            return self._state_text(f.And(lately, f.earlier(longer, start)))
        if stop == 0:
            return self._state_text(right)
        bound = "" if stop is None else f" within {self.reading.duration(stop)}"
        if left == f.TRUE:
            return f"once {self._state(right, _TIGHT)}{bound}", _UNARY
        return f"{self._state(left, _UNARY)} since {self._state(right, _UNARY)}{bound}", _AND

    def _was(self, operand: f.Formula, steps: int, otherwise: str = "false") -> str:
        """Whether `operand` held so many positions ago."""
        if self.reading.step is None:
            if steps == 1:
                return f"(previously ({self._plain(operand)}))"
            raise UnsayableError(NO_STEPS)
        return f"@{{{self._plain(operand)}, -{steps} else {otherwise}}}"

    def _plain(self, operand: f.Formula) -> str:
        """A condition of one step; what is always true is said of something that has a value."""
        return f"{self.mark} or not {self.mark}" if operand == f.TRUE else self._state(operand)


def _clauses(formula: f.Formula) -> Iterator[f.Formula]:
    """Formulas that all hold if `formula` does; conditions stay together."""
    match formula:
        case f.And(left, right) if not f.is_state(formula):
            yield from _clauses(left)
            yield from _clauses(right)
        case f.Or(left, f.And(one, other)) if not f.is_state(formula) and f.is_state(left):
            yield from _clauses(f.disjoined(left, one))
            yield from _clauses(f.disjoined(left, other))
        case f.Not(f.Not(operand)):
            yield from _clauses(operand)
        case f.Not(f.Or(left, right)) if not f.is_state(formula):
            yield from _clauses(f.negated(left))
            yield from _clauses(f.negated(right))
        case _:
            yield formula


def _parts(clause: f.Formula) -> tuple[list[f.Formula], list[f.Formula]]:
    """The parts of a disjunction: conditions, and others."""
    match clause:
        case _ if f.is_state(clause):
            return [clause], []
        case f.Or(left, right):
            (a, b), (c, d) = _parts(left), _parts(right)
            return a + c, b + d
        case f.Not(f.And(left, right)):
            (a, b), (c, d) = _parts(f.negated(left)), _parts(f.negated(right))
            return a + c, b + d
        case _:
            return [], [clause]


def _is_not_next(part: f.Formula) -> bool:
    return isinstance(part, f.Not) and isinstance(part.operand, f.Next)


def _next_of(parts: list[f.Formula]) -> f.Formula:
    """A disjunction of what begins with `next`, as the `next` of a disjunction."""
    found: f.Formula = f.FALSE
    bare = [(part.operand, True) if isinstance(part, f.Not) else (part, False) for part in parts]
    nexts = [(part, is_negated) for part, is_negated in bare if isinstance(part, f.Next)]
    steps = min(part.steps for part, _ in nexts)
    for part, is_negated in nexts:
        operand = f.Next(part.operand, part.steps - steps) if part.steps > steps else part.operand
        found = f.disjoined(found, f.negated(operand) if is_negated else operand)
    return f.Next(found, steps)
