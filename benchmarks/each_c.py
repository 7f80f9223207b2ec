"""Bytes an id and nanoseconds a message of `each` in emitted C, beside the same property of whole runs, in one program.

    python -m benchmarks.each_c [--messages N] [--rounds N]

Each message is of one of as many ids as the limit allows, at random; a third of them owes something.
Compiled with -O2; a figure is the least of the rounds, which go around all programs in turn. It includes the loop that
makes the calls.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from ltlc.automata import Budget
from ltlc.backends.c import emit
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.semantics.encodings import EPISODE

HEAD = "decl v /u sensor_msgs/JoyFeedback.intensity\ndecl key /u sensor_msgs/JoyFeedback.id\n"
RULE = "always (v > 2 implies eventually v < 1 within 60 s)"
LIMITS = (16, 128, 255)
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")

MAIN = """
#include "props.h"
#include <stdio.h>
#include <time.h>

static {state} state;

int main(void)
{{
    {init}(&state);
    uint32_t chance = 1;
    const clock_t began = clock();
    for (int64_t n = 0; n < {messages}; n++) {{
        chance = chance * 1664525u + 1013904223u;
        const props_samples samples = {{.v = (float)((chance >> 8) % 3u) + 0.5f, .has_v = true}};
        (void){step};
    }}
    printf("%zu %.1f\\n", sizeof state, (double)(clock() - began) / CLOCKS_PER_SEC * 1e9 / {messages});
    return 0;
}}
"""


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--messages", type=int, default=5_000_000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    with TemporaryDirectory() as folder:
        programs = {"no ids": (1, _made(Path(folder) / "whole", RULE, options.messages, None))}
        for limit in LIMITS:
            text = f"each k of key limit {limit}: {RULE}"
            programs[f"{limit} ids"] = (limit, _made(Path(folder) / str(limit), text, options.messages, limit))
        found: dict[str, list[tuple[int, float]]] = {}
        for _ in range(options.rounds):
            for name, (_, program) in programs.items():
                said = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()
                found.setdefault(name, []).append((int(said[0]), float(said[1])))
    print("| | bytes an id | ns a message |\n|---|---|---|")
    for name, (limit, _) in programs.items():
        print(f"| {name} | {found[name][0][0] / limit:.0f} | {min(ns for _, ns in found[name]):.1f} |")


def _made(folder: Path, text: str, messages: int, limit: int | None) -> Path:
    """The compiled program for a property, of whole runs or with at most `limit` ids."""
    folder.mkdir()
    loaded, _ = load_text(Source("props.txt", f"{HEAD}p: {text}"))
    assert loaded is not None
    compiled, _ = compile_specification(loaded, EPISODE, Budget(60.0, 1024))
    files = emit(compiled, loaded, "props")
    (folder / "props.h").write_text(files.header)
    (folder / "props.c").write_text(files.source)
    step = "props_step(&state, n * 1000, &samples)"
    if limit is not None:
        step = f"props_ids_step(&state, n * 1000, (uint8_t)((chance >> 16) % {limit}u), &samples)"
    state, init = ("props_monitors", "props_init") if limit is None else ("props_ids", "props_ids_init")
    (folder / "main.c").write_text(MAIN.format(step=step, messages=messages, state=state, init=init))
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))))
    subprocess.run([compiler, *FLAGS, "main.c", "props.c", "-o", "program"], cwd=folder, check=True)
    return folder / "program"


if __name__ == "__main__":
    main()
