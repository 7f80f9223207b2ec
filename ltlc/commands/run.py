"""`ltlc run`: recorded runs, judged by the monitors that a node would have."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from time import perf_counter_ns

from ltlc.columns.timing import timing
from ltlc.commands.common import compile_file, report
from ltlc.recordings.reading import Reading, Stamp
from ltlc.recordings.run import Judge


def run(options: argparse.Namespace) -> int:
    """Judge the recordings, and show the report in the format asked for."""
    from ltlc.campaigns.places import is_one

    outcome = compile_file(options)
    if isinstance(outcome, int):
        return outcome
    specification, compiled = outcome
    message_paths = tuple(map(str, options.msg_path))
    reading = Reading(Stamp(options.stamp), message_paths, options.since, options.until)
    judge = Judge(compiled, specification, reading, options.verdicts)
    asks_for_several = options.results or options.summary or options.engine
    if asks_for_several or not is_one(options.recordings):
        from ltlc.commands.campaign import run_several

        return run_several(judge, options)
    return _run_one(judge, Path(options.recordings[0]), options)


def _run_one(judge: Judge, path: Path, options: argparse.Namespace) -> int:
    found = judge.judge(path)
    report(found.diagnostics)
    form = {"text": found.text, "json": found.json, "junit": found.junit}[options.format]
    start = perf_counter_ns()
    sys.stdout.write(form())
    if options.timing and found.session is not None:
        sys.stderr.write(timing(found.session, found.reading, found.judging, perf_counter_ns() - start))
    return found.exit_code
