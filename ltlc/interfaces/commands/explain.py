"""`ltlc explain`: the properties of a file in plain English and by examples, or the page of a diagnostic."""

from __future__ import annotations

import argparse
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path

from ltlc.analysis import guard_words
from ltlc.analysis.analyse import study_of
from ltlc.analysis.explanation import CLASSES, Explanation, explain
from ltlc.analysis.wording import listed
from ltlc.automata import Budget, SpotMissing
from ltlc.base.codes import find, page
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.render.table import example_lines
from ltlc.frontend.language import load_text
from ltlc.frontend.language.suppression import unsuppressed
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import OK, failure, read_specification, report, unusable
from ltlc.interfaces.commands.progress import progress
from ltlc.semantics.encodings import ENCODINGS
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.guards import Guard
from ltlc.specification.specification import Specification

WIDTH = 110
"""Columns to which text is wrapped."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc explain` takes."""
    parser.add_argument(
        "subject", metavar="PROPS_OR_CODE", help="a specification file, `-` for stdin, or a code such as LTL101"
    )
    arguments.add_reading(parser)
    arguments.add_budget(parser, "limits for explaining the whole file", 30.0)


def run(options: argparse.Namespace) -> int:
    """Show the page of a code, or explain each property of a file."""
    code = find(options.subject)
    if code is not None and not Path(options.subject).exists():
        print(page(code), end="")
        return OK
    if re.fullmatch(r"LTL\d+", options.subject.upper()) and not Path(options.subject).exists():
        return unusable(f"no diagnostic is called {options.subject}")
    encoding = ENCODINGS[options.encoding]
    source = read_specification(Path(options.subject), options.msg_path)
    if isinstance(source, Diagnostic):
        report([source])
        return failure([source])
    specification, diagnostics = load_text(source, options.msg_path, encoding)
    if specification is None:
        report(unsuppressed(diagnostics))
        return failure(diagnostics)
    try:
        with progress("explaining", options.quiet) as watch:
            study = study_of(specification, encoding, Budget(*options.budget))
            explanations = explain(study, Budget(*options.budget), watch)
    except SpotMissing as error:
        return unusable(str(error))
    guards = ("\n".join(_guard_lines(specification, guard)) for guard in specification.guards)
    print("\n\n".join([*guards, *("\n".join(_lines(explanation)) for explanation in explanations)]))
    return OK


def _guard_lines(specification: Specification, guard: Guard) -> Iterator[str]:
    """One guard."""
    yield f"guard of {guard.out}"
    yield from _indented(guard.text)
    yield ""
    yield from _indented(guard_words.sentences(specification, guard))
    yield ""
    yield from _entry("keeps", ", ".join(each.label for each in specification.kept_by(guard)))
    if assumed := [each.label for each in specification.properties if each.is_assumed]:
        yield from _entry("assumes", ", ".join(assumed))
    for fallback in guard.fallbacks:
        yield from _entry("sends", f"{fallback.name}: {guard_words.contents(fallback)}")
    if waits := guard_words.waits_for(specification, guard):
        yield from _entry("begins", f"once a message has come on {listed(waits)}; until then nothing leaves it")


def _lines(explained: Explanation) -> Iterator[str]:
    """One property."""
    yield explained.label
    yield from _indented(explained.text)
    yield ""
    yield from _indented(explained.english)
    yield ""
    for name, words in explained.conditions:
        yield from _entry("atom", name if name == words else f"{name}: {words}")
    yield from _entry("topics", ", ".join(explained.topics) or "none")
    yield from _entry("begins", explained.begins)
    if explained.temporal_class:
        yield from _entry("class", f"{explained.temporal_class}: {CLASSES[explained.temporal_class]}")
    yield from _entry("monitor", _monitor_text(explained))
    if explained.limit:
        yield from _entry("runs", f"none shown: finding them {explained.limit}")
    if explained.not_shown:
        missing = listed([verdict.value.replace("_", " ") for verdict in explained.not_shown], "or")
        yield from _entry("runs", f"none shown that is {missing}: no values were found for its steps")
    for example in explained.examples:
        caption, *table = example_lines(example.as_json())
        yield ""
        yield f"  {caption}"
        yield from (f"    {line}" for line in table)


_SHOWS = {Verdict.VIOLATED: "refute", Verdict.SATISFIED: "prove"}
"""What a finite run does to a property that has the verdict."""


def _monitor_text(explained: Explanation) -> str:
    """The size of the monitor, and the verdicts that it can give."""
    if explained.states is None:
        return "takes too long to make"
    number = f"{explained.states} state{'' if explained.states == 1 else 's'}"
    can = listed([verdict.value.replace("_", " ") for verdict in explained.verdicts])
    missing = [each for each in _SHOWS if each not in explained.verdicts]
    shows = " or ".join(_SHOWS[each] for each in missing)
    cannot = (
        f"; never {listed([each.value for each in missing], 'or')}: no finite run can {shows} it" if missing else ""
    )
    return f"{number}; while the robot runs it can report {can}{cannot}"


def _entry(title: str, text: str) -> list[str]:
    return textwrap.wrap(
        text, WIDTH, initial_indent=f"  {title:<9}", subsequent_indent=" " * 11, break_long_words=False
    )


def _indented(text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent="  ", subsequent_indent="  ", break_long_words=False)
