"""Signal temporal logic, as rtamt and reelay have it: a formula for each assertion or line.

rtamt judges a formula with operators of the future at the first position, reelay judges one of the past at each.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from ltlc.base.source import Source, Span
from ltlc.importing import formulas as f
from ltlc.importing.infix import parse_value
from ltlc.importing.names import Kind, Signals
from ltlc.importing.operators import Form, Measure
from ltlc.importing.requirement import Requirement
from ltlc.importing.values import FormulaError, Value

NAME = "STL"

WORDS: Mapping[str, str] = {
    **dict.fromkeys(("always", "G"), "always"),
    **dict.fromkeys(("eventually", "F"), "eventually"),
    **dict.fromkeys(("until", "U"), "until"),
    **dict.fromkeys(("unless", "W"), "weak until"),
    **dict.fromkeys(("historically", "H"), "historically"),
    **dict.fromkeys(("once", "O"), "once"),
    **dict.fromkeys(("since", "S"), "since"),
    **dict.fromkeys(("next", "X", "s_next"), "next"),
    **dict.fromkeys(("prev", "Y", "weak_prev"), "weak previous"),
    **dict.fromkeys(("s_prev", "pre", "previous"), "previous"),
    "not": "not",
    "and": "and",
    "or": "or",
    "implies": "implies",
    "iff": "iff",
    "xor": "xor",
}

FORM = Form(
    words=WORDS,
    levels={
        "xor": 0,
        "iff": 1,
        "implies": 2,
        "or": 3,
        "and": 4,
        "until": 5,
        "weak until": 5,
        "since": 5,
    },
)

KINDS = {"float": Kind.NUMBER, "float64": Kind.NUMBER, "int": Kind.INTEGER, "int64": Kind.INTEGER, "bool": Kind.BOOLEAN}

_DECLARATION = re.compile(
    r"(?:(input|output)\s+)?(const\s+)?(float64|float|int64|int|bool|complex)\s+(\w+)(?:\s*=\s*(.+))?"
)
_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*|#[^\n]*", re.DOTALL)
_NAMED = re.compile(r"(\w+)\s*(?:=(?!=|>)|:(?!\s*\d))\s*(?=\S)")


def read(source: Source, signals: Signals, measure: Measure) -> list[Requirement]:
    """The formulas in a file: what no other formula uses, or all lines."""
    text = _COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment[0]), source.text)
    form, assertions = FORM, []
    for each in _statements(text):
        declared = _DECLARATION.fullmatch(each[0])
        if declared:
            form = _declare(declared, form, signals)
        elif not re.match(r"(specification|import|from|@)", each[0]):
            assertions.append(each)
    found = []
    for number, (statement, place) in enumerate(assertions, 1):
        named = _NAMED.match(statement)
        name, formula = (named[1], statement[named.end() :]) if named else (f"{number}", statement)
        later = " ".join(text for text, _ in assertions[number:])
        is_used = named is not None and re.search(rf"\b{re.escape(name)}\b", later) is not None
        requirement, value = _requirement(name, formula, place, form, signals, measure)
        is_definition = named is not None and isinstance(value, Value)
        if (is_used or is_definition) and value is not None:
            form = replace(form, parts={**form.parts, name: value})
        else:
            found.append(requirement)
    return found


def _statements(text: str) -> list[tuple[str, Span]]:
    """Lines, or what ends in `;`; a line with an open parenthesis, or that ends in an operator, goes on."""
    found, start, depth = [], 0, 0
    for end in [*(m.start() for m in re.finditer(r"[;\n]", text)), len(text)]:
        part = text[start:end]
        depth = part.count("(") + part.count("[") - part.count(")") - part.count("]")
        if (
            end < len(text)
            and text[end] == "\n"
            and (depth > 0 or re.search(r"(->|[=&|+*/<>-]|\b(and|or|implies))\s*$", part))
        ):
            continue
        if statement := part.strip():
            first = start + part.index(statement)
            found.append((statement, Span(first, first + len(statement))))
        start = end + 1
    return found


def _declare(declared: re.Match[str], form: Form, signals: Signals) -> Form:
    """Note the kind of a variable; a constant stands for its number."""
    _, const, type_, name, value = declared.groups()
    if const and value:
        signals.constants[name] = value.strip()
    else:
        signals.use(name, KINDS.get(type_, Kind.NUMBER))
    return form


def _requirement(
    name: str, formula: str, place: Span, form: Form, signals: Signals, measure: Measure
) -> tuple[Requirement, Value | f.Formula | None]:
    original = " ".join(formula.split())
    try:
        value = parse_value(formula, form, signals, measure)
    except FormulaError as error:
        return Requirement(name, "", original, place, problem=str(error)), None
    if isinstance(value, Value) and value.name and signals.kind(value.name) is Kind.BOOLEAN:
        value = f.Atom(value.text)
    if isinstance(value, Value):
        problem = "a value, not a condition"
        return Requirement(name, "", original, place, problem=problem), value
    if not isinstance(value, f.Formula):
        return Requirement(name, "", original, place, problem="several values, not a condition"), None
    whole = f.always(value) if f.is_state(value) else value
    notes = ("no operator of the future: it is judged at every position",) if whole is not value else ()
    return Requirement(name, "", original, place, whole, (whole,), notes=notes), value
