"""How long `ltlc build` takes, as a user waits for it: `python -m benchmarks.compile`.

Whole processes, start of Python, check and gate included; medians. `check.py` has the same for `ltlc check` alone.
"""

from __future__ import annotations

import random
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

STOP_SIGN = (
    "_margin_ = 0.01\n"
    "after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually robot.velocity == 0\n"
)
FORMS = (
    "never {0}",
    "after {0}, {1}",
    "until {0}, eventually {1}",
    "after_until {0}, {1}, eventually {2}",
    "always ({0} implies eventually {1})",
    "after_until {0} and {1}, {2}, {3}",
)


def many(count: int) -> str:
    """A specification with `count` properties, each of a robot of its own, so that none contradicts another."""
    chance = random.Random(0)

    def comparison(robot: int) -> str:
        signal = f"r{robot}.{chance.choice(['velocity', 'position.x'])}"
        return f"{signal} {chance.choice(['<', '>', '<=', '>='])} {chance.choice([0.5, 1, 2, 3])}"

    lines = []
    for robot in range(count):
        text = chance.choice(FORMS).format(*(comparison(robot) for _ in range(4)))
        lines.append(f"p{robot}: {text}\n")
    return "".join(lines)


def seconds(arguments: list[str], repeats: int) -> float:
    """The median duration of `ltlc` with these arguments."""
    durations = []
    for _ in range(repeats):
        start = time.perf_counter()
        done = subprocess.run([sys.executable, "-m", "ltlc", *arguments], capture_output=True, text=True, check=False)
        durations.append(time.perf_counter() - start)
        if done.returncode == 2:
            sys.exit(done.stderr)
    return statistics.median(durations)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        path, output = Path(folder, "props.txt"), Path(folder, "out.py")
        for name, text, repeats in (("one property", STOP_SIGN, 9), ("100 properties", many(100), 3)):
            path.write_text(text, encoding="utf-8")
            taken = seconds(["build", str(path), "-o", str(output)], repeats)
            print(f"{name}: {taken:.2f} s, {len(output.read_text(encoding='utf-8').splitlines())} lines written")
            output.unlink()


if __name__ == "__main__":
    main()
