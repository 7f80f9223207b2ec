"""For pytest: the fixture `ltlc_monitor`, which tests of simulations step, and which fails them for a violation.

Each run of pytest imports it in an environment that has ltlc; the compiler is imported where a test asks for it.
"""

from __future__ import annotations

import warnings
from collections.abc import Generator, Iterable, Mapping
from functools import lru_cache
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from ltlc.base.diagnostics import Diagnostic
    from ltlc.base.source import Source
    from ltlc.interfaces.api.monitor import LiveRun
    from ltlc.interfaces.api.prepare import Prepared
    from ltlc.interfaces.api.times import Seconds
    from ltlc.semantics.verdicts import Verdict

_MARKER = "ltlc(file, *, text, at_once=True, allow_open=False): the properties that `ltlc_monitor` watches"


class LtlcMonitor:
    """The properties that a test is watched by; names of files are relative to `folder`."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._run: LiveRun | None = None
        self._is_stepped = False
        self._at_once = True
        self._allow_open = False

    def load(
        self,
        file: str | PathLike[str] = "",
        *,
        text: str = "",
        at_once: bool = True,
        allow_open: bool = False,
        signals: Iterable[str] | None = None,
        encoding: str = "episode",
        message_paths: Iterable[str | PathLike[str]] = (),
    ) -> None:
        """Watch the properties in `file`, or those in `text`, from before the first step on.

        A violation fails the test `at_once`, or otherwise at its end. An obligation still open then, or a property
        never started, fails it, too, unless `allow_open`. `signals`, `encoding` and `message_paths` are those of
        `ltlc.monitor`. A run that was stepped before ends here.
        """
        from ltlc.base.errors import UnusableInput
        from ltlc.interfaces.api.monitor import LiveRun
        from ltlc.interfaces.api.prepare import read

        if bool(file) == bool(text):
            raise _failed("give the properties either as a file or as `text`")
        if self._is_stepped:
            self.finish()
        try:
            source = read(self._folder / file if file else text)
            prepared = _prepared(source, encoding, tuple(str(self._folder / path) for path in message_paths))
            self._run = LiveRun(prepared, signals)
            for each in prepared.late:
                warnings.warn(each.message, stacklevel=2)
        except UnusableInput as error:
            raise _failed(str(error)) from None
        self._at_once, self._allow_open, self._is_stepped = at_once, allow_open, False

    def step(
        self, values: Mapping[str, object], time: Seconds | None = None, *, time_ns: int | None = None
    ) -> dict[str, Verdict]:
        """Take a row, as what `ltlc.monitor` gives does; the verdicts after it. Fails the test if one is violated."""
        from ltlc.base.errors import UnusableInput

        run = self._loaded()
        self._is_stepped = True
        try:
            changes = run.step(values, time, time_ns=time_ns)
        except UnusableInput as error:
            raise _failed(str(error)) from None
        if changes and self._at_once:
            self._fail_if_violated(run)
        return run.verdicts

    def finish(self) -> None:
        """The run is over, as at the end of a test: fail the test for what is violated, unmet or never started."""
        from ltlc.base.diagnostics import Severity
        from ltlc.base.render import full

        if self._run is None:
            return
        self._fail_if_violated(self._run)
        found = self._run.finish()
        if found.exit_code and not self._allow_open:
            lines = (str(result) for result in found.values() if not result.verdict.holds)
            remarks = full.render(each for each in found.diagnostics if each.severity is not Severity.NOTE)
            raise _failed("\n".join(["At the end of the test:", *lines, "", remarks]).rstrip())

    def _loaded(self) -> LiveRun:
        if self._run is None:
            raise _failed("no properties: mark the test with `ltlc`, or call `ltlc_monitor.load`")
        return self._run

    def _fail_if_violated(self, run: LiveRun) -> None:
        if violations := run.violations:
            raise _failed("\n\n".join(map(str, violations)))


_MONITOR = pytest.StashKey[LtlcMonitor]()
"""Where a test has its monitor, however it has asked for it."""


def _failed(message: str) -> BaseException:
    """What fails a test with this message, and nothing of how it came about."""
    return pytest.fail.Exception(message, pytrace=False)


@lru_cache(maxsize=64)
def _prepared(source: Source | Diagnostic, encoding: str, message_paths: tuple[str, ...]) -> Prepared:
    """The monitors, which are made once for all tests. Raises UnusableInput."""
    from ltlc.base.limits import Budget
    from ltlc.interfaces.api.prepare import encoding_of, prepare

    return prepare(source, message_paths, encoding_of(encoding), Budget())


def pytest_configure(config: pytest.Config) -> None:
    """Tell of the marker."""
    config.addinivalue_line("markers", _MARKER)


@pytest.fixture
def ltlc_monitor(request: pytest.FixtureRequest) -> LtlcMonitor:
    """Properties that the test steps: those of its marker `ltlc`, or those that it loads."""
    monitor = LtlcMonitor(request.path.parent)
    request.node.stash[_MONITOR] = monitor
    marker = request.node.get_closest_marker("ltlc")
    if marker is not None:
        monitor.load(*marker.args, **marker.kwargs)
    return monitor


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    """Once a test has passed, look what its properties say at the end."""
    result = yield
    monitor = item.stash.get(_MONITOR, None)
    if monitor is not None:
        monitor.finish()
    elif item.get_closest_marker("ltlc") is not None:
        raise _failed("the test is marked with `ltlc`, but does not step `ltlc_monitor`")
    return result
