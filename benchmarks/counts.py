"""Nanoseconds a step of `once new v N times within 1 s` by rows and in C, for several N, and the bytes that C needs.

    python -m benchmarks.counts [--samples N]

A message each 0.9 ms, so that of up to 1,000 all are within the second. A figure is the median of five rounds.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time_ns

from ltlc.automata import Budget
from ltlc.backends.c import emit
from ltlc.backends.python.load import load_plan
from ltlc.base.source import Source
from ltlc.compiler import compile_specification
from ltlc.frontend.language import load_text
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.semantics.encodings import EPISODE

APART, ROUNDS = 900_000, 5
PROPERTIES = {"without": "never v > 9"} | {
    f"{n:,}": f"never (once new v {n} times within 1 s and v > 9)" for n in (1, 10, 100, 1000)
}
MAIN = """
#include "props.h"
#include <stdio.h>
#include <time.h>
int main(void)
{
    static props_monitors monitors;
    props_samples samples = {0};
    props_init(&monitors);
    samples.has_v = true;
    clock_t begin = clock();
    for (int64_t n = 0; n < SAMPLES; n++) {
        props_step(&monitors, n * APART, &samples);
    }
    printf("%f %zu", (double)(clock() - begin) / CLOCKS_PER_SEC * 1e9 / SAMPLES, sizeof monitors);
    return 0;
}
"""


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=50_000, help="by rows; a hundred times as many in C")
    samples = parser.parse_args().samples
    print("| N | rows | C | bytes |\n|---|---|---|---|")
    for name, text in PROPERTIES.items():
        specification, _ = load_text(Source("props.txt", f"decl v /v std_msgs/Float64.data\n{text}\n"))
        assert specification is not None
        compiled, _ = compile_specification(specification, EPISODE, Budget())
        plan, files = load_plan(compiled, specification), emit(compiled, specification, "props")
        with TemporaryDirectory() as folder:
            for file, written in (("props.h", files.header), ("props.c", files.source), ("main.c", MAIN)):
                (Path(folder) / file).write_text(written, encoding="utf-8")
            given = [f"-DSAMPLES={samples * 100}", f"-DAPART={APART}", "-O2", "-ffp-contract=off"]
            subprocess.run(["cc", "-std=c99", *given, "props.c", "main.c", "-o", "main"], cwd=folder, check=True)
            in_c = [_printed(Path(folder) / "main") for _ in range(ROUNDS)]
        by_rows = statistics.median(_by_rows(ByRows(Session(plan)), samples) for _ in range(ROUNDS))
        print(f"| {name} | {by_rows:,.0f} | {statistics.median(t for t, _ in in_c):.1f} | {in_c[0][1]:,.0f} |")


def _printed(program: Path) -> tuple[float, float]:
    time, size = subprocess.run([program], check=True, capture_output=True, text=True).stdout.split()
    return float(time), float(size)


def _by_rows(rows: ByRows, samples: int) -> float:
    begin = process_time_ns()
    for number in range(samples):
        rows.samples(number * APART, ("v",), (1.0,))
    return (process_time_ns() - begin) / samples


if __name__ == "__main__":
    main()
