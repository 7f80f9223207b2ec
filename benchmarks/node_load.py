"""The emitted node with 20 properties on 12 topics, then 1,000 on 100, then `each` of 1,000 robots on one topic.

    python -m benchmarks.node_load [--seconds 10] [--rates 100 300 1000] [--burst 2000] [--fleet 2000]

CPU, memory, how soon it tells, what is lost.

At each rate (messages a second on every topic; 1,000 Hz on twelve is 12,000 messages a second) one process publishes
Odometry on four topics, Twist on four and Float64 on four, and listens to ~/verdicts. Every 50 ms a message on another
topic makes one property owe something, or settles it: how soon that is told is the latency, from publication to the
verdict's callback, the way through DDS twice included; a first message on each topic comes before. Then one topic
alone at `--burst` Hz, to see what is lost. Then 1,000 limits on 100 topics of Float64, ten on each, which get
`--fleet` messages a second together. Last, a response on one topic at that rate, of all robots together and of each of
1,000, who are owed something in every other of their messages.
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
import threading
import time
from pathlib import Path
from typing import Any

from benchmarks.node_cpu import children, cpu_seconds, isolated

KINDS = {
    "odom": "nav_msgs/Odometry.twist.twist.linear.x",
    "cmd": "geometry_msgs/Twist.linear.x",
    "level": "std_msgs/Float64.data",
}
TOPICS = [f"{name}{number}" for name in KINDS for number in range(4)]
FLEET = [f"level{number}" for number in range(100)]
PROBE = ["decl probe /probe std_msgs/Float64.data", "probe: always (probe > 0 implies eventually probe < 0)"]
ROBOTS = 1000
PROBE_EVERY = 0.05
PATIENCE = 60.0
QUIET = 1.0
"""So long after the last of the first verdicts, of which there may be a thousand, messages are sent at a rate, in s."""
DISCOVERY = 3.5
"""So long after it has subscribed a node begins at the latest, in s; before, it only keeps messages."""


def properties() -> str:
    """Twenty properties: limits, responses in time, scopes, history and ages, and the one that tells the latency."""
    limits = [f"never {topic} > 5" for topic in TOPICS]
    others = [
        "always (odom0 > 4 implies eventually cmd0 == 0 within 200 ms)",
        "always (odom1 > 4 implies eventually cmd1 == 0 within 200 ms)",
        "after_until level0 > 4, level0 < 1, eventually cmd2 == 0",
        "after_until level1 > 4, level1 < 1, always odom2 < 4.5",
        "never odom3 - @{odom3, -1} > 3",
        "never cmd3 - @{cmd3, -1} > 3",
        "after new level2, always age(level2) <= 5 s",
    ]
    assert len(limits) + len(others) + 1 == 20
    return "\n".join(["_margin_ = 0.01", *declared(TOPICS), *limits, *others, *PROBE])


def fleet() -> str:
    """A thousand limits, those of one topic one after the other only after each topic has had one; and the probe."""
    limits = [f"never {topic} > {5 + number}" for number in range(10) for topic in FLEET]
    return "\n".join([*declared(FLEET), *limits, *PROBE])


def robots(head: str) -> str:
    """A response on one topic of many robots, which `head` begins; and the probe."""
    robot = "decl robot /odom0 nav_msgs/Odometry.child_frame_id"
    response = f"{head}always (odom0 > 4 implies eventually odom0 < 1 within 60 s)"
    return "\n".join([robot, *declared(["odom0"]), response, *PROBE])


def declared(topics: list[str]) -> list[str]:
    """The declarations of topics."""
    return [f"decl {topic} /{topic} {KINDS[kind(topic)]}" for topic in topics]


def kind(topic: str) -> str:
    """What a topic is of, in `KINDS`."""
    return topic.rstrip("0123456789")


def main() -> None:
    """Print a line for each rate, and one for the burst."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--rates", type=float, nargs="+", default=[100.0, 300.0, 1000.0])
    parser.add_argument("--burst", type=float, default=2000.0)
    parser.add_argument("--fleet", type=float, default=2000.0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        node = build(Path(folder), properties())
        environment = isolated(folder)
        os.environ.update(environment)
        for rate in options.rates:
            print(
                f"{rate:5.0f} Hz on {len(TOPICS)} topics: {told(measure(node, TOPICS, rate, options.seconds))}",
                flush=True,
            )
        found = measure(node, ["odom0"], options.burst, options.seconds)
        print(f"{options.burst:5.0f} Hz on one topic: {told(found)}")
        found = measure(build(Path(folder), fleet()), FLEET, options.fleet / len(FLEET), options.seconds)
        print(f"{options.fleet:5.0f} messages/s on {len(FLEET)} topics, 1,001 properties: {told(found)}")
        for head in ("", "each r of robot: "):
            found = measure(build(Path(folder), robots(head)), ["odom0"], options.fleet, options.seconds, ROBOTS)
            print(f"{options.fleet:5.0f} Hz on one topic of {ROBOTS:,} robots, `{head}always …`: {told(found)}")
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} CPUs")


def told(found: dict[str, Any]) -> str:
    """A measurement in a line."""
    late = sorted(found["late"])
    p99 = late[min(len(late) - 1, int(0.99 * len(late)))]
    return (
        f"{found['rate']:.0f} messages/s sent, CPU {100 * found['cpu']:.0f} % of a core, {found['memory']:.0f} MB; "
        f"told after p50 {statistics.median(late):.1f} ms, p99 {p99:.1f} ms ({len(late)}); "
        f"{found['sent']} sent, {found['heard']} judged, {found['lost']} counted as lost"
    )


def build(folder: Path, text: str) -> Path:
    """The emitted node of a specification."""
    specification, node = folder / "load.txt", folder / "load_monitor.py"
    specification.write_text(f"{text}\n", encoding="utf-8")
    command = [sys.executable, "-m", "ltlc", "build", "--budget", "60,2048", str(specification), "-o", str(node)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return node


def measure(node: Path, topics: list[str], rate: float, seconds: float, robots: int = 0) -> dict[str, Any]:
    """What becomes of `rate` messages a second on each of `topics`, which the first properties read, one each.

    They are from `robots`, if there are any, one after the other.
    """
    final = node.with_name("final.jsonl")
    final.unlink(missing_ok=True)
    command = [sys.executable, str(node), "--ros-args", "-p", f"jsonl:={final}"]
    monitor = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        found = publish(monitor.pid, topics, rate, seconds, robots)
    finally:
        monitor.send_signal(signal.SIGINT)
        monitor.wait()
    report = json.loads(final.read_text(encoding="utf-8").splitlines()[-1])
    lost: dict[str, int | None] = {}
    for each in report["properties"]:
        lost |= each.get("lost_messages", {})
    found["lost"] = "an unknown number" if None in lost.values() else sum(filter(None, lost.values()))
    found["heard"] = sum(each["steps"] for each in report["properties"][: len(topics)])
    return found


def resident(pid: int) -> float:
    """The memory of a process, in MB; what it shares with others counts by its share."""
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii").splitlines()
    return int(next(line.split()[1] for line in lines if line.startswith("Pss:"))) / 1024


def publish(pid: int, topics: list[str], rate: float, seconds: float, robots: int) -> dict[str, Any]:
    """Send the messages, and listen."""
    import rclpy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from rclpy.signals import SignalHandlerOptions
    from std_msgs.msg import Float64, String

    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("load")
    classes = {"odom": Odometry, "cmd": Twist, "level": Float64}
    publishers = {topic: node.create_publisher(classes[kind(topic)], f"/{topic}", 1000) for topic in topics}
    probe = node.create_publisher(Float64, "/probe", 1000)
    sent: list[int] = []
    late: list[float] = []
    last_heard = 0.0

    def hear(message: Any) -> None:
        nonlocal last_heard
        last_heard = time.monotonic()
        if '"label": "probe"' in message.data and len(late) < len(sent):
            late.append((time.time_ns() - sent[len(late)]) / 1e6)

    profile = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(String, "/load_monitor/verdicts", hear, profile)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    deadline = time.monotonic() + PATIENCE
    while not (probe.get_subscription_count() and node.count_publishers("/load_monitor/verdicts")):
        if time.monotonic() > deadline:
            raise TimeoutError("the node does not listen")
        time.sleep(0.02)
    time.sleep(DISCOVERY)
    messages = {topic: classes[kind(topic)]() for topic in topics}
    last_heard = time.monotonic()
    for topic, message in messages.items():
        publishers[topic].publish(message)
    while time.monotonic() < last_heard + QUIET:
        time.sleep(0.02)
    used, start, count = cpu_seconds(pid), time.monotonic(), 0
    next_probe = start
    while (now := time.monotonic()) < start + seconds:
        while count < (now - start) * rate:
            count += 1
            for topic, message in messages.items():
                if robots:
                    message.child_frame_id = f"robot{count % robots}"
                    message.twist.twist.linear.x = 5.0 * (count // robots % 2)
                publishers[topic].publish(message)
        if now >= next_probe:
            next_probe += PROBE_EVERY
            sent.append(time.time_ns())
            probe.publish(Float64(data=1.0 if len(sent) % 2 else -1.0))
        time.sleep(0.0005)
    took = time.monotonic() - start
    memory = resident(pid) + sum(map(resident, children(pid)))
    time.sleep(1.0)
    cpu = (cpu_seconds(pid) - used) / took
    rclpy.shutdown()
    total = (count + 1) * len(topics)
    return {"cpu": cpu, "memory": memory, "late": late, "sent": total, "rate": count * len(topics) / took}


if __name__ == "__main__":
    main()
