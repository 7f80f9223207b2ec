"""Requirements of FRET, NASA's Formal Requirements Elicitation Tool, as it exports them: JSON.

The property is written from the sentence, and compared with the formula of the future that FRET has for it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from ltlc.base.source import Source, Span
from ltlc.importing import fretish
from ltlc.importing.names import Kind, Signals
from ltlc.importing.operators import Form, Measure
from ltlc.importing.requirement import Requirement, UnusableFileError
from ltlc.importing.values import Choice, FormulaError, Structure, Value
from ltlc.importing.writing import Reading, Writer

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

ASSIGNED = replace(FORM, words={"and": "and", "or": "or", "not": "not", "xor": "xor", "mod": "mod"})
"""How the value of a variable is written, as Lustre has it."""

_OVER_TIME = re.compile(r"->|\bpre\b|\bfby\b")

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
        _declare(variable, signals, measure)
    return [
        _requirement(entry, place, signals, measure) for entry, place in zip(entries, _places(source), strict=False)
    ]


def _declare(variable: object, signals: Signals, measure: Measure) -> None:
    """Note of a variable whether it is a condition or a number, and what it stands for; FRET says nothing of topics."""
    if not isinstance(variable, Mapping) or not isinstance(name := variable.get("variable_name"), str):
        return
    kind = KINDS.get(str(variable.get("dataType")).lower())
    if kind is not None:
        signals.use(name, kind)
    text = str(variable.get("assignment") or variable.get("modeRequirement") or "")
    if _OVER_TIME.search(text):
        return
    try:
        value = fretish.Conditions(text, ASSIGNED, signals, measure).alone()
    except FormulaError:
        return  # it has no value, or one that cannot be said: it stays a signal
    if isinstance(value, Structure | Choice):
        return
    signals.name(name)
    signals.definitions[name] = value.text if isinstance(value, Value) else Writer(Reading(None), "").condition(value)


def _places(source: Source) -> Iterator[Span | None]:
    """The place of each requirement's id."""
    for found in re.finditer(r'"reqid"\s*:\s*("(?:[^"\\\n]|\\.)*")', source.text):
        yield Span(*found.span(1))
    while True:
        yield None


def _requirement(entry: Mapping[str, Any], place: Span | None, signals: Signals, measure: Measure) -> Requirement:
    name, sentence = str(entry.get("reqid") or "unnamed"), " ".join(str(entry.get("fulltext") or "").split())
    rationale = " ".join(str(entry.get("rationale") or "").split())
    original = _formula(entry.get("semantics"))
    found = Requirement(name, sentence, original, place, rationale=rationale)
    try:
        parts, notes = fretish.parse(sentence, signals, measure)
        said = fretish.meaning(parts)
    except FormulaError as error:
        return replace(found, problem=f"FRETish is expected: {error}")
    if not original:
        notes += ("the file has no formula of it: it is compared with what FRET says of such sentences",)
        return replace(found, meaning=said, forms=(said,), notes=notes)
    try:
        formula = fretish.Conditions(original, FORM, signals, measure).condition_alone()
    except FormulaError as error:
        return replace(found, problem=str(error))
    return replace(found, meaning=formula, forms=(said,), notes=notes)


def _formula(semantics: object) -> str:
    """The formula of the future, without the marks that FRET shows it with; empty if there is none."""
    text = semantics.get("ftExpanded") if isinstance(semantics, Mapping) else None
    if not isinstance(text, str) or "$" in text:
        return ""
    return re.sub(r"</?[bi]>", "", text).replace("_DOT_", ".").strip()
