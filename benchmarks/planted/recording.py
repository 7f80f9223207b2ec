"""Which tests run which lines of ltlc, and for how long: recorded once, so that few tests need to run for a fault."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import coverage
import pytest
from coverage import CoverageData

SETTINGS = """[run]
data_file = {folder}/lines
source = ltlc
core = ctrace
relative_files = true
parallel = true
context = ${{PYTEST_CURRENT_TEST-}}
disable_warnings = no-data-collected, module-not-measured, couldnt-parse, no-ctracer
"""
"""Of coverage: of Python that tests start too, by the test that pytest names in their environment; not of forks."""


class Recorder:
    """A plugin of pytest that records the lines and the time of each test."""

    def __init__(self, folder: Path, name: str) -> None:
        settings = folder / "settings"
        settings.write_text(SETTINGS.format(folder=folder), encoding="utf-8")
        os.environ["COVERAGE_PROCESS_START"] = str(settings)
        self.notes = times_of(folder, name).open("w", encoding="utf-8")
        self.outcome = ""
        os.environ["PYTEST_CURRENT_TEST"] = ""
        self.lines = coverage.Coverage(config_file=str(settings))
        self.lines.start()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Record one test, with what it sets up."""
        self.lines.switch_context(item.nodeid)
        self.outcome = "passed"
        began = used()
        result = yield
        print(json.dumps([item.nodeid, round(used() - began, 3), self.outcome]), file=self.notes, flush=True)
        return result

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep what is not well of a test."""
        if not report.passed:
            self.outcome = report.outcome

    def pytest_unconfigure(self) -> None:
        """Keep the lines."""
        self.lines.stop()
        self.lines.save()


def times_of(folder: Path, name: str) -> Path:
    """Where the times of a file of tests are written."""
    return folder / f"times-{Path(name).stem}.jsonl"


def used() -> float:
    """The seconds of a processor that this process and its children have used."""
    return sum(os.times()[:4])


class Recorded:
    """What is known of the tests: which run a line, and the seconds that each takes."""

    def __init__(self, folder: Path) -> None:
        self.seconds: dict[str, float] = {}
        for file in sorted(folder.glob("times-*.jsonl")):
            for line in file.read_text(encoding="utf-8").splitlines():
                test, seconds, outcome = json.loads(line)
                if outcome == "passed":
                    self.seconds[test] = seconds
        self.data = CoverageData(basename=str(folder / "all-lines"))
        for part in sorted(folder.glob("lines.*")):
            lines = CoverageData(basename=str(part))
            lines.read()
            self.data.update(lines)

    def running(self, path: Path, lines: range) -> set[str]:
        """The tests that run one of the lines of a file; what a child runs is told by what pytest said of the test."""
        contexts = self.data.contexts_by_lineno(str(path))
        found = {context.split("|")[-1] for line in lines for context in contexts.get(line, ())}
        return {name.removesuffix(" (call)").removesuffix(" (setup)") for name in found} & self.seconds.keys()
