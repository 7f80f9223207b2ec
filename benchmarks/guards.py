"""What solving the game of a guard takes, and how large it is: `python -m benchmarks.guards`."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from guarding import loaded

from ltlc.analysis.guards.solution import Solution, solve

BASE = """guard /cmd_vel_raw to /cmd_vel else stop
message stop {}
decl speed /cmd_vel geometry_msgs/Twist.linear.x
decl scan /scan sensor_msgs/LaserScan.ranges
decl pressed /estop std_msgs/Bool.data
decl localized /localized std_msgs/Bool.data
decl joy /joy sensor_msgs/Joy.axes[0]
"""

NEAR = "always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)\n"
BEGINS = "always (new speed and min(scan) < 0.5 implies speed <= 0.2)\n"
SIX = (
    f"{NEAR}{BEGINS}always (pressed implies eventually speed == 0 within 50 ms)\n"
    "always (new speed and pressed implies speed == 0)\nalways (new speed and not localized implies speed == 0)\n"
    "always (age(joy) > 500 ms implies speed == 0)\n"
)
RATE = "always (new speed implies not previously once new speed within 20 ms)"

GUARDS = {
    "slow near obstacles, in time": NEAR,
    "and no new fast command": NEAR + BEGINS,
    "a silent operator": "always (age(joy) > 500 ms implies speed == 0)\n",
    "slew rate": "always abs(speed - @{speed, -1}) <= 0.25\n",
    "a limit from a sensor": f"assume always min(scan) / 2 >= 0\n{NEAR.replace('0.2', 'min(scan) / 2')}",
    "a rate and a deadline, two clocks in one property": f"({RATE}) and ({NEAR.strip()})\n",
    "six properties on five topics": SIX,
}


def main() -> None:
    """Print a row for each guard."""
    print("| guard | places | rests in | decisions | ms |\n|---|---|---|---|---|")
    for name, properties in GUARDS.items():
        _, (arena,) = loaded(BASE + properties)
        times = []
        for _ in range(5):
            began = time.process_time()
            solution = solve(arena)
            times.append((time.process_time() - began) * 1e3)
        sizes = (len(solution.rests), _inhabited(solution), _decisions(solution))
        print(f"| {name} | {' | '.join(map(str, sizes))} | {median(times):.1f} |")


def _inhabited(solution: Solution) -> int:
    return sum(solution.game.exists(letters) for letters in solution.rests.values())


def _decisions(solution: Solution) -> int:
    d = solution.game.diagrams
    return sum(not d.is_terminal(node) for node in d.reachable(*solution.rests.values()))


if __name__ == "__main__":
    main()
