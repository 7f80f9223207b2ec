"""The page of `ltlc run --report`: made while recordings are judged, one after the other."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from ltlc.analysis.analyse import study_of
from ltlc.analysis.explanation import explain
from ltlc.base.limits import Budget
from ltlc.interfaces.commands.progress import saying
from ltlc.interfaces.pages.report import PageReport
from ltlc.monitoring.judging.run import Judge, RunReport, Watcher
from ltlc.semantics.encodings import ENCODINGS


class Page:
    """Judges as `judge` does, which has to keep trails, and draws so many `recordings`."""

    def __init__(self, judge: Judge, options: argparse.Namespace, recordings: int = 1) -> None:
        self._judge = judge
        self._report = PageReport(judge.compiled, judge.specification, recordings)
        with saying("explaining the properties", options.quiet) as say:
            if say is not None:
                say("by examples")
            budget = Budget(*options.budget)
            study = study_of(judge.specification, ENCODINGS[options.encoding], budget)
            self._report.explain(explain(study, budget))

    def judge(self, path: Path, watchers: Sequence[Watcher] = (), name: str = "") -> RunReport:
        """What the recording at `path` shows, which goes on the page, too."""
        collected = self._report.collector()
        found = self._judge.judge(path, [collected.take, *watchers], name)
        self._report.add(found, collected)
        return found

    def content(self) -> bytes:
        """The page."""
        return self._report.html().encode()
