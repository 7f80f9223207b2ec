"""What the emitted node costs beside an empty rclpy callback: CPU time for a message of Odometry at 1 kHz.

    python -m benchmarks.node_cpu [--rounds 5] [--messages 10000]

In each round one publisher sends to both at once: the emitted node for the stop-sign property, and a process whose
callback does nothing, with the same executor and the same loop. CPU time is that of the whole process, from the kernel.
"""

from __future__ import annotations

import argparse
import os
import platform
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROPERTY = """
after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually robot.velocity == 0
object stop_sign at (4, 0.6, 0)
"""
TOPIC = "/model/robot/odometry"
RATE = 1000.0
WARM_UP = 1000


def main() -> None:
    options = arguments()
    with tempfile.TemporaryDirectory() as folder:
        node = build(Path(folder))
        environment = isolated(folder)
        os.environ.update(environment)
        rounds = [measure(node, options.messages) for _ in range(options.rounds)]
    for empty, monitor in rounds:
        print(f"empty callback {empty:6.1f} µs a message, node {monitor:6.1f} µs, {monitor / empty:.2f} times as much")
    empty, monitor = (statistics.median(column) for column in zip(*rounds, strict=True))
    ratio = statistics.median(monitor / empty for empty, monitor in rounds)
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} CPUs; Python {platform.python_version()}")
    print(f"median: empty callback {empty:.1f} µs, node {monitor:.1f} µs, {ratio:.2f} times as much (goal: 1.1)")


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--messages", type=int, default=10_000)
    return parser.parse_args()


def build(folder: Path) -> Path:
    """The emitted node."""
    specification, node = folder / "stop_sign.txt", folder / "stop_sign_monitor.py"
    specification.write_text(PROPERTY)
    command = [sys.executable, "-m", "ltlc.cli", "build", str(specification), "-o", str(node)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return node


def isolated(folder: str) -> dict[str, str]:
    """Environment variables that keep this machine's other ROS programs out."""
    domain = str(1 + os.getpid() % 100)
    return {"ROS_DOMAIN_ID": domain, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_LOG_DIR": folder}


def measure(node: Path, messages: int) -> tuple[float, float]:
    """Microseconds a message of the empty callback and of the node, on the same stream."""
    commands = [[sys.executable, __file__, "empty"], [sys.executable, str(node)]]
    processes = [subprocess.Popen(command, stderr=subprocess.DEVNULL) for command in commands]
    try:
        return publish(messages, [process.pid for process in processes])
    finally:
        for process in processes:
            process.send_signal(signal.SIGINT)
            process.wait()


def publish(messages: int, pids: list[int]) -> tuple[float, float]:
    """Send messages at `RATE` to two subscribers; what each of the processes `pids` used of the CPU for one."""
    import rclpy
    from nav_msgs.msg import Odometry
    from rclpy.signals import SignalHandlerOptions

    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    publisher = rclpy.create_node("publisher").create_publisher(Odometry, TOPIC, 1000)
    while publisher.get_subscription_count() < len(pids):
        time.sleep(0.02)
    message = Odometry()
    message.twist.twist.linear.x = 1.0
    before: list[float] = []
    due = time.monotonic()
    for count in range(WARM_UP + messages):
        if count == WARM_UP:
            before = [cpu_seconds(pid) for pid in pids]
        message.pose.pose.position.x = count % 8000 / 1000
        publisher.publish(message)
        due += 1 / RATE
        time.sleep(max(0.0, due - time.monotonic()))
    after = [cpu_seconds(pid) for pid in pids]
    rclpy.shutdown()
    empty, monitor = ((end - start) / messages * 1e6 for start, end in zip(before, after, strict=True))
    return empty, monitor


def cpu_seconds(pid: int) -> float:
    """The CPU time that all threads of a process and its children have used; a node is the child of its guard."""
    threads = [thread for each in (pid, *children(pid)) for thread in Path(f"/proc/{each}/task").iterdir()]
    return sum(int((thread / "schedstat").read_text().split()[0]) for thread in threads) / 1e9


def children(pid: int) -> list[int]:
    """The children of a process."""
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def empty() -> None:
    """A node whose callback does nothing."""
    import rclpy
    from nav_msgs.msg import Odometry
    from rclpy.experimental import EventsExecutor
    from rclpy.signals import SignalHandlerOptions

    stop: list[int] = []
    signal.signal(signal.SIGINT, lambda number, _: stop.append(number))
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("empty")
    node.create_subscription(Odometry, TOPIC, lambda message: None, 1000)
    executor = EventsExecutor()
    executor.add_node(node)
    while not stop:
        executor.spin_once(timeout_sec=0.1)


if __name__ == "__main__":
    if sys.argv[1:] == ["empty"]:
        empty()
    else:
        main()
