"""Specifications for R2U2 in the language of its compiler C2PO: `.c2po`, and `.mltl`.

Each is asked at every position: it is read as `always`. Bounds count positions.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.importing import formulas as f
from ltlc.importing.c2po_formulas import Formulas
from ltlc.importing.names import Kind, Signals
from ltlc.importing.operators import Form, Measure
from ltlc.importing.requirement import Requirement, UnusableFileError
from ltlc.importing.values import FormulaError, Part, Value, array

NAME = "C2PO"

FORM = Form(
    words={
        "G": "always",
        "F": "eventually",
        "U": "until",
        "R": "release",
        "xor": "xor",
        "H": "historically",
        "O": "once",
        "S": "since",
        "T": "trigger",
        "=>": "",
        "=": "",
    },
    levels={
        "implies": 1,
        "iff": 1,
        "xor": 1,
        "or": 3,
        "and": 4,
        "until": 5,
        "release": 5,
        "since": 5,
        "trigger": 5,
    },
    leads=True,
)

KINDS = {"bool": Kind.BOOLEAN, "int": Kind.INTEGER, "float": Kind.NUMBER}

_SECTION = re.compile(r"^[ \t]*(STRUCT|ENUM|INPUT|DEFINE|ATOMIC|FTSPEC|PTSPEC)\b", re.MULTILINE)
_CONTRACT = re.compile(r"(?<![<=])=>")
_PREDICTED = re.compile(r"\bwith\s+d\s*=.*\Z", re.DOTALL)


@dataclass(frozen=True)
class _Statement:
    text: str
    place: Span


def read(source: Source, signals: Signals, measure: Measure) -> list[Requirement]:
    """The specifications in a file. Raises UnusableFileError."""
    text = re.sub(r"--[^\n]*", lambda comment: " " * len(comment[0]), source.text)
    heads = list(_SECTION.finditer(text))
    if not any(head[1].endswith("SPEC") for head in heads):
        if heads:
            raise UnusableFileError("there is no FTSPEC and no PTSPEC")
        return _lines(source, signals, measure)
    form = FORM
    found: list[Requirement] = []
    for head, end in zip(heads, [*(each.start() for each in heads[1:]), len(text)], strict=True):
        statements = list(_statements(text, head.end(), end))
        match head[1]:
            case "STRUCT":
                form = replace(form, structures={**form.structures, **dict(map(_structure, statements))})
            case "ENUM":
                for statement in statements:
                    _enumerate(statement, signals)
            case "INPUT":
                for statement in statements:
                    form = replace(form, parts={**form.parts, **_inputs(statement, signals)})
            case "DEFINE" | "ATOMIC":
                for statement in statements:
                    form = _define(statement, form, signals, measure)
            case "FTSPEC" | "PTSPEC":
                for statement in statements:
                    found.append(_requirement(statement, len(found), form, signals, measure))
            case _:
                pass  # how atoms are computed
    return found


def _lines(source: Source, signals: Signals, measure: Measure) -> list[Requirement]:
    """The formulas of a file that has nothing else: one on each line."""
    found: list[Requirement] = []
    offset = 0
    for line in source.text.splitlines(keepends=True):
        text = re.sub(r"(#|//|--).*", "", line).strip().rstrip(";")
        if text:
            start = offset + line.index(text)
            found.append(
                _requirement(_Statement(text, Span(start, start + len(text))), len(found), FORM, signals, measure)
            )
        offset += len(line)
    return found


def _statements(text: str, start: int, end: int) -> Iterator[_Statement]:
    """What ends in `;` outside of braces."""
    depth, begin = 0, start
    for at in range(start, end):
        depth += (text[at] == "{") - (text[at] == "}")
        if (text[at] == ";" and depth <= 0) or at == end - 1:
            stop = at if text[at] == ";" else end
            statement = text[begin:stop].strip()
            if statement:
                first = begin + text[begin:stop].index(statement)
                yield _Statement(statement, Span(first, first + len(statement)))
            begin = at + 1


def _structure(statement: _Statement) -> tuple[str, list[str]]:
    """The name of a type, and its fields."""
    name, _, body = statement.text.partition(":")
    fields = [field for part in body.strip(" \n\t{}").split(";") for field in part.partition(":")[0].split(",")]
    return name.strip(), [field.strip() for field in fields if field.strip()]


def _enumerate(statement: _Statement, signals: Signals) -> None:
    body = statement.text.partition(":")[2]
    for number, member in enumerate(body.strip(" \n\t{}").split(",")):
        word, _, value = member.partition(":")
        signals.constants[word.strip()] = value.strip() or str(number)


def _inputs(statement: _Statement, signals: Signals) -> dict[str, Part]:
    """The arrays that are declared; the kinds of other names are noted."""
    names, _, type_ = statement.text.rpartition(":")
    element, _, size = type_.strip().partition("[")
    kind = KINDS.get(element.strip(), Kind.INTEGER)
    found: dict[str, Part] = {}
    for name in (name.strip() for name in names.split(",")):
        if not size:
            signals.use(name, kind)
            continue
        count = size.strip(" ]")
        elements = [f"{name}[{n}]" for n in range(int(count) if count.isdigit() else 0)]
        for each in elements:
            signals.use(each, kind)
        found[name] = array(Value(signals.name(each), kind, name=each) for each in elements)
    return found


def _define(statement: _Statement, form: Form, signals: Signals, measure: Measure) -> Form:
    """`form` with a definition; conditions and numbers keep their names. One that cannot be read is skipped."""
    name, _, text = (part.strip() for part in statement.text.partition(":="))
    try:
        value = Formulas(text, form, signals, measure).alone()
    except FormulaError:
        return form
    match value:
        case f.Atom(written):
            signals.definitions[name] = written
            return replace(form, parts={**form.parts, name: f.Atom(signals.name(name))})
        case Value(written, kind) if not value.name and not re.fullmatch(r"-?[\d.]+", written):
            signals.definitions[name] = written
            return replace(form, parts={**form.parts, name: Value(signals.name(name), kind)})
        case _:
            return replace(form, parts={**form.parts, name: value})


def _requirement(statement: _Statement, number: int, form: Form, signals: Signals, measure: Measure) -> Requirement:
    label = re.match(r"\s*(\w+)\s*:(?!=)\s*", statement.text)
    name, formula = (label[1], statement.text[label.end() :]) if label else (f"{number}", statement.text)
    original = " ".join(statement.text.split())
    predicted = _PREDICTED.search(formula)
    formula = formula[: predicted.start()] if predicted else formula
    try:
        if re.search(r"\bTAU\b", formula):
            raise FormulaError("`TAU`, the number of the position, has no counterpart")
        if probability := re.match(r"P_[\d.]+", formula):
            raise FormulaError(f"the probability `{probability[0]}` is not decided by one run")
        assumed, contract = _CONTRACT.split(formula, maxsplit=1) if _CONTRACT.search(formula) else ("", formula)
        meaning = Formulas(contract, form, signals, measure).condition_alone()
        if assumed:
            meaning = f.implies(Formulas(assumed, form, signals, measure).condition_alone(), meaning)
    except FormulaError as error:
        return Requirement(name, "", original, statement.place, problem=str(error))
    whole = f.always(meaning)
    notes: tuple[str, ...] = ("a contract: its guarantee where what it assumes holds",) if assumed else ()
    notes += ("the prediction `with d` has no counterpart",) if predicted else ()
    return Requirement(name, "", original, statement.place, whole, (whole,), notes=notes)
