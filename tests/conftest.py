"""Settings that all tests share, and what those need that meet other nodes."""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections import defaultdict
from collections.abc import Generator, Hashable, Iterator, Sequence
from pathlib import Path

import pytest
from effort import ASKED, SHARE, limit_examples
from hypothesis import HealthCheck, settings
from in_process import in_process
from quick_gate import quick_gate
from ros_support import Network, Send, own_domain

from ltlc.automata import Budget, Exceeded, Task, translate_all
from ltlc.automata.batch import Known
from ltlc.base.limits import Watch, children
from ltlc.cli import ALLOCATIONS
from ltlc.semantics.monitor import Monitor

# Time varies with the load of the machine, and no test is about it. In CI the same commit gets the same answer; new
# examples are found where developers run the tests.
settings.register_profile(
    "ltlc", deadline=None, derandomize=bool(os.environ.get("CI")), suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("ltlc")

LONGEST = (
    "test_proofs.py",
    "test_assurance_time.py",
    "test_e2e_time.py",
    "test_mining.py",
    "test_backends_c.py",
    "test_e2e_node_faults.py",
    "test_assurance_replay.py",
    "test_e2e_node_watchdog.py",
    "test_certify_code.py",
    "test_damage.py",
    "test_commands_build.py",
    "test_serve_browser.py",
    "test_e2e_drives.py",
    "test_e2e_node.py",
    "test_commands_new.py",
    "test_openings_in_time.py",
    "test_columns.py",
    "test_backends_rust.py",
    "test_each_rust.py",
    "test_analysis_findings.py",
    "test_analysis_robots.py",
    "test_assurance_reading_rust.py",
    "test_beginnings.py",
    "test_differential.py",
    "test_bags.py",
    "test_runtime_time.py",
    "test_assurance_lowered.py",
    "test_assurance_cross_check.py",
    "test_backends_ament.py",
    "test_fuzz.py",
    "test_semantics_time.py",
)
"""The files that take longest, or wait longest, first: so that at the end no worker waits for another."""

LIVE = ("live", "ros")
"""The markers of tests that meet other processes in real time: one that fails runs once more, and that is reported."""

HAS_FAILED = pytest.StashKey[bool]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """How much random tests draw."""
    about = "what share of what random tests say they draw; campaigns take 1 or more (default: %(default)s)"
    parser.addoption("--share", type=float, default=SHARE, metavar="SHARE", help=about)


def pytest_configure(config: pytest.Config) -> None:
    """Keep what Python compiles with its environment, also where nothing is to be left beside the sources.

    A run starts hundreds of processes, each of which would compile all that it imports.
    """
    ASKED.share = config.getoption("--share")
    if os.environ.pop("PYTHONDONTWRITEBYTECODE", None):
        sys.dont_write_bytecode = False
        sys.pycache_prefix = os.environ["PYTHONPYCACHEPREFIX"] = str(Path(sys.prefix) / "compiled")
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        # As in a shell's background: what the tests start would ignore it, too, and some of it is ended by Ctrl-C.
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the files of `LONGEST` first; `--no-loadscope-reorder` lets xdist keep this order."""
    places = {name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: places.get(item.path.name, len(LONGEST)))
    for function in {item.function for item in items if isinstance(item, pytest.Function)}:
        limit_examples(function)
    for item in items:
        if any(item.get_closest_marker(name) for name in LIVE):
            item.add_marker(pytest.mark.flaky(reruns=1))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Note which tests fail."""
    report = yield
    item.stash[HAS_FAILED] = report.failed
    return report


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item) -> None:
    """End what a test that failed shares with others: its second run is to meet new processes."""
    if item.stash[HAS_FAILED] and item.get_closest_marker("flaky"):
        item.session._setupstate.teardown_exact(None)


def pytest_collection_finish() -> None:
    """Let no garbage collection look through all tests and what they import, which is there to stay.

    And let it look for garbage as seldom as in a command.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(ALLOCATIONS)


@pytest.fixture(scope="session", autouse=True)
def translated_once() -> Iterator[None]:
    """What differs in names only is translated once for all tests of a process: each translation takes a child."""
    monitors: defaultdict[Budget, dict[Hashable, Monitor | Exceeded]] = defaultdict(dict)

    def once(
        tasks: Sequence[Task], budget: Budget, watch: Watch | None = None, known: Known | None = None
    ) -> list[Monitor | Exceeded]:
        here = {} if known is None else known
        here |= monitors[budget]
        found = translate_all(tasks, budget, watch, here)
        monitors[budget] |= {shape: each for shape, each in here.items() if isinstance(each, Monitor)}
        return found

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ltlc.compiler.translate_all", once)
        yield


@pytest.fixture(scope="session", autouse=True)
def few_children() -> Iterator[None]:
    """What is done in children is done by one, or here: other processes run tests beside, and forks are slow."""
    with pytest.MonkeyPatch.context() as patch, in_process():
        patch.setattr(children, "_cpus", lambda: 1)
        yield


@pytest.fixture(autouse=True)
def own_handlers() -> Iterator[None]:
    """What handles signals here is what did before: a node's program, run in this process, takes them over."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.fixture
def quickly() -> Iterator[None]:
    """What is built is not analysed, cross-checked or replayed, for tests that are about something else."""
    with quick_gate():
        yield


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where the nodes of a module are, which hear each other and nobody else."""
    folder = tmp_path_factory.mktemp("nodes")
    with own_domain(folder):
        yield folder


@pytest.fixture
def network(folder: Path) -> Iterator[Network]:
    """Another node, of the test's own."""
    network = Network()
    yield network
    network.close()


@pytest.fixture
def send(network: Network) -> Send:
    """Publishes values of x, once somebody listens, as fast as it goes."""
    from std_msgs.msg import Float64

    publisher = network.publisher(Float64, "/x")

    def send(*values: float) -> None:
        network.matched([publisher])
        for value in values:
            publisher.publish(Float64(data=value))

    return send
