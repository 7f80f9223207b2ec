"""How much later a command is for a guard: the emitted node beside a plain relay of rclpy, in one run.

    python -m benchmarks.node_guard [--commands 2000] [--rate 50]

One process sends Twists on two topics in turn, each after the one before has come back or was given up. On one, a relay
takes them and publishes them again, as objects of Python, with rclpy's own executor and the same quality of service; on
the other, it is the guard of `docs/guard.md`, slow near people, which has a scan ten times a second. The latency is
from before the publication to the callback with the serialised message that has come back, the way through DDS twice
included.
"""

from __future__ import annotations

import argparse
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.node_cpu import isolated
from benchmarks.node_load import build

GUARDED = """guard /guard_raw to /guard else stop
message stop {linear.x: 0, angular.z: 0}
decl speed /guard geometry_msgs/Twist.linear.x
decl scan /scan sensor_msgs/LaserScan.ranges
near: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)
slow: always (new speed and min(scan) < 0.5 implies speed <= 0.2)
"""
WAYS = ("relay", "guard")
PATIENCE = 0.5
"""A command that has not come back after so many seconds is given up."""


def main() -> None:
    """Print a line for each way, and one that compares them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--commands", type=int, default=2000)
    parser.add_argument("--rate", type=float, default=50.0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        node = build(Path(folder), GUARDED)
        os.environ.update(isolated(folder))
        commands = [[sys.executable, "-m", "benchmarks.node_guard", "--relay"], [sys.executable, str(node)]]
        processes = [subprocess.Popen(command, stderr=subprocess.DEVNULL) for command in commands]
        try:
            found = measure(options.commands, options.rate)
        finally:
            for process in processes:
                process.send_signal(signal.SIGINT)
                process.wait()
    for way in WAYS:
        print(f"{way}: {told(found[way])}")
    ratios = (percentile(found["guard"], q) / percentile(found["relay"], q) for q in (0.5, 0.99))
    print("guard / relay: p50 {:.2f}, p99 {:.2f}".format(*ratios))
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} CPUs")


def told(late: Sequence[float]) -> str:
    """A measurement in a line."""
    shown = " ".join(f"p{100 * q:g} {percentile(late, q):.2f} ms," for q in (0.5, 0.95, 0.99))
    return f"{shown} worst {max(late):.2f} ms of {len(late)} commands"


def percentile(late: Sequence[float], share: float) -> float:
    """What so large a share of `late` does not exceed."""
    return statistics.median(late) if share == 0.5 else sorted(late)[int(share * (len(late) - 1))]


def measure(count: int, rate: float) -> dict[str, list[float]]:
    """The latencies of `count` commands on each way, in ms."""
    import rclpy
    from geometry_msgs.msg import Twist
    from rclpy.serialization import serialize_message
    from rclpy.signals import SignalHandlerOptions
    from sensor_msgs.msg import LaserScan

    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("latency")
    back: dict[bytes, float] = {}
    for way in WAYS:
        node.create_subscription(
            Twist, f"/{way}", lambda data: back.setdefault(bytes(data), time.perf_counter()), 1, raw=True
        )
    publishers = {way: node.create_publisher(Twist, f"/{way}_raw", 1) for way in WAYS}
    scans = node.create_publisher(LaserScan, "/scan", 10)
    node.create_timer(0.1, lambda: scans.publish(LaserScan(ranges=[2.0] * 360)))
    numbers = iter(range(1, 10**9))

    def send(way: str) -> float | None:
        """The latency of a command, in ms; None if it does not come back."""
        message = Twist()
        message.linear.y = float(next(numbers))
        data = bytes(serialize_message(message))
        sent = time.perf_counter()
        publishers[way].publish(message)
        wait(lambda: data in back or time.perf_counter() > sent + PATIENCE)
        return 1000 * (back[data] - sent) if data in back else None

    def wait(happens: Callable[[], Any]) -> None:
        while not happens():
            rclpy.spin_once(node, timeout_sec=0.01)

    found: dict[str, list[float]] = {way: [] for way in WAYS}
    deadline = time.monotonic() + 60
    for way in WAYS:
        while send(way) is None:
            assert time.monotonic() < deadline, f"nothing comes back on the way of the {way}"
    for _ in range(count):
        for way in WAYS:
            until = time.perf_counter() + 0.5 / rate
            late = send(way)
            if late is not None:
                found[way].append(late)
            wait(lambda until=until: time.perf_counter() >= until)  # type: ignore[misc]
    rclpy.shutdown()
    return found


def relay() -> None:
    """Take commands, and publish them again."""
    import rclpy
    from geometry_msgs.msg import Twist

    rclpy.init()
    node = rclpy.create_node("relay")
    publisher = node.create_publisher(Twist, "/relay", 1)
    node.create_subscription(Twist, "/relay_raw", publisher.publish, 1)
    rclpy.spin(node)


if __name__ == "__main__":
    if "--relay" in sys.argv:
        relay()
    else:
        main()
