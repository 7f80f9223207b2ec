"""Figures of properties with bounds on time: verdicts beside those of reelay, rtamt and hpl-rv, builds, sizes.

    python -m benchmarks.timed [--peers SITE-PACKAGES] [--runs N] [agreement|sentences|bounds …]

`agreement`: a response within D on random runs, one sample after the other, where the fragments meet; the stream
languages get a past-time formula that is false while an answer is overdue. `sentences`: seconds of `ltlc build` for
each sentence of the reference, gate included. `bounds`: time and size of a monitor for bounds from 1 ms to 1 h. Without
a word, all of them. Nanoseconds a step are in `step.py`.

Peers are imported from the folder given with `--peers`; what is missing is said.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import statistics
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from subprocess import run
from time import perf_counter, process_time_ns
from types import SimpleNamespace
from typing import Any

from ltlc.automata import Budget
from ltlc.backends import python
from ltlc.backends.python import standalone_classes
from ltlc.base.source import Source
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load_text
from ltlc.semantics.encodings import EPISODE

DECLARATIONS = "decl distance /distance std_msgs/Float64.data\ndecl speed /speed std_msgs/Float64.data\n"
PERIOD = 10_000_000
"""Nanoseconds between samples."""

MOST_SAMPLES = 16
"""No run has more samples."""

Samples = Sequence[tuple[float, float]]
"""Distance and speed at successive samples."""

SENTENCES = Path(__file__).parent.parent / "tests" / "fixtures" / "check" / "time.txt"


def response(samples: int) -> str:
    """That the robot slows down within so many samples of being near."""
    milliseconds = samples * PERIOD // 1_000_000
    return f"always (distance < 1 implies eventually speed < 0.1 within {milliseconds} ms)"


def compiled(text: str) -> Compiled:
    """The one property of `text`, with its monitor."""
    specification, found = load_text(Source("props.txt", DECLARATIONS + text + "\n"))
    assert specification is not None, found
    [each], _ = compile_specification(specification, EPISODE, Budget(30.0, 1024))
    return each


@cache
def emitted(text: str) -> type:
    """The class of an emitted monitor; its session begins at what it is made with."""
    each = compiled(text)
    namespace: dict[str, Any] = {"__name__": "emitted"}
    exec(python.emit([each], SimpleNamespace(source=Source("props.txt", ""))), namespace)  # type: ignore[arg-type]
    [written] = standalone_classes([each], "props.txt")
    found: type = namespace[written.name]
    return found


Runner = Callable[[Samples, int], Iterator[bool]]
"""Whether nothing is overdue after each of some samples; the bound is in samples."""


def ltlc_runner(samples: Samples, bound: int) -> Iterator[bool]:
    """The emitted class; once violated it stays so, and the run begins anew."""
    monitor = emitted(response(bound))(0)
    for n, (distance, speed) in enumerate(samples):
        yield monitor.step(n * PERIOD, distance, speed).value != "violated"


def reelay_runner(samples: Samples, bound: int) -> Iterator[bool]:
    """An answer is overdue if up to the sample before there was none for `bound` samples from a trigger on."""
    import reelay

    pattern = f"not(pre({{speed >= 0.1}} since[{bound}:] ({{distance < 1.0}} and {{speed >= 0.1}})))"
    monitor = reelay.discrete_timed_monitor(pattern=pattern, semantics="boolean", condense=False)
    for distance, speed in samples:
        yield monitor.update({"distance": distance, "speed": speed})["value"]


def rtamt_runner(samples: Samples, bound: int) -> Iterator[bool]:
    """The same; rtamt wants an upper bound, and gives robustness."""
    monitor = _rtamt_monitor(bound)
    try:
        for n, (distance, speed) in enumerate(samples):
            yield monitor.update(n, [("distance", distance), ("speed", speed)]) > 0
    finally:
        monitor.reset()


@cache
def _rtamt_monitor(bound: int) -> Any:
    import rtamt

    monitor = rtamt.StlDiscreteTimeSpecification()
    for name in ("distance", "speed", "out"):
        monitor.declare_var(name, "float")
    since = f"(speed >= 0.1) since[{bound}:{MOST_SAMPLES}] ((distance < 1.0) and (speed >= 0.1))"
    monitor.spec = f"out = not(once[1:1]({since}))"
    monitor.parse()
    monitor.pastify()
    return monitor


def hpl_runner(samples: Samples, bound: int) -> Iterator[bool]:
    """The class that hpl-rv generates, told the time with each message."""
    monitor = _hpl_monitor(bound)()
    monitor.on_launch(0.0)
    for n, (distance, speed) in enumerate(samples):
        monitor.on_msg__state(SimpleNamespace(distance=distance, speed=speed), n * PERIOD / 1e9)
        yield monitor.verdict is not False


@cache
def _hpl_monitor(bound: int) -> type:
    from hpl.parser import property_parser
    from hplrv.gen import MonitorGenerator

    seconds = bound * PERIOD / 1e9
    text = f"globally: /state {{distance < 1.0}} causes /state {{speed < 0.1}} within {seconds} s"
    namespace: dict[str, Any] = {"__name__": "generated"}
    exec(MonitorGenerator(lang="py").monitor_library([property_parser().parse(text)]), namespace)
    made: type = next(value for name, value in namespace.items() if name.endswith("Monitor") and name != "Monitor")
    return made


RUNNERS: dict[str, Runner] = {
    "ltlc": ltlc_runner,
    "hpl-rv": hpl_runner,
    "reelay": reelay_runner,
    "rtamt": rtamt_runner,
}


def available() -> list[str]:
    """The tools that can be imported; the others are named on stderr."""
    found = []
    for name, runner in RUNNERS.items():
        try:
            list(runner([(2.0, 1.0)], 1))
        except ImportError as error:
            print(f"{name} is left out: {error}", file=sys.stderr)
        else:
            found.append(name)
    return found


def agreement(runs: int) -> None:
    """On how many random runs each tool says the same as the definition, or else as if the bound was exclusive."""
    names = available()
    agreeing: Counter[str] = Counter()
    exclusive: Counter[str] = Counter()
    examples: dict[str, str] = {}
    for seed in range(runs):
        chance = random.Random(seed)
        bound = chance.randrange(1, 6)
        samples = [(chance.choice([0.5, 2.0]), chance.choice([0.0, 1.0])) for _ in range(chance.randrange(1, 16))]
        wanted, at_bound = overdue_after(samples, bound), overdue_after(samples, bound - 1)
        for name in names:
            got = next((n for n, fine in enumerate(RUNNERS[name](samples, bound)) if not fine), None)
            agreeing[name] += got == wanted
            exclusive[name] += wanted != got == at_bound
            if got not in (wanted, at_bound):
                examples.setdefault(name, f"bound {bound}, samples {samples}: at {got} instead of {wanted}")
    print(f"| tool | of {runs:,} runs, the first violation at the same sample | as if the bound was exclusive |")
    print("|---|---|---|")
    for name in names:
        print(f"| {name} | {agreeing[name]:,} | {exclusive[name]:,} |")
    for name, example in examples.items():
        print(f"{name} differs: {example}")


def overdue_after(samples: Samples, bound: int) -> int | None:
    """The first sample by whose time some trigger has gone unanswered for longer than `bound` samples."""
    for n in range(len(samples)):
        for start in range(n - bound):
            if samples[start][0] < 1 and all(speed >= 0.1 for _, speed in samples[start : start + bound + 1]):
                return n
    return None


def sentences() -> None:
    """Seconds of `ltlc build`, gate and process included, by the clock and of CPU; medians of three."""
    print("| seconds | CPU | sentence |\n|---|---|---|")
    lines = SENTENCES.read_text(encoding="utf-8").splitlines()
    declared = [line for line in lines if line.startswith("decl")]
    for sentence in (line for line in lines if line and line not in declared):
        used = [line for line in declared if re.search(rf"\b{line.split()[1]}\b", sentence)]
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "props.txt").write_text("\n".join([*used, sentence, ""]), encoding="utf-8")
            seconds, spent = [], []
            for _ in range(3):
                start, before = perf_counter(), children_cpu()
                run([sys.executable, "-m", "ltlc", "build", "props.txt"], cwd=folder, check=True, capture_output=True)
                seconds.append(perf_counter() - start)
                spent.append(children_cpu() - before)
        print(f"| {statistics.median(seconds):.2f} | {statistics.median(spent):.2f} | `{sentence}` |", flush=True)


def children_cpu() -> float:
    """Seconds of CPU of the processes that have been waited for, with theirs."""
    spent = os.times()
    return spent.children_user + spent.children_system


def bounds() -> None:
    """Milliseconds to make the monitor of a response, and its size, for bounds from 1 ms to 1 h."""
    print("| bound | ms to make it | states | lines of Python |\n|---|---|---|---|")
    for bound in ("1 ms", "100 ms", "10 s", "1 min", "1 h"):
        text = f"always (distance < 1 implies eventually speed < 0.1 within {bound})"
        spent = []
        for _ in range(9):
            start = process_time_ns()
            each = compiled(text)
            spent.append(process_time_ns() - start)
        [written] = standalone_classes([each], "props.txt")
        size = len(written.text.splitlines())
        print(f"| {bound} | {statistics.median(spent) / 1e6:.1f} | {len(each.machine.states)} | {size} |")


def main() -> None:
    """Print tables in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--peers", metavar="SITE-PACKAGES", help="a further folder to import peers from")
    parser.add_argument("--runs", type=int, default=10_000, help="random runs; default: %(default)s")
    parser.add_argument("what", nargs="*", choices=["agreement", "sentences", "bounds", []])
    options = parser.parse_args()
    if options.peers:
        sys.path.append(options.peers)
    parts: dict[str, Callable[[], None]] = {
        "agreement": lambda: agreement(options.runs),
        "sentences": sentences,
        "bounds": bounds,
    }
    for name in options.what or parts:
        print(f"\n{name}\n")
        parts[name]()


if __name__ == "__main__":
    main()
