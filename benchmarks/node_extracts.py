"""Whether extracts of a node have every message at 2,000 a second: python -m benchmarks.node_extracts [ROUNDS]

Odometry comes at 2 kHz for 8 s; in the middle two properties are violated at once. Of each extract, what was sent in
its window, by the numbers in the messages, and what of that is there.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from mcap.reader import make_reader
from ros_support import Network, Node, emitted, own_domain

RATE, SECONDS = 2000, 8
PROPERTIES = """
decl x /odom nav_msgs/Odometry.twist.twist.linear.x
low: never x > 5
also: never x > 4
"""


def main() -> None:
    """Print a line for each extract."""
    for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 1):
        with tempfile.TemporaryDirectory() as folder, own_domain(Path(folder)):
            measure(Path(folder))


def measure(folder: Path) -> None:
    """One run."""
    from nav_msgs.msg import Odometry
    from rclpy.serialization import deserialize_message

    network = Network()
    sending = network.publisher(Odometry, "/odom")
    with Node(emitted(PROPERTIES, folder), folder, cut=folder / "cut", cut_before=2.0, cut_after=1.0) as node:
        network.matched([sending])
        sent = send(sending, Odometry())
        network.wait_until(lambda: len(list((folder / "cut").glob("*.mcap"))) == 2, "extracts")
        node.end()
    for path in sorted((folder / "cut").iterdir()):
        with path.open("rb") as file:
            messages = [m for _, _, m in make_reader(file).iter_messages()]
        numbers = [int(deserialize_message(m.data, Odometry).header.frame_id) for m in messages]
        inside = sum(numbers[0] <= number <= numbers[-1] for number in range(sent))
        span = (messages[-1].log_time - messages[0].log_time) / 1e9
        told = f"{len(set(numbers))} of {inside} messages in {span:.3f} s, {path.stat().st_size / 1e6:.1f} MB"
        print(f"{path.name.partition('_')[0]}: {told}; {sent} were sent")
    network.close()


def send(publisher: Any, message: Any) -> int:
    """Send at the rate, as well as the machine can; how many messages that were."""
    began, count = time.monotonic(), RATE * SECONDS
    for number in range(count):
        message.header.frame_id = str(number)
        message.twist.twist.linear.x = 9.0 if number == count // 2 else 1.0
        publisher.publish(message)
        time.sleep(max(0.0, began + (number + 1) / RATE - time.monotonic()))
    return count


if __name__ == "__main__":
    main()
