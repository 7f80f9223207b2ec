"""Requirements of FRET, NASA's Formal Requirements Elicitation Tool, as it exports them: JSON.

FRET has each formula twice, of the future and of the past, both for runs that end. The property is written from the
one of the past, which needs no next position, and compared with that of the future.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, assert_never

from ltlc.base.source import Source, Span
from ltlc.importing import formulas as f
from ltlc.importing.infix import parse
from ltlc.importing.names import Kind, Signals
from ltlc.importing.operators import Form, Measure
from ltlc.importing.requirement import Requirement, UnusableFileError
from ltlc.importing.values import FormulaError

FORM = Form(
    words={
        "G": "always",
        "F": "eventually",
        "X": "next",
        "U": "until",
        "V": "release",
        "H": "historically",
        "O": "once",
        "S": "since",
        "Y": "previous",
        "Z": "weak previous",
        "FTP": "first",
        "LAST": "last",
        "xor": "xor",
        "mod": "mod",
    },
    levels={"implies": 1, "iff": 2, "or": 3, "xor": 3, "and": 4, "until": 5, "release": 5, "since": 5},
    right=frozenset(("implies",)),
)

KINDS = {
    "boolean": Kind.BOOLEAN,
    "integer": Kind.INTEGER,
    "double": Kind.NUMBER,
    "single": Kind.NUMBER,
    "int": Kind.INTEGER,
    "real": Kind.NUMBER,
    "string": Kind.STRING,
}

NAME = "FRET"


def read(source: Source, signals: Signals, measure: Measure) -> list[Requirement]:
    """The requirements in an export. Raises UnusableFileError."""
    try:
        document = json.loads(source.text)
    except json.JSONDecodeError as error:
        raise UnusableFileError(f"not JSON: {error.msg}", error.pos) from None
    except RecursionError:
        raise UnusableFileError("the JSON is nested too deeply") from None
    entries, variables = document, None
    if isinstance(document, Mapping):
        entries, variables = document.get("requirements"), document.get("variables")
    if not isinstance(entries, list) or not all(isinstance(entry, Mapping) for entry in entries):
        raise UnusableFileError("FRET exports a list of requirements, or an object with `requirements`")
    for variable in variables if isinstance(variables, list) else ():
        _declare(variable, signals)
    return [
        _requirement(entry, place, signals, measure) for entry, place in zip(entries, _places(source), strict=False)
    ]


def _declare(variable: object, signals: Signals) -> None:
    """Note of a variable whether it is a condition or a number; FRET says nothing of topics."""
    if isinstance(variable, Mapping) and isinstance(name := variable.get("variable_name"), str):
        kind = KINDS.get(str(variable.get("dataType")).lower())
        if kind is not None:
            signals.use(name, kind)


def _places(source: Source) -> Iterator[Span | None]:
    """The place of each requirement's id."""
    for found in re.finditer(r'"reqid"\s*:\s*("(?:[^"\\\n]|\\.)*")', source.text):
        yield Span(*found.span(1))
    while True:
        yield None


def _requirement(entry: Mapping[str, Any], place: Span | None, signals: Signals, measure: Measure) -> Requirement:
    name, sentence = str(entry.get("reqid") or "unnamed"), " ".join(str(entry.get("fulltext") or "").split())
    rationale = " ".join(str(entry.get("rationale") or "").split())
    semantics = entry.get("semantics")
    semantics = semantics if isinstance(semantics, Mapping) else {}
    future, past = (_formula(semantics, key) for key in ("ftExpanded", "ptExpanded"))
    found = Requirement(name, sentence, future or past, place, rationale=rationale)
    if not future and not past:
        return replace(found, problem="FRET has no formula for it: the sentence is not FRETish")
    try:
        meanings = [_simplified(parse(text, FORM, signals, measure)) for text in (future, past) if text]
    except FormulaError as error:
        return replace(found, problem=str(error))
    forms: list[f.Formula] = []
    if past:
        at_end = _at_end(meanings[-1])
        forms = [*_at_end_shorter(meanings[-1]), *([at_end] if at_end else [])]
    if future:
        return replace(found, meaning=meanings[0], forms=(_as_said(_endless(meanings[0])), *forms))
    if not forms:
        return replace(found, problem="FRET has a formula of the end of the run only")
    notes = ("FRET has no formula of the future: it is compared with the one of the past",)
    return replace(found, meaning=forms[-1], forms=tuple(forms), notes=notes)


def _formula(semantics: Mapping[str, Any], key: str) -> str:
    """A formula without the marks that FRET shows it with; empty if there is none."""
    text = semantics.get(key)
    return re.sub(r"</?[bi]>", "", text).strip() if isinstance(text, str) and "$" not in text else ""


def _simplified(formula: f.Formula) -> f.Formula:
    """`formula` with `not Y p` for `Y not p`, or there is no earlier position."""
    match formula:
        case f.Atom() | f.Truth():
            return formula
        case f.Or(f.Not(f.Previous(f.Truth(), 1)), f.Previous(p, 1)) | f.Or(
            f.Previous(p, 1), f.Not(f.Previous(f.Truth(), 1))
        ):
            return f.Not(f.Previous(_simplified(f.negated(p)), 1))
        case f.Until(left, right, start, stop) | f.Since(left, right, start, stop):
            return type(formula)(_simplified(left), _simplified(right), start, stop)
        case f.Next(operand, steps) | f.Previous(operand, steps):
            return type(formula)(_simplified(operand), steps)
        case f.Not(operand):
            return f.negated(_simplified(operand))
        case f.And(left, right) | f.Or(left, right):
            return type(formula)(_simplified(left), _simplified(right))
        case _:
            assert_never(formula)


def _endless(formula: f.Formula) -> f.Formula:
    """What `formula` is of runs that do not end: no position is the last."""
    match formula:
        case f.Atom() | f.Truth() | f.Since() | f.Previous():
            return formula
        case f.Next(operand, steps):
            inner = _endless(operand)
            return inner if inner in (f.TRUE, f.FALSE) else f.Next(inner, steps)
        case f.Until(left, right, start, stop):
            right = _endless(right)
            return f.FALSE if right == f.FALSE else f.Until(_endless(left), right, start, stop)
        case f.Not(operand):
            return f.negated(_endless(operand))
        case f.And(left, right):
            return f.conjoined(_endless(left), _endless(right))
        case f.Or(left, right):
            return f.disjoined(_endless(left), _endless(right))
        case _:
            assert_never(formula)


def _as_said(formula: f.Formula) -> f.Formula:
    """`formula` as the language says it: what FRET says of the next position and of the first one is of an edge."""
    match formula:
        case f.And(f.Not(f.Until(f.Truth(), f.Not(later), 0, None)), f.Or(f.Not(c), then)):
            edge = f.And(f.negated(c), f.Next(c))
            if later in (f.implies(edge, f.Next(then)), f.Or(f.Not(edge), f.Next(then))):
                return f.always(f.implies(f.And(c, f.Not(f.Previous(c))), then))
        case f.Or(f.Until(f.Not(e), f.And(again, f.Next(then, 1)), 0, None), never) if (
            e == again and never == f.Not(f.Until(f.TRUE, e)) and f.horizon(e) == 1
        ):
            opened = f.earlier(e, 1)
            return f.Or(f.Until(f.Not(opened), f.And(opened, then)), f.Not(f.eventually(opened)))
        case f.Or(f.Not(f.Until(f.Truth(), p, 0, int())) as bounded, f.Not(f.Until(f.Truth(), q, 0, None))) if p == q:
            return bounded
    return formula


def _at_end_shorter(past: f.Formula) -> list[f.Formula]:
    """Without a part that mostly follows from the other: FRET also lists that the condition never held."""
    if not isinstance(past, f.Or):
        return []
    found = _at_end(past.right)
    return [] if found is None else [found]


def _at_end(past: f.Formula) -> f.Formula | None:
    """What holds of a run at whose last position `past` holds, as a formula of the first; None if there is no such."""
    match past:
        case f.Since(f.Truth(), operand, 0, None):
            return f.eventually(operand)
        case f.Since(left, f.And(one, other), 0, None) if left in (one, other):
            return f.eventually(f.conjoined(other if left == one else one, f.always(left)))
        case f.Since(left, right, 0, None):
            return f.eventually(f.conjoined(right, f.Next(f.always(left))))
        case f.Not(f.Since(f.Truth(), operand, 0, None)):
            return f.always(f.negated(operand))
        case f.Not(f.Since(left, f.And(one, other), 0, None)) if left in (one, other):
            return f.always(f.implies(other if left == one else one, f.eventually(f.negated(left))))
        case f.Not(operand):
            inner = _at_end(operand)
            return None if inner is None else f.negated(inner)
        case f.And(left, right) | f.Or(left, right):
            p, q = _at_end(left), _at_end(right)
            if p is None or q is None:  # what is asked of the last position, no infinite run has
                return (p or q) if isinstance(past, f.And) else None
            return f.conjoined(p, q) if isinstance(past, f.And) else f.disjoined(p, q)
        case _:
            return None
