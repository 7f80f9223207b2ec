"""The comparison as a Python function, for scripts and notebooks: `ltlc.compare`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Literal

from ltlc.analysis.comparison.answer import answer
from ltlc.analysis.comparison.bounded import within
from ltlc.analysis.comparison.document import document, rows_of
from ltlc.analysis.comparison.encoding_file import read_encodings
from ltlc.analysis.comparison.formula_files import questions_of_arguments, questions_of_file
from ltlc.analysis.comparison.questions import KNOWN, questions_of
from ltlc.analysis.comparison.results import Answer, Question, Recorded, Runs
from ltlc.analysis.comparison.tables import Block, blocks_of
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget, Exceeded, Watch
from ltlc.base.provenance import provenance
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.frontend.language import load_text, read_source
from ltlc.frontend.language.each import refusals
from ltlc.frontend.language.suppression import unsuppressed
from ltlc.inputs.recordings.digests import digests
from ltlc.interfaces.api.notebook import show_pictures
from ltlc.interfaces.api.prepare import Text, encoding_of, folders, read
from ltlc.interfaces.api.tables import Display
from ltlc.semantics.encodings import ENCODINGS, Encoding
from ltlc.specification.specification import Specification

Reading = Literal["both", "infinite", "finite"]

KINDS: Mapping[Reading, tuple[Runs, ...]] = {
    "both": (Runs.INFINITE, Runs.FINITE),
    "infinite": (Runs.INFINITE,),
    "finite": (Runs.FINITE,),
}


@dataclass(frozen=True)
class Table(Display):
    """The result of a comparison: an answer for each property or group of formulas.

    `recordings` has what each recording shows of each answer, `diagnostics` what else is to be
    said about the input. It was made of `sources` and of the recordings in `files`.
    """

    answers: tuple[Answer, ...]
    recordings: tuple[tuple[Recorded, ...], ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()
    sources: tuple[Source, ...] = ()
    files: tuple[Path, ...] = ()

    def __iter__(self) -> Iterator[Answer]:
        return iter(self.answers)

    def __len__(self) -> int:
        return len(self.answers)

    def __getitem__(self, label: str) -> Answer:
        """The answer about the property with this label. Raises KeyError."""
        for each in self.answers:
            if each.question.label == label:
                return each
        raise KeyError(label)

    def blocks(self) -> Iterator[Block]:
        """Each answer, and what each recording shows of it."""
        return blocks_of(self.answers, self.recordings)

    def document(self) -> dict[str, Any]:
        """The result as the JSON document of `ltlc compare --format json`."""
        made_of = provenance(self.sources, (each for path in self.files for each in digests(path)))
        return {**document(self.answers, self.recordings), "provenance": made_of}

    def rows(self) -> list[dict[str, Any]]:
        """A row for each property, pair of encodings and kind of runs."""
        return list(rows_of(self.answers, self.recordings))

    @property
    def is_complete(self) -> bool:
        """Whether no question ran into a limit."""
        related = (
            part for each in self.answers for comparison in each.comparisons for part in comparison.related.values()
        )
        return not any(isinstance(part, Exceeded) for part in related)


def compare(
    specification: Text | None = None,
    *,
    ltl: Sequence[str] | str | Path | None = None,
    encodings: Sequence[str | Encoding] | None = None,
    encoding_files: Sequence[str | Path] = (),
    recordings: Sequence[str | Path] = (),
    reading: Reading = "both",
    message_paths: Sequence[str | Path] = (),
    budget: Budget | None = None,
    watch: Watch | None = None,
) -> Table:
    """Compare the encodings of each property of `specification`, or the formulas `ltl`.

    `specification` is a text if it is a `str`, a file if it is a `pathlib.Path`. `ltl` is a list of formulas in
    Spot's syntax, or the path of a file of them. `encodings` are names, of those of ltlc and those in
    `encoding_files`, or encodings; by default the four of the language and all in the files. `recordings` are CSV or
    JSONL files. `budget` is limits for each translation and each question; `watch` is called with the progress.

    Raises UnusableInput, SpotMissing, and Contradiction if the automata and the reference interpreter disagree.
    """
    show_pictures()
    budget = budget or Budget()
    if (specification is None) == (ltl is None):
        raise UnusableInput((), "either a specification or formulas are compared")
    if specification is None:
        questions, warnings = _formulas(ltl or (), budget)
        return Table(tuple(answer(questions, budget, KINDS[reading], watch)), (), tuple(warnings))
    chosen, warnings = _encodings(encodings, encoding_files, budget)
    source = read(specification)
    if isinstance(source, Diagnostic):
        raise UnusableInput([source])
    loaded, diagnostics = load_text(source, folders(message_paths))
    if loaded is None:
        raise UnusableInput(unsuppressed(diagnostics))
    if unfit := refusals(loaded, "compared"):
        raise UnusableInput(unfit)
    answers = answer(questions_of(loaded, chosen), budget, KINDS[reading], watch)
    shown, remarks = _recordings(recordings, loaded, answers, chosen)
    told = (*warnings, *unsuppressed(diagnostics), *remarks)
    return Table(tuple(answers), shown, told, (source,), tuple(map(Path, recordings)))


MOST_COMPARED = 1000
"""Formulas in one question: half a million pairs, each of which may take the budget."""


def _formulas(ltl: Sequence[str] | str | Path, budget: Budget) -> tuple[list[Question], list[Diagnostic]]:
    if isinstance(ltl, str | Path):
        source = read_source(Path(ltl))
        if isinstance(source, Diagnostic):
            raise UnusableInput([source])
        questions, problems = within(budget, partial(questions_of_file, source), f"to read {source.name}")
    else:
        questions, problems = within(budget, partial(questions_of_arguments, ltl), "to read the formulas")
    if not questions:
        raise UnusableInput(problems, "" if problems else "there are no formulas")
    if (count := max(len(question.candidates) for question in questions)) > MOST_COMPARED:
        raise UnusableInput((), f"{count} formulas would be compared with one another; at most {MOST_COMPARED} can be")
    return questions, problems


def _encodings(
    names: Sequence[str | Encoding] | None, files: Sequence[str | Path], budget: Budget
) -> tuple[list[Encoding], list[Diagnostic]]:
    """The encodings called `names`, and warnings about those in `files`."""
    own: dict[str, Encoding] = {}
    warnings: list[Diagnostic] = []
    for path in files:
        source = read_source(Path(path))
        if isinstance(source, Diagnostic):
            raise UnusableInput([source])
        found, problems = read_encodings(source, frozenset(KNOWN) | frozenset(own), budget)
        if not found:
            raise UnusableInput(problems)
        own.update({encoding.name: encoding for encoding in found})
        warnings += problems
    if names is None:
        return [*ENCODINGS.values(), *own.values()], warnings
    known = {**KNOWN, **own}
    return [n if isinstance(n, Encoding) else encoding_of(n, known) for n in dict.fromkeys(names)], warnings


def _recordings(
    paths: Sequence[str | Path], specification: Specification, answers: Sequence[Answer], encodings: Sequence[Encoding]
) -> tuple[tuple[tuple[Recorded, ...], ...], list[Diagnostic]]:
    """What each recording shows, and the findings about them."""
    if not paths:
        return (), []
    from ltlc.analysis.comparison.recorded import judge_recording  # brings the backends along

    found: list[tuple[Recorded, ...]] = []
    remarks: list[Diagnostic] = []
    for path in paths:
        recorded, diagnostics = judge_recording(Path(path), specification, answers, encodings)
        if recorded is None:
            raise UnusableInput(diagnostics)
        found.append(tuple(recorded))
        remarks += diagnostics
    return tuple(found), remarks
