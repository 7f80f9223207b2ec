"""All in one go: check a property, build a node from it, and let it watch a robot that does not stop.

    python examples/stop_sign/demo.py [--drive stops]

The node is left in build/stop_sign_monitor.py. The exit code is 0 if the node judged the drive as it should have.
"""

from __future__ import annotations

import argparse
import os
import random
import shlex
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
NODE = Path("build") / "stop_sign_monitor.py"
PATIENCE = 120.0

PROPERTIES = {"runs": "stop_sign.txt", "stops": "properties.txt", "stops-then-runs": "properties.txt"}
"""The properties that a drive is judged by: the sentence of the paper alone, or with others."""


def main() -> int:
    """Run the demo; 0 if the node reported what it should."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drive", choices=PROPERTIES, default="runs", help="what the robot does (default: runs)")
    parser.add_argument("--real-time-factor", default="1", metavar="N", help="simulate N times as fast")
    options = parser.parse_args()
    drive = options.drive
    properties = str(HERE / PROPERTIES[drive])
    NODE.parent.mkdir(exist_ok=True)
    for command in (["check", properties], ["build", properties, "-o", str(NODE)]):
        if show([sys.executable, "-m", "ltlc.cli", *command], as_typed=["ltlc", *command]):
            return 1
    with tempfile.TemporaryDirectory() as folder:
        return outcome(drive, watched_drive(drive, options.real_time_factor, isolated(folder)))


def show(command: list[str], as_typed: list[str]) -> int:
    """Run a command, and show how a person would type it; its exit code."""
    announce(as_typed)
    return subprocess.run(command, check=False).returncode


def announce(as_typed: list[str]) -> None:
    """Print a command line."""
    print(f"\n$ {shlex.join(as_typed)}", flush=True)


def isolated(folder: str) -> dict[str, str]:
    """An environment in which the two processes hear each other, and no other robot on the network."""
    domain = os.environ.get("ROS_DOMAIN_ID") or str(random.randint(1, 99))
    return {
        **os.environ,
        "ROS_DOMAIN_ID": domain,
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_LOG_DIR": folder,
    }


def watched_drive(drive: str, factor: str, environment: dict[str, str]) -> int:
    """Let the robot drive while the node watches; the node's exit code."""
    robot_options = ["--drive", drive, "--real-time-factor", factor]
    commands = [["python", str(NODE)], ["python", str(HERE / "robot.py"), *robot_options]]
    processes = []
    for command in commands:
        announce(command)
        processes.append(subprocess.Popen([sys.executable, *command[1:]], env=environment))
    node, robot = processes
    try:
        robot.wait(PATIENCE)
        node.send_signal(signal.SIGINT)
        return node.wait(PATIENCE)
    finally:
        for process in processes:
            process.kill()
            process.wait()


def outcome(drive: str, code: int) -> int:
    """Print the outcome; 0 if the node reported what it should."""
    found = {0: "all well", 1: "a violation"}.get(code, "something else")
    expected = 0 if drive == "stops" else 1
    verdict = "as expected" if code == expected else "which is WRONG"
    print(f"\nThe robot {drive.replace('-', ' ')}; the node found {found} (exit code {code}), {verdict}.")
    return 0 if code == expected else 1


if __name__ == "__main__":
    sys.exit(main())
