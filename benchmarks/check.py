"""Seconds that `ltlc check` takes, process and all: one property, the paper's examples, and large files.

    python -m benchmarks.check [--repeat N]

The goals on two cores: one property 0.3 s; the paper's examples, in one file, 1 s; 100 properties on 40 shared signals
10 s. On a busy machine look at the seconds of a CPU, which children share. One file has 200 properties and a budget of
5 s: it must end, and say what was not decided. The last is a fleet of ten robots with 20 properties each.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

EXAMPLES = Path(__file__).parent.parent / "tests" / "fixtures" / "check"
PAPER = ("stop_sign", "speeding", "more_of_the_readme", "rotation_by_history")
ONE = "stop: after_until robot.distance.sign < 1, robot.distance.sign > 1, eventually robot.velocity =={0.01} 0\n"
FORMS = (
    "never {a} and {b}",
    "always ({a} implies eventually {b})",
    "after {a}, {b} or {c}",
    "after_until {a}, {b}, eventually {c}",
    "until {a}, {b}",
    "eventually {a} and {b}",
    "always ({a} or {b} or {c})",
    "after_until {a}, {b}, {c}",
    "always (after {a}, eventually ({b} or {c}))",
    "after {a}, until {b}, {c}",
)

ROBOT = """
decl {n}_battery /{n}/battery sensor_msgs/BatteryState.percentage
decl {n}_bumper /{n}/bumper std_msgs/Bool.data
decl {n}_scan /{n}/scan sensor_msgs/LaserScan.ranges
decl {n}_command /{n}/cmd_vel geometry_msgs/Twist.linear.x
decl {n}_goal /{n}/goal std_msgs/Bool.data
decl {n}_arrived /{n}/arrived std_msgs/Bool.data
decl {n}_charging /{n}/charging std_msgs/Bool.data
decl {n}_load /{n}/load std_msgs/Float64.data
decl {n}_heat /{n}/temperature sensor_msgs/Temperature.temperature
{n}_speed: never {n}.velocity > 2
{n}_bump: always ({n}_bumper implies eventually {n}.velocity < 0.05)
{n}_halt: after_until estop, not estop, {n}_command =={{0.01}} 0
{n}_apart: never {n}.distance.{next} < 0.3
{n}_slow: always ({n}.distance.{next} < 1 implies eventually {n}.velocity < 0.5)
{n}_charge: after {n}_battery < 0.1, eventually {n}_charging
{n}_empty: never {n}_battery < 0.05
{n}_wall: always (min({n}_scan) < 0.4 implies eventually {n}_command <= 0)
{n}_plugged: after_until {n}_charging, not {n}_charging, {n}.velocity < 0.01
{n}_arrive: always ({n}_goal implies eventually {n}_arrived)
{n}_wait: until {n}_goal, never {n}.velocity > 0.1
{n}_hot: never {n}_heat > 80
{n}_cool: always ({n}_heat > 70 implies eventually {n}_heat < 60)
{n}_careful: after_until {n}_load > 5, {n}_load < 0.1, never {n}.velocity > 1
{n}_patrol: always eventually {n}_charging
{n}_manual: never mode == "manual" and {n}_goal
{n}_dock: after_until {n}.distance.dock < 1, {n}.distance.dock > 1, eventually {n}.velocity < 0.1
{n}_error: always (mode == "error" implies eventually estop)
{n}_band: never {n}_command > 2 or {n}_command < -1
{n}_enough: after_until {n}_goal, {n}_arrived, {n}_battery > 0.1
"""
"""The topics and the properties of one robot of a fleet, `n`, whose neighbour is `next`."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=3, help="the smallest time of so many is shown")
    repeat = parser.parse_args().repeat
    paper = "\n".join((EXAMPLES / f"{name}.txt").read_text(encoding="utf-8-sig") for name in PAPER)
    files = {
        "one property": (ONE, "30"),
        "the paper's examples": (paper, "30"),
        "100 properties, 40 signals": (random_file(100, 40, seed=0), "30"),
        "200 properties, 5 s": (random_file(200, 40, seed=1), "5"),
        "200 properties, 40 signals": (random_file(200, 40, seed=1), "60"),
        "a fleet, 200 properties": (fleet_file(10), "60"),
    }
    print(f"{'file':>28} {'properties':>10} {'seconds':>8} {'of a CPU':>10}  findings")
    for name, (text, budget) in files.items():
        report(name, text, budget, repeat)


def report(name: str, text: str, budget: str, repeat: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "props.txt"
        path.write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", "ltlc.cli", "check", "--format", "json", "--budget", budget, str(path)]
        times, processor = [], []
        for _ in range(repeat):
            start, before = perf_counter(), os.times()
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            after = os.times()
            times.append(perf_counter() - start)
            processor.append(sum(after[2:4]) - sum(before[2:4]))
    found = json.loads(done.stdout)
    counts: dict[str, int] = {}
    for diagnostic in found["diagnostics"]:
        counts[diagnostic["name"]] = counts.get(diagnostic["name"], 0) + 1
    summary = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
    print(f"{name:>28} {len(found['properties']):>10} {min(times):>8.2f} {min(processor):>10.2f}  {summary}")


def random_file(properties: int, signals: int, seed: int) -> str:
    """A specification with thresholds on shared signals."""
    chance = random.Random(seed)

    def atom() -> str:
        return f"s{chance.randrange(signals)} {chance.choice('<>')} {chance.randrange(1, 10)}"

    lines = [f"decl s{k} /topic{k} Float64.data" for k in range(signals)]
    lines += [f"p{k}: " + chance.choice(FORMS).format(a=atom(), b=atom(), c=atom()) for k in range(properties)]
    return "\n".join(lines) + "\n"


def fleet_file(robots: int) -> str:
    """A specification of `robots` with 20 properties each, which share a stop, a mode and their distances."""
    shared = "decl estop /estop std_msgs/Bool.data\ndecl mode /mode std_msgs/String.data\n"
    return shared + "".join(ROBOT.format(n=f"r{k}", next=f"r{(k + 1) % robots}") for k in range(robots))


if __name__ == "__main__":
    main()
