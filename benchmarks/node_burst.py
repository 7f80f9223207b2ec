"""Emitted nodes that are flooded: does each end when it is asked to, with its verdicts, and do its figures add up?

    python -m benchmarks.node_burst [--nodes 30] [--messages 12000] [--beside 3]

Each node has one reliable publisher, which sends all its messages at once, far more than the node's queue holds. When
the middleware has settled, the node gets SIGINT or SIGTERM in turn. A line for each node: its exit code, how long it
took to end, and of the messages that were sent, how many it judged and how many it reports as lost.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.node_cpu import isolated

PROPERTY = "decl x /x std_msgs/Float64.data\nlow: never x > 5\n"
PATIENCE = 60.0
"""So long, in s, to wait for a node to listen, for the middleware to settle, and for a node to end."""


@dataclass(frozen=True)
class Outcome:
    """How a node ended: its exit code, None where it hung; what it says it judged and lost.

    It has lost at least that where it `doubts` whether that is all.
    """

    number: int
    code: int | None
    took: float
    sent: int
    judged: int
    lost: int
    doubts: bool

    @property
    def kind(self) -> str:
        """What is to be said of it in a word."""
        if self.code is None:
            return "hung"
        missing = self.sent - self.judged - self.lost
        if self.doubts and missing >= 0:
            return "ended, says that more may have been lost"
        return "ended, does not add up" if missing else "ended, adds up"


def main() -> None:
    """Print a line for each node, and how many ended how."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=30)
    parser.add_argument("--messages", type=int, default=12_000)
    parser.add_argument("--beside", type=int, default=3, help="so many nodes side by side")
    options = parser.parse_args()
    kinds: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        node = build(Path(folder))
        os.environ.update(isolated(folder))
        for first in range(0, options.nodes, options.beside):
            numbers = range(first, min(first + options.beside, options.nodes))
            for outcome in flooded(node, numbers, options.messages):
                kinds[outcome.kind] += 1
                print(told(outcome), flush=True)
    print(", ".join(f"{count} {kind}" for kind, count in kinds.items()))
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} CPUs")


def told(outcome: Outcome) -> str:
    """An outcome in a line."""
    lost = f"at least {outcome.lost}" if outcome.doubts else outcome.lost
    return (
        f"node {outcome.number:2}: {outcome.kind}; exit code {outcome.code} after {outcome.took:.2f} s; "
        f"{outcome.sent} sent, {outcome.judged} judged, {lost} lost"
    )


def build(folder: Path) -> Path:
    """The emitted node."""
    specification, node = folder / "burst.txt", folder / "burst_monitor.py"
    specification.write_text(PROPERTY, encoding="utf-8")
    command = [sys.executable, "-m", "ltlc", "build", str(specification), "-o", str(node)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return node


def flooded(node: Path, numbers: range, messages: int) -> list[Outcome]:
    """Start nodes side by side, send each its messages at once, and end them."""
    import rclpy
    from rclpy.duration import Duration
    from rclpy.signals import SignalHandlerOptions
    from std_msgs.msg import Float64

    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    sender = rclpy.create_node("sender")
    publishers = {number: sender.create_publisher(Float64, f"/x{number}", 1000) for number in numbers}
    running = {number: started(node, number) for number in numbers}
    try:
        for number, publisher in publishers.items():
            wait_for_reader(publisher, node.with_name(f"{number}.log"))
        for publisher in publishers.values():
            for _ in range(messages):
                publisher.publish(Float64(data=1.0))
        for publisher in publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=PATIENCE))
        return [ended(node, number, process, messages) for number, process in running.items()]
    finally:
        for process in running.values():
            process.kill()
            process.wait()
        rclpy.shutdown()


def started(node: Path, number: int) -> subprocess.Popen[bytes]:
    """The node with this number, which has a topic of its own."""
    report(node, number).unlink(missing_ok=True)
    names = ["-r", f"__node:=burst{number}", "-r", f"/x:=/x{number}"]
    command = [sys.executable, str(node), "--ros-args", *names, "-p", f"jsonl:={report(node, number)}"]
    with node.with_name(f"{number}.log").open("wb") as log:
        return subprocess.Popen(command, stdout=log, stderr=log)


def report(node: Path, number: int) -> Path:
    """Where the node with this number writes its verdicts."""
    return node.with_name(f"{number}.jsonl")


def wait_for_reader(publisher: Any, log: Path) -> None:
    """Wait until a node listens."""
    deadline = time.monotonic() + PATIENCE
    while not publisher.get_subscription_count():
        if time.monotonic() > deadline:
            raise TimeoutError(f"the node does not listen: {log.read_text(encoding='utf-8')}")
        time.sleep(0.02)


def ended(node: Path, number: int, process: subprocess.Popen[bytes], sent: int) -> Outcome:
    """Ask a node to end; what it reports."""
    begun = time.monotonic()
    process.send_signal(signal.SIGTERM if number % 2 else signal.SIGINT)
    try:
        code: int | None = process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        code = None
    took = time.monotonic() - begun
    lines = [json.loads(line) for line in report(node, number).read_text(encoding="utf-8").splitlines()]
    nothing: dict[str, Any] = {"steps": 0}
    final = next((line["properties"][0] for line in lines if line.get("final")), nothing)
    lost = final.get("lost_at_least", {"/x": 0})["/x"]
    doubts = final.get("lost_messages", {"/x": 0})["/x"] is None
    return Outcome(number, code, took, sent, final["steps"], lost, doubts)


if __name__ == "__main__":
    main()
