"""A comparison laid out: headings, paragraphs and tables, which every form of output for people shows in its way."""

from __future__ import annotations

import re
import string
from collections.abc import Iterator, Mapping, Sequence

from ltlc.analysis.comparison.reference import shown
from ltlc.analysis.comparison.results import (
    Answer,
    Comparison,
    Ending,
    Measured,
    Monitored,
    OtherBounds,
    Parting,
    Question,
    Recorded,
    Related,
    Relation,
    Runs,
    SeparatingRun,
    Values,
)
from ltlc.automata.queries import Size
from ltlc.base.limits import Exceeded
from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds, duration_text, seconds_text
from ltlc.semantics.instants import Instant
from ltlc.semantics.ltl import renamed
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter


@dataclass(frozen=True, slots=True)
class Heading:
    """The beginning of a part; level 1 is the outermost."""

    level: int
    text: str


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Running text."""

    text: str


@dataclass(frozen=True, slots=True)
class Table:
    """Columns with heads, and rows of texts."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


Block = Heading | Paragraph | Table

RELATIONS = {
    Relation.EQUIVALENT: "is equivalent to",
    Relation.STRONGER: "is stronger than",
    Relation.WEAKER: "is weaker than",
    Relation.INCOMPARABLE: "is incomparable with",
}

VERDICTS = {verdict: verdict.value.replace("_", " ") for verdict in Verdict}


def blocks_of(answers: Sequence[Answer], recordings: Sequence[Sequence[Recorded]] = ()) -> Iterator[Block]:
    """Everything that is to be shown of `answers`, and of what each recording shows of them, in order."""
    for number, answer in enumerate(answers):
        yield from _question(answer)
        for recording in recordings:
            yield from _recording(recording[number])


def _question(answer: Answer) -> Iterator[Block]:
    question = answer.question
    has_place = question.line is None or question.label.startswith("line ")
    yield Heading(1, question.label if has_place else f"{question.label} (line {question.line})")
    yield Paragraph(question.text)
    for name, reason in question.undefined.items():
        yield Paragraph(f"{name} is not defined here: {reason}.")
    if not answer.measured:
        return
    names = short_names([*question.atoms, *(a.name for a in question.timed if a.name not in question.atoms)])
    if any(atom != name for atom, name in names.items()):
        yield Table(("letter", "holds where"), tuple((name, atom) for atom, name in names.items()))
    yield Table(("name", "formula"), tuple((m.name, str(renamed(m.formula, names))) for m in answer.measured))
    yield Table(_MEASURES, tuple(_measures(measured, names) for measured in answer.measured))
    for comparison in answer.comparisons:
        yield from _comparison(question, comparison)


def short_names(atoms: Sequence[str]) -> dict[str, str]:
    """What atoms are called in formulas that are shown: a, b, …, or as they are if all are short words."""
    if all(_SHORT_WORD.fullmatch(atom) for atom in atoms):
        return {atom: atom for atom in atoms}
    letters = string.ascii_lowercase
    return {atom: letters[k] if len(atoms) <= len(letters) else f"p{k}" for k, atom in enumerate(atoms)}


_SHORT_WORD = re.compile(r"[a-z_]\w{0,19}")


_MEASURES = (
    "name",
    "size",
    "class",
    "Spot, deterministic",
    "Spot, non-deterministic",
    "monitor",
    "translated in",
    "decidable",
    "violated at the earliest",
)


def _measures(measured: Measured, names: Mapping[str, str]) -> tuple[str, ...]:
    kind = measured.temporal_class
    return (
        measured.name,
        str(measured.size),
        str(kind) if isinstance(kind, Exceeded) else kind.value,
        size_text(measured.deterministic),
        size_text(measured.nondeterministic),
        *_monitored(measured.monitored, names),
    )


def _monitored(monitored: Monitored | Exceeded, names: Mapping[str, str]) -> tuple[str, str, str, str]:
    if isinstance(monitored, Exceeded):
        return str(monitored), "", "", ""
    run = monitored.earliest_violation
    letters = () if run is None else tuple(_renamed(letter, names) for letter in run)
    return (
        size_text(Size(len(monitored.monitor.verdicts), monitored.edges)),
        f"{monitored.seconds * 1000:.1f} ms",
        monitored.monitorability.value,
        "never" if run is None else shown(letters),
    )


def _renamed(letter: Letter, names: Mapping[str, str]) -> Letter:
    called = frozenset(names[atom] for atom in letter)
    return Instant(letter.time, called, by_time=letter.by_time) if isinstance(letter, Instant) else called


def size_text(size: Size | Exceeded) -> str:
    """States and edges, or the limit that was met."""
    return str(size) if isinstance(size, Exceeded) else f"{count(size.states, 'state')}, {count(size.edges, 'edge')}"


def count(number: int, noun: str) -> str:
    """`1 step`, `2 steps`."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def _comparison(question: Question, comparison: Comparison) -> Iterator[Block]:
    yield Heading(2, f"{comparison.left} and {comparison.right}")
    for kind, related in comparison.related.items():
        if isinstance(related, Exceeded):
            yield Paragraph(f"On {kind.value} runs: not decided ({related.reason}).")
            continue
        yield Paragraph(relation_text(comparison, kind, related))
        for name, run in ((comparison.left, related.left_only), (comparison.right, related.right_only)):
            if run is not None:
                yield Paragraph(_caption(name, kind, run))
                yield _run(question, comparison, run)


def relation_text(comparison: Comparison, kind: Runs, related: Related) -> str:
    """How two formulas relate on one kind of runs, and on how many runs that was tried, in a sentence."""
    confirmed = related.confirmation
    letters = "" if confirmed.all_letters else ", with one letter of each kind"
    letters += ", at each bound and just past it" if confirmed.in_time else ""
    return (
        f"On {kind.value} runs, {comparison.left} {RELATIONS[related.relation]} {comparison.right} "
        f"(as on all {confirmed.runs:,} runs of up to {count(confirmed.length, 'step')}{letters})."
    )


def _caption(name: str, kind: Runs, run: SeparatingRun) -> str:
    which = "The shortest" if run.is_shortest else "A"
    return f"{which} {kind.value} run that only {name} accepts:"


def _run(question: Question, comparison: Comparison, run: SeparatingRun) -> Table:
    """Step by step: the time, if it counts, values of the signals, or the atoms, and both verdicts."""
    values = question.values(run.letters, run.loop)
    if values is None:
        signals = question.atoms
        rows = [tuple("●" if atom in letter else "·" for atom in signals) for letter in run.letters]
    else:
        signals = tuple(values[0])
        rows = [tuple(value_text(step[signal]) for signal in signals) for step in values]
    leading = list(_leading(run))
    verdicts = zip(run.left_verdicts, run.right_verdicts, strict=True)
    return Table(
        (*(("step", "time in s")[: len(leading[0])]), *signals, comparison.left, comparison.right),
        tuple(
            (*first, *row, VERDICTS[left], VERDICTS[right])
            for first, row, (left, right) in zip(leading, rows, verdicts, strict=True)
        ),
    )


def _leading(run: SeparatingRun) -> Iterator[tuple[str, ...]]:
    """The number of each step, marked if it repeats forever, and its time; none where only time passes."""
    number = 0
    for row, letter in enumerate(run.letters):
        mark = " ↻" if run.loop is not None and row >= run.loop else ""
        if not isinstance(letter, Instant):
            yield (f"{row}{mark}",)
            continue
        yield f"{'' if letter.by_time else number}{mark}".strip(), seconds_text(letter.time)
        number += not letter.by_time


def value_text(value: object) -> str:
    """A value as it is written in the language."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _recording(recorded: Recorded) -> Iterator[Block]:
    yield Heading(2, f"on {recorded.recording}")
    if recorded.partings:
        yield _partings(recorded)
    else:
        final = sorted({VERDICTS[verdict] for verdict in recorded.verdicts.values()})
        said = f"{' or '.join(final)} at the end" if final else "nothing"
        yield Paragraph(f"The choice makes no difference on its {count(recorded.steps, 'step')}: {said}.")
    for bounds in recorded.bounds:
        yield from _other_bounds(bounds)


def _partings(recorded: Recorded) -> Table:
    head = (
        "left",
        "right",
        "differ at",
        "left verdict there",
        "right verdict there",
        "left at the end",
        "right at the end",
    )
    return Table(
        (*head, "values there"),
        tuple(
            (
                parting.left,
                parting.right,
                _moment_text(parting),
                VERDICTS[parting.left_verdict],
                VERDICTS[parting.right_verdict],
                VERDICTS[recorded.verdicts[parting.left]],
                VERDICTS[recorded.verdicts[parting.right]],
                values_text(parting.values),
            )
            for parting in recorded.partings
        ),
    )


def _moment_text(parting: Parting) -> str:
    return f"{'after ' * parting.by_time}step {parting.step}, {seconds_text(parting.time)} s"


def values_text(values: Values) -> str:
    """`near = true, speed = 0.5`."""
    return ", ".join(f"{name} = {value_text(value)}" for name, value in values.items())


def _other_bounds(bounds: OtherBounds) -> Iterator[Block]:
    """How the recording would have ended with other bounds, or that it would not have mattered."""
    what = f"{', '.join(bounds.names)}: the bound of {duration_text(bounds.duration)} in `{bounds.text}`"
    if not bounds.endings:
        yield Paragraph(f"{what}: the effect of another bound is unknown, {bounds.obstacle}.")
    elif len(bounds.endings) == 1:
        yield Paragraph(f"{what}: with any other bound, also {VERDICTS[bounds.endings[0].verdict]} at the end.")
    else:
        yield Paragraph(f"{what}, and other bounds in its place:")
        rows = tuple(_ending(ending, bounds.duration) for ending in bounds.endings)
        yield Table(("bound", "at the end", "because of", "values there"), rows)


def _ending(ending: Ending, written: Nanoseconds) -> tuple[str, str, str, str]:
    is_written = ending.least <= written and (ending.most is None or written <= ending.most)
    bounds = f"{_bounds_text(ending.least, ending.most)}{' (as written)' * is_written}"
    moment = "" if ending.step is None else f"step {ending.step}, {seconds_text(ending.time or 0)} s"
    return bounds, VERDICTS[ending.verdict], moment, values_text(ending.values)


def _bounds_text(least: Nanoseconds, most: Nanoseconds | None) -> str:
    """`from 2 s`, `below 2 s`, or both; where that is shorter, `above`, `up to` a nanosecond less."""
    if most == least:
        return duration_text(least)
    edges = [(least, "from", "above")] if least > 1 else []
    edges += [] if most is None else [(most + 1, "below", "up to")]
    texts = ((f"{word} {duration_text(edge)}", f"{other} {duration_text(edge - 1)}") for edge, word, other in edges)
    return ", ".join(min(each, key=len) for each in texts)
