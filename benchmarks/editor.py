"""How long an editor waits for the language server: `python -m benchmarks.editor [--properties N] [--rounds N]`.

A server as a process, and an editor that opens a text of N properties of ten kinds, then types while analyses run: how
long each takes from the message until the diagnostics of the front end, or the answer, are there, and what the server
takes of a CPU, on the average, its children left out.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter, sleep

HERE = Path(__file__).parents[1]
sys.path.insert(0, str(HERE / "tests"))

from editor_client import Editor  # noqa: E402

KINDS = (
    "never r{0}.velocity > 2.0",
    "min(scan{0}) > 0.3",
    "never count(scan{0}[80:100] < 0.5) >= 5",
    "drift{0}: always r{0}.localization_error < 0.5",
    "until r{0}.position.x > 5, r{0}.velocity < 1",
    "after_until r{0}.distance.stop_sign < 1, r{0}.distance.stop_sign > 1, eventually stopped{0}",
    "never r{0}.position.x - @{{r{0}.position.x, -1}} > 0.2",
    "always (min(scan{0}) < 0.3 implies eventually stopped{0} within 200 ms)",
    "always age(scan{0}) <= 0.5 s",
    "after_until near{0}, not near{0}, r{0}.velocity <= @{{r{0}.velocity, opening}}",
)
DEFINITIONS = (
    "decl scan{0} /r{0}/scan LaserScan.ranges",
    "model r{0}: position /r{0}/odom Odometry.pose.pose.position ;",
    "stopped{0} = r{0}.velocity =={{0.01}} 0",
    "near{0} = r{0}.distance.dock < 1",
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--properties", type=int, default=100)
    parser.add_argument("--rounds", type=int, default=10)
    options = parser.parse_args()
    text = specification(options.properties)
    print(f"{len(text.splitlines())} lines, {options.properties} properties\n")
    print("| | median, ms | most, ms | of a CPU, ms |\n|---|---|---|---|")
    with Editor() as editor:
        place = (len(text.splitlines()), 9)
        questions: dict[str, Callable[[int], object]] = {
            "first diagnostics": lambda number: opened(editor, text, number),
            "a key, to its diagnostics, while analyses run": lambda number: key(editor, text, number),
            "completion": lambda _: editor.ask("completion", place),
            "hover": lambda _: editor.ask("hover", place),
            "definition": lambda _: editor.ask("definition", place),
            "semantic tokens": lambda _: editor.ask("semanticTokens/full"),
        }
        for what, question in questions.items():
            show(what, editor.process.pid, question, options.rounds)
        editor.end()


def show(what: str, server: int, question: Callable[[int], object], rounds: int) -> None:
    """A line about a question that is asked so many times."""
    seconds, before = [], cpu(server)
    for number in range(rounds):
        if what.startswith("a key"):
            sleep(1)  # an analysis of the text before has begun
        begun = perf_counter()
        question(number)
        seconds.append(perf_counter() - begun)
    taken = (cpu(server) - before) / rounds
    print(f"| {what} | {median(seconds) * 1000:.0f} | {max(seconds) * 1000:.0f} | {taken * 1000:.0f} |", flush=True)


def cpu(process: int) -> float:
    """Seconds of CPU that a process has taken."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def specification(count: int) -> str:
    """So many properties, ten of each robot."""
    robots = range(-(-count // len(KINDS)))
    lines = [line.format(robot) for robot in robots for line in DEFINITIONS]
    return "\n".join([*lines, *(kind.format(robot) for robot in robots for kind in KINDS)][: len(lines) + count]) + "\n"


def opened(editor: Editor, text: str, number: int) -> None:
    """Open a file and wait for its first diagnostics; the one before is closed."""
    editor.notify("textDocument/didClose", {"textDocument": {"uri": uri(number - 1)}})
    editor.open(text, uri(number))
    editor.diagnostics(uri(number))


def uri(number: int) -> str:
    return f"file:///home/robot/{number}.txt"


def key(editor: Editor, text: str, number: int) -> None:
    """Change the text and wait for its diagnostics."""
    changed = f"{text}never r0.velocity > {number}\n"
    editor.type(changed) if number else editor.open(changed)
    editor.diagnostics()


if __name__ == "__main__":
    main()
