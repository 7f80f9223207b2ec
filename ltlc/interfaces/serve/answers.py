"""Answers to the page: findings, verdicts of a run, explanations, encodings side by side; as JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from ltlc.analysis.analyse import study_of
from ltlc.analysis.comparison.answer import answer
from ltlc.analysis.comparison.document import document
from ltlc.analysis.comparison.questions import questions_of
from ltlc.analysis.comparison.results import Runs
from ltlc.analysis.english import English
from ltlc.analysis.examine import examine
from ltlc.analysis.explanation import CLASSES, explain
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import Budget
from ltlc.base.render.json import documents, place, plain
from ltlc.frontend.language.suppression import unsuppressed
from ltlc.interfaces.pages.panels import Panel, panels
from ltlc.interfaces.serve.judging import judge
from ltlc.interfaces.serve.opening import open_file
from ltlc.interfaces.serve.questions import Question, read_question
from ltlc.runtime.documents import json_value
from ltlc.runtime.reports import printable
from ltlc.semantics.encodings import ENCODINGS
from ltlc.specification.expressions import Current, Signal
from ltlc.specification.specification import PropertySpecification, Specification

OF_ANALYSES = Budget(12, 512)
"""What all analyses of a text may use, or what explaining a property may."""

OF_A_COMPARISON = Budget(4, 512)
"""What each translation and each question may use where encodings are compared."""


def _check(question: Question) -> dict[str, Any]:
    """The findings about the text, the meaning of its properties, and the signals they read."""
    specification, diagnostics = _analysed(question) if question.analyses else _read(question)
    if specification is None:
        return {"diagnostics": documents(diagnostics), "properties": None, "signals": [], "rate": None}
    return {
        "diagnostics": documents(diagnostics),
        "properties": [_property(specification, each) for each in specification.properties],
        "signals": _signals(specification),
        "rate": specification.rate,
    }


def _analysed(question: Question) -> tuple[Specification | None, Sequence[Diagnostic]]:
    examined = examine(question.source, question.message_paths, question.encoding, OF_ANALYSES)
    return examined.specification, examined.diagnostics


def _read(question: Question) -> tuple[Specification | None, Sequence[Diagnostic]]:
    """What is known at once."""
    specification, diagnostics = question.loaded
    return specification, unsuppressed(diagnostics)


def _property(specification: Specification, property_: PropertySpecification) -> dict[str, Any]:
    return {
        "label": printable(property_.label),
        "span": place(specification.source, property_.span),
        "text": printable(property_.text),
        "english": printable(English(property_).sentence()),
    }


def _signals(specification: Specification) -> list[dict[str, Any]]:
    """The signals that properties read, which are the columns of a run, and what they are compared with."""
    signals = {i.signal.name: i.signal for each in specification.properties for i in each.inputs()}
    drawn = [panel for each in specification.properties for panel in panels(each, specification.source)]
    return [_signal(signal, [p for p in drawn if p.expression == Current(signal)]) for signal in signals.values()]


def _signal(signal: Signal, drawn: Sequence[Panel]) -> dict[str, Any]:
    limits = {limit.value: limit for panel in drawn for limit in panel.limits}
    return {
        "name": signal.name,
        "type": signal.type.value,
        "limits": [{"text": printable(each.text), "value": json_value(each.value)} for each in limits.values()],
        "wanted": sorted({name for panel in drawn for name in panel.wanted}),
    }


def _explain(question: Question) -> dict[str, Any]:
    """The class of a property, and a run for each verdict that it can have."""
    specification = replace(question.specification, properties=(question.chosen,))
    study = study_of(specification, question.encoding, OF_ANALYSES)
    (found,) = explain(study, OF_ANALYSES)
    return {
        "class": f"{found.temporal_class}: {CLASSES[found.temporal_class]}" if found.temporal_class else "",
        "states": found.states,
        "examples": [plain(example.as_json()) for example in found.examples],
        "limit": found.limit,
    }


def _compare(question: Question) -> dict[str, Any]:
    """A property under each encoding, with the shortest finite runs that distinguish them."""
    specification = replace(question.specification, properties=(question.chosen,))
    asked = questions_of(specification, list(ENCODINGS.values()))
    (found,) = document(answer(asked, OF_A_COMPARISON, (Runs.FINITE,)))["properties"]
    return dict(found)


def _answered(
    ask: Callable[[Question], dict[str, Any]], body: bytes, message_paths: Sequence[str], folder: str = ""
) -> bytes:
    """The answer to what `body` asks, as JSON. Raises Refused."""
    return json.dumps(ask(read_question(body, message_paths, folder)), allow_nan=False).encode()


_QUESTIONS = {"check": _check, "judge": judge, "explain": _explain, "compare": _compare, "open": open_file}

ANSWERS = {name: partial(_answered, ask) for name, ask in _QUESTIONS.items()}
"""What can be asked, by the names that questions are posted to."""
