"""Nanoseconds a step of emitted C and Rust beside Copilot's C for the same formulas in one run; bytes on a Cortex-M4.

    python -m benchmarks.c [--compiler CC] [--samples N] [--rounds N]

Five properties, each in a file of its own, but for W5, which is twenty in one file, on 35 atoms and 6 signals. All get
the same samples from arrays, one call a sample, compiled with -O2 and without optimisation across files; Rust is a
crate of its own, stepped by a program in Rust. A figure is
the median over the rounds, which go around the tools in turn, and in parentheses the least. It includes the loop that
makes the calls; `call` is that loop around an empty function. The signals are smooth, and no property is decided.

Copilot (Debian's ghc and libghc-copilot-c99-dev) has no future: it gets past-time formulas that are false from the
violation on, or while something is owed, and a trigger for their conjunction. Whatever is not there, is said.
"""

from __future__ import annotations

import argparse
import platform
import re
import shutil
import statistics
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from ltlc.automata import Budget
from ltlc.backends.c import Files, emit
from ltlc.backends.rust import file_of
from ltlc.base.source import Source
from ltlc.compiler import Compiled, compile_specification
from ltlc.frontend.language import load_text
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.specification import Specification

COLUMNS = 6
DECLARATIONS = "".join(f"decl c{n} /c{n} std_msgs/Float64.data\n" for n in range(COLUMNS))
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")
ARM = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-std=c99", "-Os", "-ffp-contract=off")


@dataclass(frozen=True)
class Property:
    """A property in ltlc's language and as a stream of Copilot's."""

    ltlc: str
    copilot: str


def absence(column: int, least: float) -> Property:
    return Property(f"never c{column} > {least}", f"alwaysBeen (c{column} <= {least})")


def response(column: int, other: int, least: float) -> Property:
    p, q = (f"c{column} < {least}", f"c{other} < 0.1")
    return Property(f"always ({p} implies eventually {q})", f"not (not ({q}) `since` (({p}) && not ({q})))")


def existence(column: int, least: float) -> Property:
    return Property(f"eventually c{column} < {least}", f"eventuallyPrev (c{column} < ({least}))")


def universality(column: int, other: int, opens: float) -> Property:
    q, r, s = f"c{column} < {opens}", f"c{column} > {opens + 2}", f"c{other} < 9"
    since = f"(not ({r})) `since` (({q}) && not ({r}))"
    return Property(f"after_until {q}, {r}, always {s}", f"alwaysBeen (({since}) ==> ({s}))")


CASES = {
    "W1": [absence(0, 5.0)],
    "W2": [response(0, 1, 1.0)],
    "W3": [existence(2, -9.0)],
    "W4": [universality(0, 1, 1.0)],
    "W5": [
        *(absence(n, 5.0 + n) for n in range(5)),
        *(response(n, n + 1, 1.0 + n / 10) for n in range(5)),
        *(existence(n, -9.0 - n) for n in range(5)),
        *(universality(n, n + 1, 1.0 + n / 10) for n in range(5)),
    ],
}

SAMPLES = """
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
static double *columns[{columns}];
static void fill(size_t count)
{{
    for (int c = 0; c < {columns}; c++) {{
        columns[c] = malloc(count * sizeof(double));
        for (size_t i = 0; i < count; i++) {{
            columns[c][i] = (c % 2 ? 0.95 : 2.5) + (c % 2 ? 0.95 : 2.0) * cos((double)i / 50.0 - 0.1 * c);
        }}
    }}
}}
static double now(void)
{{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}}
"""

MAIN = """
int main(int argc, char **argv)
{{
    const size_t count = (size_t)atol(argv[1]);
    (void)argc;
    fill(count);
    {before}
    for (int round = 0; round < 3; round++) {{
        const double start = now();
        for (size_t i = 0; i < count; i++) {{
            {each}
        }}
        if (round == 2) {{
            printf("%.3f\\n", (now() - start) / (double)count);
        }}
    }}
    {after}
    return 0;
}}
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--compiler", default="gcc")
    parser.add_argument("--samples", type=int, default=1_000_000, help="in a round, default: %(default)s")
    parser.add_argument("--rounds", type=int, default=9, help="default: %(default)s")
    options = parser.parse_args()
    said = subprocess.run([options.compiler, "--version"], capture_output=True, text=True, check=True).stdout
    print(f"{platform.machine()}, {said.splitlines()[0]}, {options.samples:,} samples, {options.rounds} rounds\n")
    with TemporaryDirectory() as folder:
        tools: dict[str, Callable[[Path, str, str], Path | str]] = {
            "call": call_tool,
            "ltlc": ltlc_tool,
            "ltlc, Rust": rust_tool,
            "copilot": copilot_tool,
        }
        built = {
            (tool, case): build(Path(folder) / f"{number}_{case}", case, options.compiler)
            for number, (tool, build) in enumerate(tools.items())
            for case in CASES
        }
        figures: dict[tuple[str, str], list[float]] = {key: [] for key in built}
        for _ in range(options.rounds):
            for key, program in built.items():
                if isinstance(program, Path):
                    figures[key].append(float(output([str(program), str(options.samples)])))
        print("| ns a step | " + " | ".join(CASES) + " |\n|---|" + "---|" * len(CASES))
        for tool in tools:
            found = [figures[tool, case] for case in CASES]
            cells = [f"{statistics.median(each):.2f} ({min(each):.2f})" if each else "" for each in found]
            print(f"| {tool} | {' | '.join(cells)} |")
        for reason in dict.fromkeys(p for p in built.values() if isinstance(p, str)):
            print(f"\nnot measured: {reason}")
    print("\nnot measured: R2U2, which is neither on PyPI nor in Debian")
    sizes()


def compiled_case(case: str) -> tuple[Sequence[Compiled], Specification]:
    text = DECLARATIONS + "\n".join(f"p{n}: {p.ltlc}" for n, p in enumerate(CASES[case]))
    specification, problems = load_text(Source(f"{case.lower()}.txt", text))
    assert specification is not None, problems
    compiled, refused = compile_specification(specification, EPISODE, Budget(60.0, 1024))
    assert not refused
    return compiled, specification


def files_of(case: str) -> Files:
    return emit(*compiled_case(case), case.lower())


def ltlc_tool(folder: Path, case: str, compiler: str) -> Path:
    """A program that steps the emitted monitors; it fails where one is decided, for then there is little to do."""
    files = files_of(case)
    write(folder, {f"{files.stem}.h": files.header, f"{files.stem}.c": files.source})
    fields = [files.samples.fields[s] for s in files.samples.group_of]
    sets = "".join(f"s.{name} = columns[{name[1:]}][i]; " for name in fields)
    flags = "".join(f"s.has_{group.name} = true; " for group in files.samples.groups)
    name = files.prefix
    checks = "".join(
        f"if (m.p{n}.verdict == {name.upper()}_VIOLATED || m.p{n}.verdict == {name.upper()}_SATISFIED) return 1;\n"
        for n in range(len(CASES[case]))
    )
    before = f"static {name}_monitors m; {name}_samples s = {{0}}; {name}_init(&m); int64_t t = 0; {flags}"
    text = program(f'#include "{files.stem}.h"\n', before, f"{sets} t += 10000000; {name}_step(&m, t, &s);", checks)
    return compiled(folder, {"main.c": text}, [f"{files.stem}.c"], compiler)


RUST = """
use monitor::{{Monitors, Property, Samples, Verdict}};
extern "C" {{ fn clock_gettime(clock: i32, time: *mut [i64; 2]) -> i32; }}
fn now() -> f64 {{
    let mut time = [0i64; 2];
    unsafe {{ clock_gettime(2, &mut time) }}; // CLOCK_PROCESS_CPUTIME_ID of Linux
    time[0] as f64 * 1e9 + time[1] as f64
}}
fn main() {{
    let count: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let columns: Vec<Vec<f64>> = (0..{columns}).map(|c| (0..count).map(|i| {{
        let (middle, wide) = if c % 2 == 1 {{ (0.95, 0.95) }} else {{ (2.5, 2.0) }};
        middle + wide * (i as f64 / 50.0 - 0.1 * c as f64).cos()
    }}).collect()).collect();
    let (mut monitors, mut time) = (Monitors::new(), 0i64);
    for round in 0..3 {{
        let start = now();
        for i in 0..count {{
            time += 10000000;
            monitors.step(time, &Samples {{ {sets} }});
        }}
        if round == 2 {{
            println!("{{:.3}}", (now() - start) / count as f64);
        }}
    }}
    let decided = [Verdict::Violated, Verdict::Satisfied];
    assert!(Property::ALL.iter().all(|each| !decided.contains(&monitors.judgement(*each).verdict)));
}}
"""


def rust_tool(folder: Path, case: str, _: str) -> Path | str:
    """The same in Rust."""
    if shutil.which("rustc") is None:
        return "Rust, for there is no rustc"
    file = file_of(*compiled_case(case))
    sets = ", ".join(f"{name}: Some(columns[{name[1:]}][i])" for name in file.c.samples.fields.values())
    write(folder, {"monitor.rs": file.text, "main.rs": RUST.format(columns=COLUMNS, sets=sets)})
    for more in (["--crate-type=rlib", "monitor.rs"], ["-L.", "--extern=monitor", "main.rs", "-o", "program"]):
        subprocess.run(["rustc", "--edition=2021", "-Copt-level=2", *more], cwd=folder, check=True)
    return folder / "program"


def call_tool(folder: Path, case: str, compiler: str) -> Path:
    """The loop alone."""
    declared = "void empty(const double *s, long t);\n"
    write(folder, {"empty.c": declared + "void empty(const double *s, long t) { (void)s; (void)t; }\n"})
    used = sorted({int(n) for p in CASES[case] for n in re.findall(r"c(\d)", p.ltlc)})
    sets = "".join(f"s[{n}] = columns[{n}][i]; " for n in used)
    text = program(declared, "double s[6]; long t = 0;", f"{sets} t += 10000000; empty(s, t);", "")
    return compiled(folder, {"main.c": text}, ["empty.c"], compiler)


COPILOT = """module Main where
import Copilot.Compile.C99
import Language.Copilot
import Copilot.Library.PTLTL
import Prelude hiding ((<=), (<), (>), (&&), not, (++), and, or, since)
{externs}
spec :: Spec
spec = trigger "seen" (not ({conjunction})) []
main :: IO ()
main = reify spec >>= compile "monitor"
"""


def copilot_tool(folder: Path, case: str, compiler: str) -> Path | str:
    """A program that steps what Copilot makes."""
    if shutil.which("runghc") is None:
        return "Copilot, for there is no runghc"
    externs = "".join(f'c{n} :: Stream Double\nc{n} = extern "c{n}" Nothing\n' for n in range(COLUMNS))
    conjunction = " && ".join(f"({p.copilot})" for p in CASES[case])
    write(folder, {"Main.hs": COPILOT.format(externs=externs, conjunction=conjunction)})
    done = subprocess.run(["runghc", "Main.hs"], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        return f"Copilot: {done.stderr.strip()[:500]}"
    used = sorted({int(n) for p in CASES[case] for n in re.findall(r"c(\d)", p.copilot)})
    sets = "".join(f"c{n} = columns[{n}][i]; " for n in used)
    declared = "".join(f"double c{n}; " for n in used)
    head = f"void step(void);\n{declared}\nlong count;\nvoid seen(void);\nvoid seen(void) {{ count++; }}\n"
    text = program(head, "", f"{sets} step();", "")
    return compiled(folder, {"main.c": text}, ["monitor.c"], compiler)


def program(head: str, before: str, each: str, after: str) -> str:
    head_ = "#define _POSIX_C_SOURCE 199309L\n" + head
    return head_ + SAMPLES.format(columns=COLUMNS) + MAIN.format(before=before, each=each, after=after)


def write(folder: Path, texts: dict[str, str]) -> None:
    folder.mkdir(exist_ok=True)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")


def compiled(folder: Path, texts: dict[str, str], sources: Sequence[str], compiler: str) -> Path:
    write(folder, texts)
    command = [compiler, *FLAGS, *texts, *sources, "-o", "program", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "program"


def output(command: Sequence[str]) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def sizes() -> None:
    """Bytes of code and of the struct of all monitors on a Cortex-M4."""
    if shutil.which("arm-none-eabi-gcc") is None:
        print("\nnot measured: bytes on a Cortex-M4, for there is no arm-none-eabi-gcc")
        return
    print("\n| bytes on a Cortex-M4, -Os | " + " | ".join(CASES) + " |\n|---|" + "---|" * len(CASES))
    flash, memory = [], []
    for case in CASES:
        with TemporaryDirectory() as name:
            files, folder = files_of(case), Path(name)
            size = f'#include "{files.stem}.h"\nchar size[sizeof({files.prefix}_monitors)] = {{1}};\n'
            write(folder, {f"{files.stem}.h": files.header, "m.c": files.source, "size.c": size})
            for source in ("m.c", "size.c"):
                subprocess.run(["arm-none-eabi-gcc", *ARM, "-c", source], cwd=folder, check=True)
            of_code, of_data = (
                output(["arm-none-eabi-size", str(folder / f"{o}.o")]).splitlines()[1].split() for o in ["m", "size"]
            )
            flash.append(int(of_code[0]) + int(of_code[1]))
            memory.append(int(of_data[1]))
    counts = [len(CASES[case]) for case in CASES]
    for what, found in (("flash", flash), ("RAM", memory)):
        print(
            f"| {what} | "
            + " | ".join(f"{n} ({n // c} each)" if c > 1 else str(n) for n, c in zip(found, counts, strict=True))
            + " |"
        )


if __name__ == "__main__":
    main()
