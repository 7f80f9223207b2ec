"""Drives the simulated robot past the stop sign and publishes on ROS 2 what a simulator's bridge would.

    python robot.py --drive runs                     # does not stop; 7 s
    python robot.py --drive stops --record run.csv   # stops, and keeps what it published

On /model/robot/odometry and /model/stop_sign/odometry is the ground truth, as Gazebo's OdometryPublisher gives it
through ros_gz_bridge; on /odom where the robot believes to be, and on /cmd_vel what its wheels are told.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from simulation import DRIVES, Observation, simulate

TRUTH = "/model/robot/odometry"

COLUMNS = [
    "time",
    "commanded_speed",
    *(f"robot.model.position.{axis}" for axis in "xyz"),
    *(f"stop_sign.position.{axis}" for axis in "xyz"),
    *(f"robot.position.{axis}" for axis in "xyz"),
    *(f"robot.velocity.{axis}" for axis in "xyz"),
]
"""Of a recording; the signals are called as in properties.txt."""

Sink = Callable[[Observation], None]
"""Takes an observation somewhere: to ROS 2, to a file."""


def main() -> int:
    """Drive once; the exit code is 0, or 2 if nobody listens."""
    options = arguments().parse_args()
    try:
        with ExitStack() as stack:
            drive(options, sinks(options, stack))
    except TimeoutError as error:
        print(f"robot: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def arguments() -> argparse.ArgumentParser:
    """What can be asked for on the command line."""
    parser = argparse.ArgumentParser(description="Drive a simulated robot past a stop sign.")
    add = parser.add_argument
    add("--drive", choices=DRIVES, default="runs", help="what it does at the sign (default: runs)")
    add("--speed", type=positive, default=1.0, metavar="M/S", help="how fast it drives (default: 1)")
    add("--drift", type=float, default=0.0, metavar="D", help="it takes its wheels for D times too large (default: 0)")
    add("--record", type=Path, metavar="FILE.csv", help="write what is published to a file as well")
    add("--real-time-factor", type=positive, default=1.0, metavar="N", help="go N times as fast as the clock")
    add("--clock", action="store_true", help="publish the simulated time too, for use_sim_time")
    add("--wait-for", nargs="+", default=[TRUTH], metavar="TOPIC", help="start once these topics have a subscriber")
    add("--patience", type=positive, default=30.0, metavar="S", help="how long to wait for them (default: 30 s)")
    add("--no-ros", dest="ros", action="store_false", help="publish nothing, only record")
    return parser


def positive(text: str) -> float:
    """A number above 0."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a number above 0")
    return value


def sinks(options: argparse.Namespace, stack: ExitStack) -> list[Sink]:
    """Where the observations shall go; what has to be closed at the end goes on `stack`."""
    wanted: list[Sink] = []
    if options.record is not None:
        wanted.append(stack.enter_context(recording(options.record)))
    if options.ros:
        from bridge import Bridge

        bridge = stack.enter_context(Bridge(options.clock))
        bridge.wait_for_subscribers(options.wait_for, options.patience)
        wanted.append(bridge.publish)
    return wanted


def drive(options: argparse.Namespace, sinks: list[Sink]) -> None:
    """Simulate, at the wanted pace if somebody listens, and give each observation to all `sinks`."""
    start = time.monotonic()
    for observation in simulate(options.drive, speed=options.speed, drift=options.drift):
        if options.ros:
            due = start + observation.time / options.real_time_factor
            time.sleep(max(0.0, due - time.monotonic()))
        for sink in sinks:
            sink(observation)
    print(f"robot: arrived after {observation.time:.2f} s")


@contextmanager
def recording(path: Path) -> Iterator[Sink]:
    """A CSV file with a row for each message that a `Bridge` publishes, in the same order."""
    unfinished = path.with_name(f".{path.name}.part")
    with unfinished.open("w", newline="", encoding="utf-8") as file:
        rows = csv.DictWriter(file, COLUMNS)
        rows.writeheader()

        def write(observation: Observation) -> None:
            robot = observation.robot
            messages = (
                {"commanded_speed": observation.command.forward},
                vector("robot.model.position", observation.believed.position),
                vector("stop_sign.position", observation.stop_sign.position),
                vector("robot.position", robot.position) | vector("robot.velocity", robot.linear),
            )
            rows.writerows({"time": observation.time, **samples} for samples in messages)

        yield write
    unfinished.replace(path)


def vector(name: str, values: tuple[float, float, float]) -> dict[str, float]:
    """The columns of a vector."""
    return {f"{name}.{axis}": value for axis, value in zip("xyz", values, strict=True)}


if __name__ == "__main__":
    sys.exit(main())
