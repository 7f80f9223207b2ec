"""LTL as NuSMV has it: the `LTLSPEC` and `INVARSPEC` of a model, or a file with a formula on each line."""

from __future__ import annotations

import re
from dataclasses import replace

from ltlc.base.source import Source, Span
from ltlc.importing import formulas as f
from ltlc.importing.infix import parse, parse_value
from ltlc.importing.names import Kind, Signals
from ltlc.importing.operators import Form, Measure
from ltlc.importing.requirement import Requirement
from ltlc.importing.values import FormulaError, Value

NAME = "NuSMV"

FORM = Form(
    words={
        "G": "always",
        "F": "eventually",
        "X": "next",
        "U": "until",
        "V": "release",
        "R": "release",
        "H": "historically",
        "O": "once",
        "S": "since",
        "Y": "previous",
        "Z": "weak previous",
        "T": "trigger",
        "W": "weak until",
        "xor": "xor",
        "mod": "mod",
        "[]": "always",
        "<>": "eventually",
    },
    levels={
        "implies": 1,
        "iff": 2,
        "or": 3,
        "xor": 3,
        "and": 4,
        "until": 5,
        "release": 5,
        "since": 5,
        "trigger": 5,
        "weak until": 5,
    },
    right=frozenset(("implies",)),
)

_WORDS = "MODULE|I?VAR|FROZENVAR|DEFINE|ASSIGN|INIT|INVAR|TRANS|FAIRNESS|JUSTICE|CTLSPEC|SPEC|PSLSPEC|COMPUTE|CONSTANTS"
_SECTION = re.compile(rf"^[ \t]*({_WORDS}|LTLSPEC|INVARSPEC)\b", re.MULTILINE)
_NAMED = re.compile(r"\s*NAME\s+([\w.]+)\s*:=")


def read(source: Source, signals: Signals, measure: Measure) -> list[Requirement]:
    """The formulas in a file; nothing of a model but the kinds of its variables and its definitions counts."""
    text = re.sub(r"--[^\n]*", lambda comment: " " * len(comment[0]), source.text)
    heads = list(_SECTION.finditer(text))
    if not heads:
        return _lines(source, signals, measure)
    form = FORM
    found: list[Requirement] = []
    for head, end in zip(heads, [*(each.start() for each in heads[1:]), len(text)], strict=True):
        body = text[head.end() : end]
        match head[1]:
            case "VAR" | "IVAR" | "FROZENVAR":
                _declare(body, signals)
            case "DEFINE":
                form = _define(body, form, signals, measure)
            case "LTLSPEC" | "INVARSPEC":
                named = _NAMED.match(body)
                formula = body[named.end() :] if named else body
                start = head.end() + (named.end() if named else 0)
                name = named[1] if named else f"{len(found) + 1}"
                found.append(_requirement(name, formula, start, head[1] == "INVARSPEC", form, signals, measure))
            case _:
                pass  # the model itself
    return found


def _lines(source: Source, signals: Signals, measure: Measure) -> list[Requirement]:
    found: list[Requirement] = []
    offset = 0
    for line in source.text.splitlines(keepends=True):
        text = re.sub(r"(#|//|--).*", "", line)
        if text.strip():
            found.append(_requirement(f"{len(found) + 1}", text, offset, False, FORM, signals, measure))
        offset += len(line)
    return found


def _declare(body: str, signals: Signals) -> None:
    """Note of what kind variables are; the words of an enumeration are strings."""
    for name, type_ in re.findall(r"([\w.$]+)\s*:\s*([^;]*);", body):
        if type_.strip().startswith("{"):
            words = [word.strip() for word in type_.strip(" {}\n").split(",")]
            is_number = all(re.fullmatch(r"-?\d+", word) for word in words)
            signals.use(name, Kind.INTEGER if is_number else Kind.STRING)
            signals.constants.update({word: f'"{word}"' for word in words if not is_number})
        else:
            signals.use(name, Kind.BOOLEAN if type_.strip() == "boolean" else Kind.INTEGER)


def _define(body: str, form: Form, signals: Signals, measure: Measure) -> Form:
    for name, text in re.findall(r"([\w.$]+)\s*:=\s*([^;]*);", body):
        try:
            value = parse_value(text, form, signals, measure)
        except FormulaError:
            continue  # what uses it says that it is missing
        if isinstance(value, Value) and value.name:
            signals.use(value.name, Kind.BOOLEAN)
        form = replace(form, parts={**form.parts, name: value})
    return form


def _requirement(
    name: str, formula: str, start: int, is_invariant: bool, form: Form, signals: Signals, measure: Measure
) -> Requirement:
    text = formula.strip().rstrip(";").strip()
    first = start + (formula.index(text) if text else 0)
    place, original = Span(first, first + len(text)), " ".join(text.split())
    try:
        meaning = parse(text, form, signals, measure)
    except FormulaError as error:
        return Requirement(name, "", original, place, problem=str(error))
    meaning = f.always(meaning) if is_invariant else meaning
    return Requirement(name, "", original, place, meaning, (meaning,))
