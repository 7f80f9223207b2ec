"""How long `ltlc check` and `ltlc build` take, as a user waits for them: `python benchmarks/compile.py`.

Whole processes, start of Python included, the gate included in build; medians.
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


def many(count: int, signals: int = 40) -> str:
    """A specification with `count` properties over `signals` shared signals; the same at every call."""
    chance = random.Random(0)
    names = [f"r{n}.{attribute}" for n in range(signals // 2) for attribute in ("velocity", "position.x")]

    def comparison() -> str:
        return f"{chance.choice(names)} {chance.choice(['<', '>', '<=', '>='])} {chance.choice([0.5, 1, 2, 3])}"

    properties = (chance.choice(FORMS).format(*(comparison() for _ in range(4))) for _ in range(count))
    return "\n".join(f"p{number}: {text}" for number, text in enumerate(properties)) + "\n"


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
        one, hundred = Path(folder, "one.txt"), Path(folder, "hundred.txt")
        one.write_text(STOP_SIGN, encoding="utf-8")
        hundred.write_text(many(100), encoding="utf-8")
        output = str(Path(folder, "out.py"))
        for name, path, repeats in (("one property", one, 9), ("100 properties", hundred, 1)):
            print(f"check, {name}: {seconds(['check', str(path)], repeats):.2f} s")
            print(f"build with gate, {name}: {seconds(['build', str(path), '-o', output], repeats):.2f} s")


if __name__ == "__main__":
    main()
