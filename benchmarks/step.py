"""Nanoseconds a step of emitted monitors on six properties, beside rtamt, reelay and hpl-rv in the same run.

    python -m benchmarks.step [--peers SITE-PACKAGES] [--samples N] [--passes N] [--rounds N]

Peers are taken if they can be imported, from the folder given with `--peers` too; what is missing is said. All get the
same samples, prepared in the form that each wants, one call a sample, and one monitor a property. `session` is
what steps monitors in `ltlc run`, `monitor` that of `ltlc.monitor`, which steps dictionaries. A figure is the
median over the rounds, which go around the tools in turn, and includes the loop that makes the calls; `call` is the
same loop around an empty function with two arguments.

The two stream languages have no unbounded future: they get past-time formulas that are false from the violation on, or
while something is owed. Every monitor has to accept the samples and to notice bad samples after them.
"""

from __future__ import annotations

import argparse
import math
import platform
import statistics
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from time import process_time_ns
from types import SimpleNamespace
from typing import Any

import ltlc
from ltlc.automata import Budget
from ltlc.backends import python
from ltlc.backends.python import standalone_classes
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load_text
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.specification import Specification

DECLARATIONS = """
decl distance /distance std_msgs/Float64.data
decl speed /speed std_msgs/Float64.data
decl battery /battery std_msgs/Float64.data
"""

NAMES = ("distance", "speed", "battery")

Sample = tuple[float, float, float]
"""Distance, speed, battery."""


@dataclass(frozen=True)
class Case:
    """A property in the languages of all tools, and samples after which it is not as it was."""

    name: str
    ltlc: str
    hpl: str
    rtamt: str
    reelay: str
    bad: tuple[Sample, ...]
    timed: bool = False


CASES = (
    Case(
        "absence",
        "never speed > 2",
        "globally: no /state {speed > 2.0}",
        "historically(speed <= 2.0)",
        "historically{speed <= 2.0}",
        ((3.0, 9.0, 1.0),),
    ),
    Case(
        "response",
        "always (distance < 1 implies eventually speed < 0.1)",
        "globally: /state {distance < 1.0} causes /state {speed < 0.1}",
        "not((speed >= 0.1) since ((distance < 1.0) and (speed >= 0.1)))",
        "not({speed >= 0.1} since ({distance < 1.0} and {speed >= 0.1}))",
        ((0.5, 1.0, 1.0),),
    ),
    Case(
        "stop sign",
        "after_until distance < 1, distance > 1, eventually speed < 0.1",
        "after /state {distance < 1.0} until /state {distance > 1.0}: some /state {speed < 0.1}",
        "historically((distance > 1.0) implies not((speed >= 0.1) since ((distance < 1.0) and (speed >= 0.1))))",
        "historically({distance > 1.0} -> not({speed >= 0.1} since ({distance < 1.0} and {speed >= 0.1})))",
        ((0.5, 1.0, 1.0), (3.0, 1.0, 1.0)),
    ),
    Case(
        "after",
        "after battery < 0.5, never speed > 2",
        "after /state {battery < 0.5}: no /state {speed > 2.0}",
        "historically((speed > 2.0) implies not(once(battery < 0.5)))",
        "historically({speed > 2.0} -> not(once{battery < 0.5}))",
        ((3.0, 9.0, 0.1),),
    ),
    Case(
        "existence",
        "eventually battery < 0.01",
        "globally: some /state {battery < 0.01}",
        "once(battery < 0.01)",
        "once{battery < 0.01}",
        ((3.0, 1.0, 0.001),),
    ),
    Case(
        "response within 2 s",
        "always (distance < 1 implies eventually speed < 0.1 within 2 s)",
        "globally: /state {distance < 1.0} causes /state {speed < 0.1} within 2 s",
        "not((speed >= 0.1) since[201:1200] ((distance < 1.0) and (speed >= 0.1)))",
        "not({speed >= 0.1} since[201:] ({distance < 1.0} and {speed >= 0.1}))",
        ((0.5, 1.0, 1.0),) * 202,
        timed=True,
    ),
)

PERIOD = 10_000_000
"""Nanoseconds between samples, for those who are told the time; the stream languages count samples."""

Tool = Callable[[Case, Sequence[Sample]], "Prepared"]


@dataclass(frozen=True)
class Prepared:
    """A monitor ready to run: `run` makes one call for each sample, `state` tells what it has seen so far."""

    run: Callable[[], None]
    state: Callable[[], Any]


def samples(count: int) -> list[Sample]:
    """A robot that drives past a sign again and again and stops there, late; its battery drains."""
    return [
        (2.5 + 2.0 * math.cos(t), 0.95 + 0.95 * math.cos(t - 0.3), 1.0 - 0.9 * i / count)
        for i in range(count)
        for t in [i / 50]
    ]


def call_tool(case: Case, stream: Sequence[Sample]) -> Prepared:
    """The loop alone, with the time where others are told it."""

    def empty(first: float, second: float) -> None:
        pass

    def empty_timed(time: int, first: float, second: float) -> None:
        pass

    def run() -> None:
        for distance, speed, _ in stream:
            empty(distance, speed)

    def run_timed() -> None:
        now = 0
        for distance, speed, _ in stream:
            empty_timed(now, distance, speed)
            now += PERIOD

    return Prepared(run_timed if case.timed else run, lambda: None)


def _compiled(case: Case) -> tuple[list[Compiled], Specification]:
    specification, _ = load_text(Source("props.txt", DECLARATIONS + case.ltlc))
    assert specification is not None
    return compile_specification(specification, EPISODE, Budget(30.0, 1024))[0], specification


def ltlc_tool(case: Case, stream: Sequence[Sample]) -> Prepared:
    """The class that `ltlc build --target python` writes."""
    compiled, specification = _compiled(case)
    namespace: dict[str, Any] = {"__name__": "emitted"}
    exec(python.emit(compiled, specification), namespace)
    [written] = standalone_classes(compiled, "props.txt")
    monitor = namespace[written.name](*([0] if case.timed else []))
    order = [NAMES.index(name) for name, _ in written.parameters]
    values = [tuple(sample[i] for i in order) for sample in stream]
    time = [0]

    def run_timed() -> None:
        step, now = monitor.step, time[0]
        for first, second in values:
            step(now, first, second)
            now += PERIOD
        time[0] = now

    def run() -> None:
        step = monitor.step
        if len(order) == 1:
            for (value,) in values:
                step(value)
            return
        for first, second in values:
            step(first, second)

    return Prepared(run_timed if case.timed else run, lambda: monitor.verdict)


def session_tool(case: Case, stream: Sequence[Sample]) -> Prepared:
    """The session of `ltlc run`, row by row."""
    session = Session(load_plan(*_compiled(case)))
    rows = ByRows(session)
    names = tuple(name for topic in session.messages for name in session.fields[topic])
    order = [NAMES.index(name) for name in names]
    values = [[sample[i] for i in order] for sample in stream]
    time = [0]

    def run() -> None:
        step, now = rows.samples, time[0]
        for row in values:
            step(now, names, row)
            now += PERIOD
        time[0] = now

    return Prepared(run, lambda: session.tracks[0].verdict)


def monitor_tool(case: Case, stream: Sequence[Sample]) -> Prepared:
    """`ltlc.monitor`, stepped by dictionaries with times in seconds."""
    monitor = ltlc.monitor(DECLARATIONS + case.ltlc)
    values = [dict(zip(NAMES, sample, strict=True)) for sample in stream]
    time = [0]

    def run() -> None:
        step, now = monitor.step, time[0]
        for row in values:
            step(row, now / 1e9)
            now += PERIOD
        time[0] = now

    return Prepared(run, lambda: monitor.verdicts)


def hpl_tool(case: Case, stream: Sequence[Sample]) -> Prepared:
    """The class that hpl-rv generates."""
    from hpl.parser import property_parser
    from hplrv.gen import MonitorGenerator

    text = MonitorGenerator(lang="py").monitor_library([property_parser().parse(case.hpl)])
    namespace: dict[str, Any] = {"__name__": "generated"}
    exec(text, namespace)
    monitor = next(value for name, value in namespace.items() if name.endswith("Monitor") and name != "Monitor")()
    monitor.on_launch(0.0)
    messages = [SimpleNamespace(distance=d, speed=s, battery=b) for d, s, b in stream]
    time = [0.0]

    def run() -> None:
        step, now = monitor.on_msg__state, time[0]
        for message in messages:
            step(message, now)
            now += PERIOD / 1e9
        time[0] = now

    return Prepared(run, lambda: (monitor.verdict, monitor.is_falsifiable_state))


def reelay_tool(case: Case, stream: Sequence[Sample]) -> Prepared:
    """The discrete monitor of reelay, which evaluates in C++."""
    import reelay

    monitor = reelay.discrete_timed_monitor(pattern=case.reelay, semantics="boolean", condense=False)
    values = [{"distance": d, "speed": s, "battery": b} for d, s, b in stream]
    last: list[Any] = [None]

    def run() -> None:
        step = monitor.update
        answer = None
        for value in values:
            answer = step(value)
        last[0] = answer

    return Prepared(run, lambda: str(last[0]))


def rtamt_tool(case: Case, stream: Sequence[Sample]) -> Prepared:
    """The discrete online monitor of rtamt, in Python."""
    import rtamt

    monitor = rtamt.StlDiscreteTimeSpecification()
    for name in ("distance", "speed", "battery", "out"):
        monitor.declare_var(name, "float")
    monitor.spec = f"out = {case.rtamt}"
    monitor.parse()
    monitor.pastify()
    values = [[("distance", d), ("speed", s), ("battery", b)] for d, s, b in stream]
    last, time = [0.0], [0]

    def run() -> None:
        step = monitor.update
        start, answer = time[0], 0.0
        for i, value in enumerate(values, start):
            answer = step(i, value)
        time[0], last[0] = start + len(values), answer

    return Prepared(run, lambda: last[0] >= 0)


TOOLS: dict[str, Tool] = {
    "call": call_tool,
    "ltlc": ltlc_tool,
    "session": session_tool,
    "monitor": monitor_tool,
    "hpl-rv": hpl_tool,
    "reelay": reelay_tool,
    "rtamt": rtamt_tool,
}

SHARES = {"rtamt": 20, "reelay": 5, "session": 5, "monitor": 5}
"""Slow tools get only a part of the passes."""


def size(name: str, case: Case, most: int) -> int:
    """How many samples a tool gets: rtamt takes over 100 ms for each with a window of 1,000 samples."""
    return min(most, 4) if name == "rtamt" and case.timed else most


def available() -> Iterator[str]:
    """The tools that can be imported; the others are named on stderr."""
    for name, tool in TOOLS.items():
        try:
            tool(CASES[0], samples(2))
        except ImportError as error:
            print(f"{name} is left out: {error}", file=sys.stderr)
        else:
            yield name


def check(name: str, case: Case, count: int) -> None:
    """End the program if a monitor does not tell a good run from one with bad samples after it."""
    good = TOOLS[name](case, samples(count))
    good.run()
    bad = TOOLS[name](case, [*samples(count), *case.bad])
    bad.run()
    if name != "call" and good.state() == bad.state():
        sys.exit(f"{name} does not notice the bad samples of `{case.ltlc}`: {good.state()}")


def nanoseconds(name: str, case: Case, count: int, passes: int) -> float:
    """Nanoseconds a step of a new monitor over `count` samples, again and again."""
    prepared = TOOLS[name](case, samples(count))
    prepared.run()
    start = process_time_ns()
    for _ in range(passes):
        prepared.run()
    return (process_time_ns() - start) / (count * passes)


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--peers", metavar="SITE-PACKAGES", help="a further folder to import peers from")
    parser.add_argument("--samples", type=int, default=1_000, help="default: %(default)s, which fit into a cache")
    parser.add_argument("--passes", type=int, default=20, help="over the samples in a round; default: %(default)s")
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()
    if options.peers:
        sys.path.append(options.peers)
    names = list(available())
    passes = {name: max(1, options.passes // SHARES.get(name, 1)) for name in names}
    for name in names:
        for case in CASES:
            check(name, case, size(name, case, options.samples))
    found: dict[tuple[str, str], list[float]] = {(case.name, name): [] for case in CASES for name in names}
    for _ in range(options.rounds):
        for case in CASES:
            for name in names:
                count = size(name, case, options.samples)
                found[case.name, name].append(nanoseconds(name, case, count, passes[name]))
    print(f"{platform.python_implementation()} {platform.python_version()}, {platform.machine()}\n")
    print(f"| ns a step, median | {' | '.join(names)} |")
    print(f"|---|{'---|' * len(names)}")
    for case in CASES:
        cells = [f"{statistics.median(found[case.name, name]):,.0f}" for name in names]
        print(f"| {case.name}: `{case.ltlc}` | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
