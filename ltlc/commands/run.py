"""`ltlc run`: a recorded run, judged by the monitors that a node would have."""

from __future__ import annotations

import argparse
import sys
from time import perf_counter_ns

from ltlc.columns.timing import timing
from ltlc.commands.common import compile_file, report
from ltlc.recordings.run import run as run_recording


def run(options: argparse.Namespace) -> int:
    """Judge the recording, and show the report in the format asked for."""
    outcome = compile_file(options)
    if isinstance(outcome, int):
        return outcome
    specification, compiled = outcome
    found = run_recording(compiled, specification, options.recording, options.verdicts, options.since, options.until)
    report(found.diagnostics)
    form = {"text": found.text, "json": found.json, "junit": found.junit}[options.format]
    start = perf_counter_ns()
    sys.stdout.write(form())
    if options.timing and found.session is not None:
        sys.stderr.write(timing(found.session, found.reading, found.judging, perf_counter_ns() - start))
    return found.exit_code
