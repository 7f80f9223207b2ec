"""A specification made of what is imported: each property with the original beside it, and what could not be said."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from fractions import Fraction

from ltlc.base.source import Source
from ltlc.frontend.layout import layout
from ltlc.frontend.starter.rules import comment
from ltlc.importing.conversion import Imported
from ltlc.importing.names import Signals
from ltlc.importing.writing import Reading
from ltlc.semantics.durations import duration_text

_PASSED = re.compile(r"@\{([^{}]+) or not \1, -(\d+) else false\}")
_COUNTS = re.compile(r"@\{|\bwithin\b|\bfor\b")


def document(imported: Sequence[Imported], signals: Signals, reading: Reading, tool: str, origin: str) -> str:
    """The text of the specification; `tool` is the form of the file `origin`."""
    said = [each for each in imported if each.text]
    equal = sum(each.shown is not None and each.shown.is_equal for each in said)
    lines = comment(
        f"Imported by `ltlc import` from {origin} ({tool}): {len(said)} of {len(imported)} requirements; "
        f"{equal} shown equal to their formulas."
    )
    texts, passed = _named([each.text for each in said], signals)
    text = "\n".join((*texts, *passed))
    is_timed = reading.step is not None and _COUNTS.search(text) is not None
    if is_timed:
        lines += comment(
            f"Read at points {duration_text(reading.step or 1)} apart: `X`, `Y` and bounds count them. "
            "Another time between them is given by `--step`."
        )
    if declared := list(signals.declarations(text)):
        lines += comment("The file does not say where all signals come from: give each its topic and type.")
    lines += ["", f"_rate_ = {rate(reading.step)}"] if is_timed and reading.step else []
    lines += ["", *declared, *passed]
    labels: dict[str, int] = {}
    for each, written in zip(said, texts, strict=True):
        lines += ["", *_property(each, written, signals, tool, labels, reading.step)]
    lost = [each for each in imported if not each.text]
    lines += ["", "# Not imported:"] if lost else []
    for each in lost:
        lines += ["", *comment(f"{each.requirement.id}: {each.problem}.")]
        lines += [line for part in (each.requirement.text, each.requirement.original) if part for line in comment(part)]
    found = layout(Source("", "\n".join(lines) + "\n"))
    assert isinstance(found, str), found
    return found


def rate(step: int | None) -> str:
    """The frequency of points that are `step` nanoseconds apart, in Hz; empty if it has no end as a decimal."""
    frequency = Fraction(10**9, step or 1)
    text = format(float(frequency), ".15g")
    return text if Fraction(text) == frequency and "e" not in text else ""


def _named(texts: Sequence[str], signals: Signals) -> tuple[list[str], list[str]]:
    """`texts` with a name for what says that there was a tick so many ticks ago; and the definitions of these names."""
    names: dict[str, str] = {}
    for found in _PASSED.finditer("\n".join(texts)):
        if found[0] not in names:
            names[found[0]] = signals.label(f"passed_{found[2]}")
    for whole, name in names.items():
        texts = [text.replace(whole, name) for text in texts]
    return list(texts), [f"{name} = {whole}  # there was a tick so many ticks ago" for whole, name in names.items()]


def _property(
    each: Imported, text: str, signals: Signals, tool: str, ids: dict[str, int], step: int | None
) -> Iterator[str]:
    """A property, with what is known of it in front."""
    requirement = each.requirement
    yield from (line.replace("#", "##", 1) for line in comment(requirement.text)) if requirement.text else ()
    yield from comment(f"{tool}: {requirement.original}") if requirement.original else ()
    yield from (
        line
        for note in (*requirement.notes, *_shown(each, tool), *other_reading(each, step))
        for line in comment(f"{note[0].upper()}{note[1:]}.")
    )
    count = ids[requirement.id] = ids.get(requirement.id, 0) + 1
    name = requirement.id if count == 1 else f"{requirement.id} ({count})"
    attributes = [f"id {_quoted(name)}"]
    attributes += [f"rationale {_quoted(requirement.rationale)}"] if requirement.rationale else []
    yield f"[{', '.join(attributes)}]"
    yield f"{signals.label(requirement.id)}: {text}"


def other_reading(each: Imported, step: int | None) -> Iterator[str]:
    """What the formula would mean in the other reading, where that is something else; points are a `step` apart."""
    if (parting := each.parting) is None:
        return
    here, there = parting.at_points, parting.over_signals
    other = "over signals (`--reading signals`)"
    if step is None:
        here, there = there, here
        other = f"at points {duration_text(parting.step)} apart (`--reading points`)"
    told = [f"would {word} `{run}`" for word, run in (("not accept", here), ("also accept", there)) if run]
    yield f"{other} it {' and '.join(told)}"


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _shown(each: Imported, tool: str) -> Iterator[str]:
    """How the property relates to the formula."""
    shown = each.shown
    if each.requirement.meaning is None:
        return
    if shown is None:
        yield f"not shown equal: {each.problem}"
        return
    parts = {f"the formula of {tool}": shown.formula_only, "this property": shown.property_only}
    told = [f"only {who} accepts `{run}`" for who, run in parts.items() if run]
    if shown.finite:
        yield f"shown equal on infinite runs; of runs that end, {'; '.join(told)}"
    elif told:
        yield f"not equal: {'; '.join(told)}"
    elif shown.only_infinite:
        yield f"shown equal on infinite runs; runs that end are not compared: {shown.only_infinite}"
    else:
        yield "shown equal"
