"""`ltlc run` on several recordings: judged side by side, reported in their order, kept in a table."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path

from ltlc.backends.python.plan import plan_code
from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.files import refuse_unwritable, write_all
from ltlc.base.limits import in_order
from ltlc.interfaces.commands.common import UNUSABLE, overwritten, refused, report, unusable, unwritable
from ltlc.interfaces.commands.cutting import show_extracts, show_nothing_cut
from ltlc.interfaces.commands.page import Page
from ltlc.interfaces.commands.progress import progress, saying
from ltlc.monitoring.campaigns.bundle import Bundle, BundleError
from ltlc.monitoring.campaigns.campaign import Workers, here, judge_all, on_this_machine
from ltlc.monitoring.campaigns.engine import EngineError, on_engine
from ltlc.monitoring.campaigns.forms import FORMS
from ltlc.monitoring.campaigns.outcomes import Outcome
from ltlc.monitoring.campaigns.places import Found
from ltlc.monitoring.campaigns.results import Results, ResultsError, digest
from ltlc.monitoring.campaigns.tally import Tally
from ltlc.monitoring.judging.cutting import Cutting
from ltlc.monitoring.judging.run import Judge


def run_several(judge: Judge, found: Found, options: argparse.Namespace) -> int:
    """Judge the recordings that were found, each by itself; the exit code is the worst: 2, 1, 3, 0."""
    for name in ("output", "timing", "all"):
        if getattr(options, name):
            return unusable(f"--{name} takes a single recording")
    if options.report and (options.results or options.engine):
        return unusable("--report cannot be combined with --results and --engine; omit these, or use --summary")
    try:
        for path in filter(None, (options.results, options.summary, options.evidence)):
            refuse_unwritable(path)
    except OSError as error:
        return unwritable(path, error)
    if options.verdicts and options.results:
        return unusable("--verdicts cannot be kept in a table of results; omit one of the two")
    if twice := overwritten((options.report, options.summary, options.evidence), [each.name for each in found.places]):
        return refused(twice)
    report(found.problems)
    page = Page(judge, options, len(found.places)) if options.report else None
    try:
        tally = _judge(judge, found, options, page)
    except (EngineError, ResultsError) as error:
        report([error.diagnostic])
        return UNUSABLE
    except BundleError as error:
        return unwritable(options.evidence, error.error)
    written: dict[Path, bytes | str] = {}
    if options.summary:
        from ltlc.analysis.english import English
        from ltlc.monitoring.campaigns.page import summary_page

        english = {each.specification.label: English(each.specification).sentence() for each in judge.compiled}
        with saying("drawing the summary", options.quiet):
            written[options.summary] = summary_page(
                judge.specification.source.name, tally, found, english, options.summary.parent
            )
    if page is not None:
        with saying("drawing the page", options.quiet):
            written[options.report] = page.content()
    try:
        write_all(written)
    except OSError as error:
        return unwritable(error.filename, error)
    return UNUSABLE if found.problems else tally.exit_code


def _judge(judge: Judge, found: Found, options: argparse.Namespace, page: Page | None) -> Tally:
    """Judge what was found, and report results as they come, on a `page` too. Raises EngineError, ResultsError."""
    tally, form, remarks = Tally(), FORMS[options.format](), Remarks(judge.remarks)
    report(judge.remarks)
    numbers = {place.name: number for number, place in enumerate(found.places)}
    with ExitStack() as open_:
        bundle, results = None, None
        if judge.evidence is not None:
            bundle = open_.enter_context(Bundle(options.evidence, judge.evidence))
        if options.results:
            is_all = bundle is None and judge.cutting is None
            is_complete = None if is_all else partial(_is_complete, judge.cutting, bundle)
            results = open_.enter_context(Results(options.results, _digest(judge, options), found.places, is_complete))
        kept = results.names() if results else set()
        earlier = results.kept() if results else ()
        waiting = [place for place in found.places if place.name not in kept]
        workers = here(page) if page is not None else open_.enter_context(_workers(options, len(waiting)))
        judged = _watched(judge_all(judge, waiting, workers), len(waiting), options, results)
        for outcome in in_order((numbers[each.place.name], each) for each in chain(earlier, judged)):
            tally.add(outcome, is_kept=outcome.place.name in kept)
            remarks.add(outcome.diagnostics)
            sys.stdout.write(form.add(outcome))
            if outcome.place.name not in kept:
                show_extracts(outcome.extracts, options)
            if bundle is not None and outcome.place.name in kept:
                bundle.keep(outcome.place)
            elif bundle is not None:
                bundle.add(outcome.place, outcome.evidence)
    remarks.tell(len(found.places))
    if bundle is not None and bundle.lacking:
        names = ", ".join(bundle.lacking)
        print(f"ltlc: no evidence of what could not be judged to its end: {names}", file=sys.stderr)
    sys.stdout.write(form.end(tally, found))
    if judge.cutting is not None and not tally.extracts:
        show_nothing_cut(options)
    return tally


def _is_complete(cutting: Cutting | None, bundle: Bundle | None, outcome: Outcome) -> bool:
    """Whether an earlier campaign has left all that is asked for; otherwise, the recording is judged again."""
    is_cut = cutting is None or cutting.has(outcome.report.get("cut"), outcome.extracts)
    return is_cut and (bundle is None or bundle.has(outcome.place, outcome.report.get("evidence")))


def _digest(judge: Judge, options: argparse.Namespace) -> str:
    """What identifies how a campaign judged: the text, the monitors as code, and the settings."""
    code = plan_code(judge.compiled, judge.specification, ())
    text = judge.specification.source.text
    guarded = ["guarded"] if options.guard else []
    return digest([text, options.encoding, code, repr((judge.reading, judge.measures)), *guarded])


@contextmanager
def _workers(options: argparse.Namespace, count: int) -> Iterator[Workers]:
    if options.engine is None or not count:
        yield on_this_machine(options.jobs)
        return
    with on_engine(options.engine, options.jobs) as workers:
        yield workers


def _watched(
    outcomes: Iterator[Outcome], count: int, options: argparse.Namespace, results: Results | None
) -> Iterator[Outcome]:
    """`outcomes`, each kept in the table of results; progress is shown unless lines on stdout show it."""
    with progress("judging", options.quiet) as watch:
        for done, outcome in enumerate(map(_with_extracts_here, outcomes), 1):
            if results:
                results.add(outcome)
            if watch and (options.format != "text" or not sys.stdout.isatty()):
                watch(done, count)
            yield outcome


def _with_extracts_here(outcome: Outcome) -> Outcome:
    """The outcome, with an error if a worker has written an extract that cannot be seen from here."""
    elsewhere = next((each["file"] for each in outcome.extracts if not os.path.isfile(each["file"])), None)
    if elsewhere is None:
        return outcome
    error = f"{elsewhere} is not on this machine; workers must see the folder under the same name"
    return replace(outcome, report={**outcome.report, "cut": {**outcome.report["cut"], "error": error}})


class Remarks:
    """Diagnostics of many recordings: errors at once, others once each, with how many recordings have them.

    Those that are `told` already, since all recordings have them, are omitted.
    """

    def __init__(self, told: Sequence[Diagnostic] = ()) -> None:
        self._told = {(each.code, each.message) for each in told}
        self._first: dict[tuple[str, str], Diagnostic] = {}
        self._counts: dict[tuple[str, str], int] = {}

    def add(self, diagnostics: Sequence[Diagnostic]) -> None:
        """Those of the next recording."""
        report([each for each in diagnostics if each.severity is Severity.ERROR])
        for each in diagnostics:
            key = (each.code, each.message)
            if each.severity is not Severity.ERROR and key not in self._told:
                self._first.setdefault(key, each)
                self._counts[key] = self._counts.get(key, 0) + 1

    def tell(self, recordings: int) -> None:
        """Show warnings and notes."""
        told = (
            replace(each, message=f"{each.message} (in {self._counts[key]} of {recordings} recordings)")
            for key, each in self._first.items()
        )
        report(list(told))
