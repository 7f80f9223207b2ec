"""`ltlc run`: recorded runs, judged by the monitors that a node would have."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter_ns

from ltlc.automata import Budget
from ltlc.base.files import refuse_unwritable, write_all
from ltlc.inputs.recordings import Block
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import OK, compile_file, overwritten, refused, report, unusable, unwritable
from ltlc.interfaces.commands.cutting import add_cut, cutting, refuse_cut, show_extracts, show_nothing_cut
from ltlc.interfaces.commands.progress import saying
from ltlc.interfaces.commands.watching import add_watch, watched
from ltlc.monitoring.columns.timing import timing
from ltlc.monitoring.judging.run import Judge, Watcher
from ltlc.runtime.reports import printable
from ltlc.runtime.times import Scale


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc run` takes."""
    arguments.add_specification(parser)
    arguments.add_reading(parser)
    arguments.add_budget(parser, "limits for translating one property", 10.0)
    arguments.add_recordings(parser)
    _add_campaign(parser.add_argument_group("many recordings"))
    parser.add_argument("--format", choices=("text", "json", "junit"), default="text")
    parser.add_argument("--all", action="store_true", help="in text, list all violations, not only the first ones")
    parser.add_argument(
        "--robustness",
        action="store_true",
        help="in text and JSON, also report by how much each property holds, or is violated",
    )
    parser.add_argument("--verdicts", action="store_true", help="with JSON, include the verdict after each step")
    parser.add_argument(
        "--timing",
        action="store_true",
        help="report on stderr how each property was judged, why, and how long it took",
    )
    parser.add_argument(
        "--report",
        type=Path,
        metavar="FILE.html",
        help="write an HTML page: verdicts over the signals, the monitors, what failed",
    )
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FILE.mcap",
        help="write the verdicts as topics with the times of the recording, for Foxglove and PlotJuggler",
    )
    parser.add_argument(
        "--evidence",
        type=Path,
        metavar="FILE",
        help="write what the verdicts follow from, to be checked by `ltlc certify --evidence`; of several recordings, "
        "with --results, what is missing is appended",
    )
    parser.add_argument(
        "--guard",
        action="store_true",
        help="judge what the guards of the file would have let through, and report what they would have done",
    )
    add_cut(parser.add_argument_group("extracts"))
    add_watch(parser)


def _add_campaign(group: argparse._ArgumentGroup) -> None:
    arguments.add_jobs(group)
    group.add_argument(
        "--engine",
        metavar="ADDRESS",
        help="judge them on the workers of the Dask scheduler at ADDRESS, such as tcp://host:8786; "
        "`local` starts one with --jobs workers",
    )
    group.add_argument(
        "--results",
        type=Path,
        metavar="FILE.parquet",
        help="keep the results in a table; with the same FILE, judge only what is missing, failed or changed",
    )
    group.add_argument(
        "--summary", type=Path, metavar="FILE.html", help="write an HTML page that summarises all of them"
    )


def run(options: argparse.Namespace) -> int:
    """Judge once, or whenever a file changes; the exit code."""
    if not options.cut and (options.before, options.after) != (None, None):
        return unusable("--before and --after need --cut")
    if options.guard:
        from ltlc.interfaces.commands.guarded import refused_beside

        if why := refused_beside(options):
            return unusable(why)
    if options.watch:
        outputs = (options.report, options.output, options.summary, options.results, options.evidence, options.cut)
        read = [options.specification, *options.recordings, *options.msg_path]
        return watched(_run, options, read, [each for each in outputs if each])
    return _run(options)


def _run(options: argparse.Namespace) -> int:
    """Judge the recordings, and show the report in the format asked for."""
    from ltlc.monitoring.campaigns.places import find, is_one

    if options.output:
        from ltlc.monitoring.judging import output  # noqa: F401  what it needs may not be installed
    outputs = (options.report, options.output, options.summary, options.evidence)
    named = [each for each in options.recordings if is_one([each])]
    if twice := overwritten(outputs, [options.specification, *named]):
        return refused(twice)
    for path in filter(None, (options.report, options.output, options.evidence)):
        try:
            refuse_unwritable(path)
        except OSError as error:
            return unwritable(path, error)
    found, paths = None, [Path(each) for each in named]
    if options.results or options.summary or options.engine or not is_one(options.recordings):
        with saying("looking for recordings", options.quiet):
            found = find(options.recordings, options.results)
        paths = found.paths
    cut = cutting(options, None if found is None else [place.name for place in found.places])
    if cut is not None and (code := refuse_cut(cut, list(cut.folders) or options.recordings, options)):
        return code
    prepared = compile_file(options, paths)
    if isinstance(prepared, int):
        return prepared
    guards = None
    if options.guard:
        from ltlc.interfaces.commands.guarded import guarding

        found_guards = guarding(prepared, options)
        if isinstance(found_guards, int):
            return found_guards
        guards = found_guards
    keep_trails = bool(options.report or options.output)
    evidence = None
    if options.evidence:
        from ltlc.monitoring.judging.evidence import evidence_by

        with saying("making certificates", options.quiet):
            budget = Budget(*options.budget)
            evidence = evidence_by(prepared.compiled, prepared.specification, budget)
    judge = Judge(
        prepared.compiled,
        prepared.specification,
        arguments.reading(options),
        options.verdicts,
        keep_trails,
        remarks=prepared.late,
        hashed=options.format != "text" or bool(options.results or options.output),
        evidence=evidence,
        cutting=cut,
        guarding=guards,
        measures=options.robustness,
    )
    if found is not None:
        from ltlc.interfaces.commands.campaign import run_several

        return run_several(judge, found, options)
    return _run_one(judge, Path(options.recordings[0]), options)


def _run_one(judge: Judge, path: Path, options: argparse.Namespace) -> int:
    """Judge one recording, and write what was asked for about it."""
    page = None
    if options.report:
        from ltlc.interfaces.commands.page import Page

        page = Page(judge, options)
    with _progress(path, options.quiet) as watchers:
        found = (page or judge).judge(path, watchers)
    report(found.diagnostics)
    form = {"text": lambda: found.text(options.all), "json": found.json, "junit": found.junit}[options.format]
    start = perf_counter_ns()
    sys.stdout.write(form())
    if options.timing and found.blocks is not None:
        sys.stderr.write(timing(found.blocks, found.reading, found.judging, perf_counter_ns() - start))
    written = {}
    if page is not None:
        with saying("drawing the page", options.quiet):
            written[options.report] = page.content()
    if options.output:
        from ltlc.monitoring.judging.output import NotWritableError, verdicts_mcap

        try:
            with saying("collecting the verdicts", options.quiet):
                written[options.output] = verdicts_mcap(found)
        except NotWritableError as error:
            return unusable(f"{options.output} is not written: {error}")
    if options.evidence:
        if found.evidence is None:
            return unusable(f"{options.evidence} is not written: not all of the recording could be judged")
        from ltlc.assurance.evidence.document import printed

        written[options.evidence] = printed(found.evidence).encode()
    code = _write(written, options.quiet)
    if found.cut is not None:
        show_extracts(found.cut.extracts, options)
        if found.cut.error:
            return unusable(found.cut.error)
        if not found.cut.extracts:
            show_nothing_cut(options)
    return code or found.exit_code


@contextmanager
def _progress(path: Path, quiet: bool) -> Iterator[list[Watcher]]:
    """Shows on a terminal how much of a recording has been judged."""
    rows, scale = 0, Scale()
    with saying(f"judging {printable(path.name)}", quiet) as say:

        def watch(block: Block) -> None:
            nonlocal rows, scale
            if say is not None and len(block.times):
                scale = scale if rows else Scale(int(block.times[0]))
                say(f"{rows + len(block.times):,} rows, up to {scale.text(int(block.times[-1]))}")
            rows += len(block.times)

        yield [watch]


def _write(written: Mapping[Path, bytes], quiet: bool) -> int:
    """Write all the files or none, and name them unless `quiet`; the exit code if one cannot be written."""
    try:
        write_all(written)
    except OSError as error:
        return unwritable(error.filename, error)
    if not quiet:
        for path in written:
            print(f"ltlc: wrote {path}", file=sys.stderr)
    return OK
