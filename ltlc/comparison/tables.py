"""A comparison laid out: headings, paragraphs and tables, which every form of output for people shows in its way."""

from __future__ import annotations

import re
import string
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ltlc.automata.queries import Size
from ltlc.comparison.reference import shown
from ltlc.comparison.results import (
    Answer,
    Comparison,
    Kind,
    Measured,
    Monitored,
    Question,
    Recorded,
    Related,
    Relation,
    SeparatingRun,
)
from ltlc.limits import Exceeded
from ltlc.semantics.ltl import renamed
from ltlc.semantics.verdicts import Verdict


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

VERDICTS = {
    Verdict.VIOLATED: "violated",
    Verdict.PRESUMABLY_VIOLATED: "presumably violated",
    Verdict.PRESUMABLY_SATISFIED: "presumably satisfied",
    Verdict.SATISFIED: "satisfied",
    Verdict.NOT_STARTED: "not started",
}


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
    names = short_names(question.alphabet.atoms)
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
    letters = () if run is None else tuple(frozenset(names[atom] for atom in letter) for letter in run)
    return (
        size_text(Size(len(monitored.monitor.verdicts), monitored.edges)),
        f"{monitored.seconds * 1000:.1f} ms",
        monitored.monitorability.value,
        "never" if run is None else shown(letters),
    )


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
            yield Paragraph(f"On {kind.value} runs: not decided, the question {related}.")
            continue
        yield Paragraph(relation_text(comparison, kind, related))
        for name, run in ((comparison.left, related.left_only), (comparison.right, related.right_only)):
            if run is not None:
                yield Paragraph(_caption(name, kind, run))
                yield _run(question, comparison, run)


def relation_text(comparison: Comparison, kind: Kind, related: Related) -> str:
    """How two formulas relate on one kind of runs, and on how many runs that was tried, in a sentence."""
    confirmed = related.confirmation
    letters = "" if confirmed.all_letters else ", over one letter of each kind"
    return (
        f"On {kind.value} runs, {comparison.left} {RELATIONS[related.relation]} {comparison.right} "
        f"(as on all {confirmed.runs:,} runs of up to {count(confirmed.length, 'step')}{letters})."
    )


def _caption(name: str, kind: Kind, run: SeparatingRun) -> str:
    which = "The shortest" if run.is_shortest else "A"
    return f"{which} {kind.value} run that only {name} accepts:"


def _run(question: Question, comparison: Comparison, run: SeparatingRun) -> Table:
    """Step by step: values of the signals, or the atoms where no values are known, and both verdicts."""
    values = question.values(run.letters, run.loop)
    if values is None:
        signals = tuple(atom for atom in question.alphabet.atoms)
        rows = [tuple("●" if atom in letter else "·" for atom in signals) for letter in run.letters]
    else:
        signals = tuple(values[0])
        rows = [tuple(value_text(step[signal]) for signal in signals) for step in values]
    verdicts = zip(run.left_verdicts, run.right_verdicts, strict=True)
    return Table(
        ("step", *signals, comparison.left, comparison.right),
        tuple(
            (_step_text(number, run), *row, VERDICTS[left], VERDICTS[right])
            for number, (row, (left, right)) in enumerate(zip(rows, verdicts, strict=True))
        ),
    )


def _step_text(number: int, run: SeparatingRun) -> str:
    """The number of a step, marked if it repeats for ever."""
    return f"{number} ↻" if run.loop is not None and number >= run.loop else str(number)


def value_text(value: object) -> str:
    """A value as it is written in the language."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _recording(recorded: Recorded) -> Iterator[Block]:
    yield Heading(2, f"on {recorded.recording}")
    if not recorded.partings:
        final = sorted({VERDICTS[verdict] for verdict in recorded.verdicts.values()})
        said = f"{' or '.join(final)} at the end" if final else "nothing"
        yield Paragraph(f"The choice does not matter on its {count(recorded.steps, 'step')}: {said}.")
        return
    yield Table(
        ("left", "right", "part at step", "left says there", "right says there", "left at the end", "right at the end"),
        tuple(
            (
                parting.left,
                parting.right,
                str(parting.step),
                VERDICTS[parting.left_verdict],
                VERDICTS[parting.right_verdict],
                VERDICTS[recorded.verdicts[parting.left]],
                VERDICTS[recorded.verdicts[parting.right]],
            )
            for parting in recorded.partings
        ),
    )
