"""How soon a lock holds a robot: milliseconds from the message that violates a property to that on ~/violated/LABEL.

    python -m benchmarks.lock [--rounds 10]

In each round the robot of the tests (MuJoCo) drives into a box; `never bumper` is violated, and its driver, which would
go on, is held by what the node publishes. A figure contains the way there, judging, and the way back.
"""

from __future__ import annotations

import argparse
import os
import re
import signal
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.node_cpu import isolated

ROBOT = Path(__file__).parent.parent / "tests" / "bumper_robot.py"

PROPERTIES = """
decl bumper /bumper std_msgs/Bool.data
decl speed /speed std_msgs/Float64.data
decl commanded /commanded std_msgs/Float64.data
decl scan /scan sensor_msgs/LaserScan.ranges
never commanded < 0 or speed < 0
min(scan) >= 0
untouched: never bumper
"""


def main() -> None:
    """Print the median and the largest, and the load of the machine."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=10)
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as folder:
        node = build(Path(folder))
        held = [delay(node) for _ in range(rounds)]
    print(f"{len(held)} drives, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} CPUs")
    print(f"ms until held: median {statistics.median(held):.1f}, largest {max(held):.1f} (goal: 50)")


def build(folder: Path) -> Path:
    """The emitted node."""
    specification, node = folder / "watch.txt", folder / "watch_monitor.py"
    specification.write_text(PROPERTIES, encoding="utf-8")
    command = [sys.executable, "-m", "ltlc", "build", str(specification), "-o", str(node)]
    subprocess.run(command, check=True, capture_output=True)
    return node


def delay(node: Path) -> float:
    """The milliseconds of one drive."""
    environment = os.environ | isolated(str(node.parent))
    command = [sys.executable, str(node)]
    monitor = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    options = ["--seconds", "60", "--lock", "/watch_monitor/violated/untouched"]
    drive = [sys.executable, str(ROBOT), *options]
    robot = subprocess.Popen(drive, env=environment, stdout=subprocess.PIPE, text=True)
    try:
        assert robot.stdout is not None
        told = next(match for line in robot.stdout if (match := re.match(r"held ([0-9.]+) ms", line)))
        return float(told[1])
    finally:
        robot.kill()
        robot.wait()
        monitor.send_signal(signal.SIGINT)
        monitor.wait()


if __name__ == "__main__":
    main()
