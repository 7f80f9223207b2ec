"""`ltlc run`: recorded runs, judged by the monitors that a node would have."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter_ns

from ltlc.columns.timing import timing
from ltlc.commands.common import OK, compile_file, report, unusable, unwritable
from ltlc.commands.progress import saying
from ltlc.files import refuse_unwritable, write_bytes
from ltlc.recordings import Block
from ltlc.recordings.reading import Reading, Stamp
from ltlc.recordings.run import Judge, Watcher
from ltlc.runtime.reports import printable
from ltlc.runtime.times import seconds_text


def run(options: argparse.Namespace) -> int:
    """Judge the recordings, and show the report in the format asked for."""
    from ltlc.campaigns.places import is_one

    for path in filter(None, (options.report, options.output)):
        try:
            refuse_unwritable(path)
        except OSError as error:
            return unwritable(path, error)
    outcome = compile_file(options)
    if isinstance(outcome, int):
        return outcome
    specification, compiled = outcome
    message_paths = tuple(map(str, options.msg_path))
    reading = Reading(Stamp(options.stamp), message_paths, options.since, options.until)
    judge = Judge(compiled, specification, reading, options.verdicts, bool(options.report or options.output))
    if options.results or options.summary or options.engine or not is_one(options.recordings):
        from ltlc.commands.campaign import run_several

        return run_several(judge, options)
    return _run_one(judge, Path(options.recordings[0]), options)


def _run_one(judge: Judge, path: Path, options: argparse.Namespace) -> int:
    """Judge one recording, and write what was asked for about it."""
    page = None
    if options.report:
        from ltlc.commands.page import Page

        page = Page(judge, options)
    with _progress(path) as watchers:
        found = (page or judge).judge(path, watchers)
    report(found.diagnostics)
    form = {"text": found.text, "json": found.json, "junit": found.junit}[options.format]
    start = perf_counter_ns()
    sys.stdout.write(form())
    if options.timing and found.session is not None:
        sys.stderr.write(timing(found.session, found.reading, found.judging, perf_counter_ns() - start))
    written = [] if page is None else [(options.report, page.content())]
    if options.output:
        from ltlc.recordings.output import NotWritableError, verdicts_mcap

        try:
            written.append((options.output, verdicts_mcap(found)))
        except NotWritableError as error:
            return unusable(f"{options.output} is not written: {error}")
    return _write(written) or found.exit_code


@contextmanager
def _progress(path: Path) -> Iterator[list[Watcher]]:
    """What says on a terminal how far a recording has been judged."""
    rows = 0
    with saying(f"judging {printable(path.name)}") as say:

        def watch(block: Block) -> None:
            nonlocal rows
            rows += len(block.times)
            if say is not None and len(block.times):
                say(f"{rows:,} rows, up to {seconds_text(int(block.times[-1]))} s")

        yield [watch]


def _write(written: Sequence[tuple[Path, bytes]]) -> int:
    """Write the files; the exit code if one cannot be."""
    for path, content in written:
        try:
            write_bytes(path, content)
        except OSError as error:
            return unwritable(path, error)
        print(f"ltlc: wrote {path}", file=sys.stderr)
    return OK
