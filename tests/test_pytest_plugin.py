"""The fixture `ltlc_monitor`, in runs of pytest of its own."""

from __future__ import annotations

import subprocess
import sys
import textwrap

import pytest
from test_docs import ROOT, blocks

import ltlc

pytest_plugins = ["pytester"]

PROPS = "decl speed /speed Float64.data\nslow: never speed > 2\n"
STOPS = "decl speed /speed Float64.data\nstops: always (speed > 2 implies eventually speed < 1 within 1 s)\n"


@pytest.fixture(scope="module", autouse=True)
def imported() -> None:
    """What a monitor needs, before the first run forgets what it has imported: numpy and Spot are not loaded twice."""
    ltlc.monitor(PROPS)


class Runs:
    """Runs a file of tests beside a `props.txt`."""

    def __init__(self, pytester: pytest.Pytester, *options: str) -> None:
        self._pytester = pytester
        self._options = options

    def __call__(self, tests: str, props: str = PROPS) -> pytest.RunResult:
        self._pytester.makefile(".txt", props=props)
        self._pytester.makepyfile(tests)
        return self._pytester.runpytest_inprocess("-p", "no:cacheprovider", *self._options)


@pytest.fixture
def run(pytester: pytest.Pytester, request: pytest.FixtureRequest) -> Runs:
    is_installed = request.config.pluginmanager.has_plugin("ltlc")
    return Runs(pytester, *([] if is_installed else ["-p", "ltlc.pytest_plugin"]))


def test_a_violation_fails_the_test_at_once_with_the_failing_state(run: Runs) -> None:
    found = run("""
        import pytest

        @pytest.mark.ltlc("props.txt")
        def test_drive(ltlc_monitor):
            for step, speed in enumerate([1.0, 3.0, 1.0]):
                print("step", step)
                ltlc_monitor.step({"speed": speed}, time=step / 10)
    """)
    found.assert_outcomes(failed=1)
    found.stdout.fnmatch_lines([
        "Error at line 2 of props.txt (slow):",
        "  never speed > 2",
        "Failing state:",
        "  speed: 3.0",
        "Because:",
        "  speed > 2: true, 3.0 > 2.0 by 1",
        "At +0.1 s (step 1).",
    ])  # fmt: skip
    text = found.stdout.str()
    assert "step 2" not in text
    assert "pytest_plugin.py" not in text
    assert "def test_drive" not in text


def test_a_violation_may_fail_the_test_at_its_end(run: Runs) -> None:
    found = run("""
        def test_drive(ltlc_monitor):
            ltlc_monitor.load("props.txt", at_once=False)
            print(ltlc_monitor.step({"speed": 3.0})["slow"].value)
            print("still here")
    """)
    found.assert_outcomes(failed=1)
    found.stdout.fnmatch_lines(["Error at line 2 of props.txt (slow):", "violated", "still here"])


def test_a_drive_that_violates_nothing_passes(run: Runs) -> None:
    found = run("""
        import pytest

        @pytest.mark.parametrize("speed", [0.5, 1.5])
        @pytest.mark.ltlc("props.txt")
        def test_drive(ltlc_monitor, speed):
            ltlc_monitor.step({"speed": speed}, time=0.0)
    """)
    found.assert_outcomes(passed=2)


def test_what_is_owed_at_the_end_fails_the_test_unless_that_is_allowed(run: Runs) -> None:
    found = run(
        """
        import pytest

        @pytest.mark.ltlc("props.txt")
        def test_owed(ltlc_monitor):
            ltlc_monitor.step({"speed": 3.0}, time=0.0)

        @pytest.mark.ltlc("props.txt", allow_open=True)
        def test_allowed(ltlc_monitor):
            ltlc_monitor.step({"speed": 3.0}, time=0.0)
        """,
        STOPS,
    )
    found.assert_outcomes(passed=1, failed=1)
    found.stdout.fnmatch_lines(["At the end of the test:", "stops: presumably violated; unmet since +0 s*"])


def test_a_property_that_never_started_fails_the_test_and_a_misspelled_name_is_told(run: Runs) -> None:
    found = run("""
        import pytest

        @pytest.mark.ltlc("props.txt")
        def test_drive(ltlc_monitor):
            ltlc_monitor.step({"sped": 1.0})
    """)
    found.assert_outcomes(failed=1)
    found.stdout.fnmatch_lines(["slow: not started*", "*LTL806*", "*did you mean `sped`*"])


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ('ltlc_monitor.load("missing.txt")', "*there is no file*missing.txt"),
        ('ltlc_monitor.load(text="never robot.velocty > 2")', "*did you mean `velocity`?"),
        ('ltlc_monitor.load("props.txt", signals="speed")', "`signals` must be a list of names*"),
        ("ltlc_monitor.load()", "give the properties either as a file or as `text`"),
        ("ltlc_monitor.step({})", "no properties: mark the test with `ltlc`*"),
        ('ltlc_monitor.load("props.txt"); ltlc_monitor.step({"speed": "fast"})', '*`"fast"` is not a number*'),
    ],
)
def test_what_cannot_be_used_fails_the_test_without_a_traceback(run: Runs, body: str, told: str) -> None:
    found = run(f"def test_drive(ltlc_monitor):\n    {body}\n")
    found.assert_outcomes(failed=1)
    found.stdout.fnmatch_lines([told])
    assert "Traceback" not in found.stdout.str()
    assert "def test_drive" not in found.stdout.str()


@pytest.mark.parametrize(
    "tests",
    [
        """
        def test_drive(request):
            monitor = request.getfixturevalue("ltlc_monitor")
            monitor.load("props.txt")
            monitor.step({"speed": 3}, time=0)
        """,
        """
        import pytest
        from unittest import TestCase

        class TestDrive(TestCase):
            @pytest.fixture(autouse=True)
            def watch(self, ltlc_monitor):
                self.monitor = ltlc_monitor

            @pytest.mark.ltlc("props.txt")
            def test_drive(self):
                self.monitor.step({"speed": 3}, time=0)
        """,
        """
        def test_two_drives(ltlc_monitor):
            ltlc_monitor.load("props.txt")
            ltlc_monitor.step({"speed": 3}, time=0)
            ltlc_monitor.load("props.txt")
            ltlc_monitor.step({"speed": 0}, time=0)
        """,
    ],
    ids=["asked for while it runs", "of unittest", "loaded again"],
)
def test_what_is_owed_fails_a_test_however_it_has_its_monitor(run: Runs, tests: str) -> None:
    found = run(tests, STOPS)
    found.assert_outcomes(failed=1)
    found.stdout.fnmatch_lines(["stops: presumably violated*"])


def test_properties_that_were_not_stepped_may_be_replaced(run: Runs) -> None:
    found = run("""
        import pytest

        @pytest.mark.ltlc("props.txt")
        def test_drive(ltlc_monitor):
            ltlc_monitor.load(text="never robot.velocity > 2")
            ltlc_monitor.step({"robot.velocity": 1})
    """)
    found.assert_outcomes(passed=1)


def test_a_marked_test_that_steps_nothing_fails(run: Runs) -> None:
    found = run('import pytest\n\n@pytest.mark.ltlc("props.txt")\ndef test_drive():\n    pass\n')
    found.assert_outcomes(failed=1)
    found.stdout.fnmatch_lines(["the test is marked with `ltlc`, but does not step `ltlc_monitor`"])


def test_a_failure_of_the_test_itself_is_told_as_ever(run: Runs) -> None:
    found = run("""
        import pytest

        @pytest.mark.ltlc("props.txt")
        def test_drive(ltlc_monitor):
            ltlc_monitor.step({"speed": 1.0})
            assert 1 == 2
    """)
    found.assert_outcomes(failed=1)
    found.stdout.fnmatch_lines([">*assert 1 == 2"])


def test_the_plugin_imports_nothing_else_of_ltlc() -> None:
    code = "import sys, ltlc.pytest_plugin; print(*sorted(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    modules = [name for name in done.stdout.split() if name.split(".")[0] in ("ltlc", "numpy", "spot")]
    assert modules == ["ltlc", "ltlc.pytest_plugin"]


ROBOT = """
class Robot:
    time = speed = 0.0

    def step(self):
        self.time = round(self.time + 0.1, 1)
        self.speed = round(3 * self.time, 1)
"""


def test_the_example_of_the_documentation_is_so(run: Runs, pytester: pytest.Pytester) -> None:
    [block] = [block for block in blocks("docs/python.md") if "ltlc_monitor" in block]
    pytester.makepyfile(simulation=ROBOT)
    found = run(block)
    found.assert_outcomes(failed=1)
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    figure = page[page.index("    Error at line 2 of props.txt") :].partition("\n\n")[0]
    found.stdout.fnmatch_lines(textwrap.dedent(figure).splitlines())
