"""How late the emitted node tells that a topic is dead: milliseconds from a deadline to the line that says so.

    python -m benchmarks.lateness [--rounds 4]

In each round a node watches a topic that never speaks, with ten deadlines 37 ms apart; its file of verdicts is looked
at each millisecond, so that a figure contains waking, judging and writing, and up to a millisecond of looking.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.node_cpu import isolated

DEADLINES = [500 + 37 * k for k in range(10)]
"""Of a round, in ms."""


def main() -> None:
    """Print the median and the largest, and the load of the machine."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=4)
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as folder:
        node = build(Path(folder))
        late = [each for number in range(rounds) for each in lateness(node, Path(folder) / f"{number}.jsonl")]
    print(f"{len(late)} deadlines, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} CPUs")
    print(f"ms late: median {statistics.median(late):.1f}, largest {max(late):.1f} (goal: 20)")


def build(folder: Path) -> Path:
    """The emitted node."""
    specification, node = folder / "dead.txt", folder / "dead_monitor.py"
    lines = [f"within_{deadline}: always age(scan) <= {deadline} ms" for deadline in DEADLINES]
    specification.write_text("\n".join(["decl scan /scan sensor_msgs/LaserScan.ranges", *lines, ""]), encoding="utf-8")
    command = [sys.executable, "-m", "ltlc", "build", str(specification), "-o", str(node)]
    subprocess.run(command, check=True, capture_output=True)
    return node


def lateness(node: Path, verdicts: Path) -> list[float]:
    """The milliseconds for each deadline of a round."""
    command = [sys.executable, str(node), "--ros-args", "-p", f"jsonl:={verdicts}"]
    environment = os.environ | isolated(str(node.parent))
    running = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        return told(verdicts, running)
    finally:
        running.send_signal(signal.SIGINT)
        running.wait()


def told(verdicts: Path, running: subprocess.Popen[bytes]) -> list[float]:
    """How late each violation stood in the file."""
    while not verdicts.exists() and running.poll() is None:
        time.sleep(0.01)
    late: list[float] = []
    with verdicts.open(encoding="utf-8") as file:
        rest = ""
        while len(late) < len(DEADLINES) and running.poll() is None:
            rest += file.read()
            now = time.time_ns()
            *complete, rest = rest.split("\n")
            changes = [json.loads(line) for line in complete]
            late += [(now - each["time_ns"]) / 1e6 for each in changes if each.get("verdict") == "violated"]
            time.sleep(0.001)
    return late


if __name__ == "__main__":
    main()
