"""Bytes an id, or an open instance, and nanoseconds a message of `each` and `each new` in emitted C.

    python -m benchmarks.each_c [--messages N] [--rounds N]

Each message is of one of as many ids as the limit allows, at random; a third of them owes something. Of `each new`,
every second message opens an instance, and the others answer the oldest one: as many are open as the limit allows.
Beside them are properties of whole runs. Compiled with -O2; a figure is the least of the rounds, which go around all
programs in turn. It includes the loop that makes the calls.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from ltlc.automata import Budget
from ltlc.backends.c import emit
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.semantics.encodings import EPISODE

HEAD = """
decl v      /u sensor_msgs/JoyFeedback.intensity
decl key    /u sensor_msgs/JoyFeedback.id
decl asked  /q std_msgs/Float64.data
decl answer /a std_msgs/Float64.data
"""
RULE = "always (v > 2 implies eventually v < 1 within 60 s)"
VALUE = "{.v = (float)((chance >> 8) % 3u) + 0.5f, .has_v = true}"
LIMITS = (16, 128, 255)
ANSWERED = "eventually (new answer and answer == @{asked, opening}) within 60 s"
OPEN = (1, 4, 16, 64)
WHOLE = "always (new asked and asked >= 0 implies eventually (new answer and answer >= 0) within 60 s)"
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")

MAIN = """
#include "props.h"
#include <stdio.h>
#include <time.h>

static props_{state} state;

int main(void)
{{
    props_{init}(&state);
    uint32_t chance = 1;
    const clock_t began = clock();
    for (int64_t n = 0; n < {messages}; n++) {{
        chance = chance * 1664525u + 1013904223u;
        const props_samples samples = {samples};
        (void)props_{step};
    }}
    printf("%zu %.1f\\n", sizeof state, (double)(clock() - began) / CLOCKS_PER_SEC * 1e9 / {messages});
    return 0;
}}
"""


class Case(NamedTuple):
    """A property with `places` for ids or instances; the samples of a message, and the step that takes them."""

    text: str
    places: int
    samples: str
    state: str
    init: str
    step: str


def cases() -> dict[str, Case]:
    """All of them, by what they are called in the table."""
    whole = ("monitors", "init", "step(&state, n * 1000, &samples)")
    found = {"no ids": Case(RULE, 1, VALUE, *whole)}
    for limit in LIMITS:
        step = f"ids_step(&state, n * 1000, (uint8_t)((chance >> 16) % {limit}u), &samples)"
        found[f"{limit} ids"] = Case(f"each k of key limit {limit}: {RULE}", limit, VALUE, "ids", "ids_init", step)
    found["no instances"] = Case(WHOLE, 1, _asked(1), *whole)
    for limit in OPEN:
        step = "instances_step(&state, n * 1000, &samples)"
        opened = f"each new asked limit {limit}: {ANSWERED}"
        found[f"{limit} open"] = Case(opened, limit, _asked(limit), "instances", "instances_init", step)
    return found


def _asked(limit: int) -> str:
    """A message that asks, then one that answers what was asked first of `limit`."""
    asks = "{.asked = (double)n, .has_asked = true}"
    answers = f"{{.answer = (double)(n - {2 * limit - 1}), .has_answer = true}}"
    return f"n % 2 == 0 ? (props_samples){asks} : (props_samples){answers}"


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--messages", type=int, default=5_000_000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    with TemporaryDirectory() as folder:
        programs = {name: _made(Path(folder) / name, case, options.messages) for name, case in cases().items()}
        found: dict[str, list[tuple[int, float]]] = {}
        for _ in range(options.rounds):
            for name, program in programs.items():
                said = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()
                found.setdefault(name, []).append((int(said[0]), float(said[1])))
    print("| | bytes a place | ns a message |\n|---|---|---|")
    for name, case in cases().items():
        print(f"| {name} | {found[name][0][0] / case.places:.0f} | {min(ns for _, ns in found[name]):.1f} |")


def _made(folder: Path, case: Case, messages: int) -> Path:
    """The compiled program for a property."""
    folder.mkdir()
    loaded, _ = load_text(Source("props.txt", f"{HEAD}p: {case.text}"))
    assert loaded is not None
    compiled, _ = compile_specification(loaded, EPISODE, Budget(60.0, 1024))
    files = emit(compiled, loaded, "props")
    (folder / "props.h").write_text(files.header)
    (folder / "props.c").write_text(files.source)
    (folder / "main.c").write_text(MAIN.format(messages=messages, **case._asdict()))
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))))
    subprocess.run([compiler, *FLAGS, "main.c", "props.c", "-o", "program"], cwd=folder, check=True)
    return folder / "program"


if __name__ == "__main__":
    main()
