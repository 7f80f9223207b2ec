"""Are there two names for one signal?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.groups import definition_inputs
from ltlc.analysis.subjects import Study
from ltlc.base.diagnostics import Label
from ltlc.specification.expressions import Field, Signal
from ltlc.specification.specification import Definition


def ask(study: Study) -> Iterator[Finding]:
    """A warning for each pair of defined names that read one field of one topic."""
    names: dict[Field, str] = {}
    reported = set()
    for signal in _signals(study):
        if not isinstance(signal.definition, Field):
            continue
        first = names.setdefault(signal.definition, signal.name)
        one, other = _definition(study, first), _definition(study, signal.name)
        if first == signal.name or other is None or (one, other) in reported:
            continue
        reported.add((one, other))
        yield Finding(
            "LTL604",
            other.span,
            f"`{signal.name}` and `{first}` are the same signal: {_where(signal.definition)}",
            secondary=(Label(one.span, "the same signal"),) if one and one != other else (),
            help="use one name for it",
        )


def _signals(study: Study) -> Iterator[Signal]:
    """The signals that properties read, and those they are computed from."""
    for subject in study.subjects:
        for value in subject.specification.inputs():
            yield value.signal
            for part in definition_inputs(value.signal):
                yield part.signal


def _definition(study: Study, name: str) -> Definition | None:
    """Where the first word of a signal's name is defined; a primitive of an object without declaration is not."""
    word = name.partition(".")[0].partition("[")[0]
    return next((d for d in study.specification.definitions if d.name == word), None)


def _where(field: Field) -> str:
    path = "".join(f".{step}" if isinstance(step, str) else f"[{step}]" for step in field.path)
    return f"`{field.message.rpartition('/')[2]}{path}` on {field.topic}"
