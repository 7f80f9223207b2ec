"""Adversarial runs against guards in C, in C: what leaves them is judged by the plain monitors of the same properties.

    python -m benchmarks.guarded_c 10000000 [NAME…]    # so many events for each guard
    python -m benchmarks.guarded_c --time              # what a call takes, beside a step of the monitors

Messages come where it is hardest, many at the same time or a nanosecond before, at and after deadlines. The judge is
made of the properties without the guard, and hears what the guard hears and lets out.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from guarding import programs

from benchmarks.guarded import EXAMPLES, LONGEST, MS, Example
from ltlc.assurance.c_guard import fallbacks
from ltlc.assurance.c_library import FLAGS, compiler
from ltlc.backends import c
from ltlc.backends.c.expressions import C
from ltlc.backends.c.guards import GuardFiles, emit
from ltlc.backends.c.types import pointer
from ltlc.backends.operators import flat
from ltlc.interfaces.building.guards import NoRegionError
from ltlc.program.expressions import Literal
from ltlc.program.types import Type, type_of
from ltlc.runtime.guarding import Message
from ltlc.specification.expressions import Signal

BOUNDS = [20, 50, 90, 100, 200, 500, 1000, 2000]
"""Gaps that deadlines make, in ms."""

SAMPLES, BATCH = 400, 500
"""How many times so many calls are timed."""


@dataclass(frozen=True)
class Driver:
    """A guard in C, the judge, and the program that drives them."""

    texts: dict[str, str]

    def run(self, folder: Path, *arguments: str, flags: Sequence[str] = ()) -> str:
        """What the program prints, compiled with `flags` of its own. Raises CalledProcessError."""
        for name, text in self.texts.items():
            (folder / name).write_text(text, encoding="utf-8")
        sources = [name for name in self.texts if name.endswith(".c")]
        path = compiler()
        assert path is not None, "there is no C compiler"
        flags = [*(flag for flag in FLAGS if flag != "-std=c99"), *flags]
        subprocess.run([path, "-std=gnu99", *flags, "-O2", *sources, "-o", "driver", "-lm"], cwd=folder, check=True)
        done = subprocess.run([folder / "driver", *arguments], capture_output=True, text=True, check=True)
        return done.stdout.strip()


def drivers(example: Example) -> list[Driver]:
    """What drives the guards of an example, those together that share properties. Raises as `programs`, and `emit`."""
    specification, compiled, _, programs_ = programs(example.text)
    files, judge = c.emit(compiled, specification, "g"), c.emit(compiled, specification, "judge")
    found = []
    for guard, program in zip(emit(files, programs_), programs_, strict=True):
        parts = [
            _BEGINNING,
            *(line for signal in files.samples.group_of for line in _setter(signal, example, files)),
            *_fillers(example, files, guard),
            *_fallbacks(files, fallbacks(program, compiled)),
            *_kept(files, [files.properties[n].name for n in program.parts if n not in program.assumed]),
            _driving([MS * bound for bound in BOUNDS]),
        ]
        text = "\n".join(parts).replace("g_guard", guard.prefix).replace("G_GUARD", guard.prefix.upper())
        texts = {"g.c": files.source, "g.h": files.header, "judge.c": judge.source, "judge.h": judge.header}
        found.append(Driver({**texts, **guard.texts, "driver.c": text}))
    return found


_BEGINNING = """\
#include "g_guard.h"
#include "judge.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static uint64_t state = 88172645463325252u;

static uint32_t draw(uint32_t count)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (uint32_t)((state >> 32) % count);
}
"""


def _constant(value: object, type_: Type) -> str:
    assert isinstance(value, bool | int | float | str)
    exact = int(value) if type_.scalar.is_integer else value
    return flat(C("g").speller({}).code(Literal(exact, type_)))


def _assigned(samples: str, field: str, value: object, type_: Type) -> Iterator[str]:
    """Statements of a block that give samples a value."""
    if not isinstance(value, tuple):
        yield " ".join(f"        {each}->{field} = {_constant(value, type_)};" for each in samples)
    elif value:
        items = ", ".join(_constant(each, type_.element) for each in value)
        yield f"        static {pointer(type_)[:-1]}{field}[] = {{{items}}};"
        yield " ".join(f"        {each}->{field}.elements = {field};" for each in samples)
        yield " ".join(f"        {each}->{field}.length = {len(value)};" for each in samples)


def _setter(signal: Signal, example: Example, files: c.Files) -> Iterator[str]:
    """A function that gives samples one of the values of a signal."""
    field, type_ = files.samples.fields[signal], type_of(signal)
    values = next(of[signal.name] for of in example.values.values() if signal.name in of)
    yield f"static inline void set_{field}(g_samples *g, judge_samples *j, uint32_t which)\n{{\n    switch (which) {{"
    for number, value in enumerate(values):
        yield f"    case {number}: {{"
        yield from _assigned("gj", field, value, type_)
        yield "        break;\n    }"
    yield "    default: break;\n    }\n}\n"


def _fillers(example: Example, files: c.Files, guard: GuardFiles) -> Iterator[str]:
    """Functions that draw a message on a topic by number, those of commands first, and that hand it to `g_guard`."""
    topics = [*guard.commands, *guard.others]
    yield f"enum {{ OUTS = {len(guard.commands)}, TOPICS = {len(topics)} }};\n"
    yield "static void fill(uint32_t topic, g_samples *g, judge_samples *j)\n{"
    yield "    memset(g, 0, sizeof *g); memset(j, 0, sizeof *j);\n    switch (topic) {"
    for number, topic in enumerate(topics):
        yield f"    case {number}:"
        for group in files.samples.groups:
            if group.topic == topic:
                for signal in group.readings:
                    count = len(example.values[topic][signal.name])
                    yield f"        set_{files.samples.fields[signal]}(g, j, draw({count}u));"
                yield f"        g->has_{group.name} = true; j->has_{group.name} = true;"
        yield from _news(files, topic, "gj")
        yield "        break;"
    yield "    default: break;\n    }\n}\n"
    yield "static g_guard_decision hear(g_guard_run *run, int64_t time, uint32_t topic, const g_samples *g)\n{"
    yield "    (void)run; (void)time; (void)g;\n    switch (topic) {"
    called = [*guard.commands.values(), *(f"{guard.prefix}_hear_{name}" for name in guard.others.values())]
    for number, name in enumerate(called):
        yield f"    case {number}: return g_guard{name.removeprefix(guard.prefix)}(run, time, g);"
    yield "    default: return G_GUARD_HOLD;\n    }\n}\n"
    timed = f"{guard.prefix}_due(" in guard.header
    call = "g_guard_due(run)" if timed else "G_NEVER"
    yield f"static int64_t due(const g_guard_run *run) {{ (void)run; return {call}; }}"
    call = "g_guard_act(run, time)" if timed else "G_GUARD_HOLD"
    yield f"static g_guard_decision act(g_guard_run *run, int64_t time) {{ (void)run; (void)time; return {call}; }}"
    advance = "judge_advance(j, time)" if "judge_advance(" in guard.header or timed else "false"
    yield f"static void pass(judge_monitors *j, int64_t time) {{ (void)j; (void)time; (void)({advance}); }}\n"


def _news(files: c.Files, topic: str, samples: str) -> Iterator[str]:
    for heard in files.samples.heard.values():
        if heard.has_flag and heard.topic == topic:
            yield " ".join(f"        {each}->{heard.name} = true;" for each in samples)


def _fallbacks(files: c.Files, messages: Sequence[Message]) -> Iterator[str]:
    """A function that makes the judge's samples of what the guard sends."""
    yield "static void fallback(uint32_t number, judge_samples *j)\n{"
    yield "    memset(j, 0, sizeof *j);\n    switch (number) {"
    for number, message in enumerate(messages):
        yield f"    case {number}: {{"
        for group in files.samples.groups:
            if group.topic == message.out and all(signal.name in message.values for signal in group.readings):
                for signal in group.readings:
                    yield from _assigned(
                        "j", files.samples.fields[signal], message.values[signal.name], type_of(signal)
                    )
                yield f"        j->has_{group.name} = true;"
        yield from _news(files, message.out, "j")
        yield "        break;\n    }"
    yield "    default: break;\n    }\n}\n"


def _kept(files: c.Files, names: Sequence[str]) -> Iterator[str]:
    """A function that says whether a property that is kept is violated."""
    violated = " || ".join(f"j->{name}.verdict == JUDGE_VIOLATED" for name in names)
    yield f"static bool is_violated(const judge_monitors *j) {{ return {violated}; }}\n"


def _driving(bounds: Sequence[int]) -> str:
    numbers = ", ".join(f"INT64_C({bound})" for bound in bounds)
    return f"""\
static uint64_t passed, changed, held, sent, lost, violated;

static int64_t gap(int64_t now, int64_t next)
{{
    static const int64_t bounds[] = {{{numbers}}};
    static const int64_t gaps[] = {{0, 0, 1, {MS}, {10 * MS}, {30 * MS}}};
    const uint32_t which = draw(10);
    if (which < 6) {{
        return gaps[which];
    }}
    if (which < 9 && next < G_NEVER && next + 1 >= now) {{
        const int64_t found = next - now + (int64_t)draw(3) - 1 + (draw(2) ? {10 * MS} : 0);
        return found < 0 ? 0 : found;
    }}
    return bounds[draw({len(bounds)})] + (int64_t)draw(4) - 1;
}}

static void left(judge_monitors *j, int64_t time, g_guard_decision what)
{{
    judge_samples own;
    fallback((uint32_t)what - 2u, &own);
    (void)judge_step(j, time, &own);
}}

/* Whoever runs a guard lets it act in time. */
static void catch_up(g_guard_run *run, judge_monitors *j, int64_t time)
{{
    while (due(run) <= time) {{
        const int64_t moment = due(run);
        const g_guard_decision what = act(run, moment);
        if (what != G_GUARD_HOLD) {{
            left(j, moment, what);
            sent++;
        }}
    }}
    pass(j, time);
}}

static void one_run(uint32_t events)
{{
    g_guard_run run;
    judge_monitors j;
    g_samples samples;
    judge_samples own;
    int64_t time = {1000 * MS};
    g_guard_init(&run);
    judge_init(&j);
    for (uint32_t number = 0; number < events; number++) {{
        const uint32_t topic = number + OUTS < TOPICS ? number + OUTS : draw(draw(2) ? OUTS : TOPICS);
        time += gap(time, due(&run));
        catch_up(&run, &j, time);
        fill(topic, &samples, &own);
        if (topic < OUTS) {{
            const g_guard_decision what = hear(&run, time, topic, &samples);
            if (what == G_GUARD_PASS) {{
                (void)judge_step(&j, time, &own);
                passed++;
            }} else if (what != G_GUARD_HOLD) {{
                left(&j, time, what);
                changed++;
            }} else {{
                held++;
            }}
        }} else {{
            const g_guard_decision what = hear(&run, time, topic, &samples);
            (void)judge_step(&j, time, &own);
            if (what != G_GUARD_HOLD) {{
                left(&j, time, what);
                sent++;
            }}
        }}
    }}
    lost += run.has_lost ? 1u : 0u;
    violated += is_violated(&j) ? 1u : 0u;
}}

static double now(void)
{{
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec * 1e9 + (double)at.tv_nsec;
}}

static int ascending(const void *left_, const void *right_)
{{
    const double left_one = *(const double *)left_, right_one = *(const double *)right_;
    return (left_one > right_one) - (left_one < right_one);
}}

/* What a step of the monitors takes, and a command to the guard, by turns; medians in ns. */
static void measure(void)
{{
    static double steps[{SAMPLES}], commands[{SAMPLES}];
    static g_samples asked[64];
    static judge_samples same[64];
    g_guard_run run;
    judge_monitors j;
    g_samples samples;
    judge_samples own;
    int64_t time = {1000 * MS};
    g_guard_init(&run);
    judge_init(&j);
    for (uint32_t sample = 0; sample < {SAMPLES}; sample++) {{
        for (uint32_t topic = OUTS; topic < TOPICS; topic++) {{
            catch_up(&run, &j, time);
            fill(topic, &samples, &own);
            (void)hear(&run, time, topic, &samples);
            (void)judge_step(&j, time, &own);
        }}
        for (uint32_t n = 0; n < 64; n++) {{
            fill(0, &asked[n], &same[n]);
        }}
        const int64_t first = time;
        double began = now();
        for (uint32_t n = 0; n < {BATCH}; n++) {{
            time += {MS};
            (void)judge_step(&j, time, &same[n % 64]);
        }}
        steps[sample] = (now() - began) / {BATCH};
        time = first;
        began = now();
        for (uint32_t n = 0; n < {BATCH}; n++) {{
            time += {MS};
            passed += hear(&run, time, 0, &asked[n % 64]) == G_GUARD_PASS ? 1u : 0u;
        }}
        commands[sample] = (now() - began) / {BATCH};
    }}
    qsort(steps, {SAMPLES}, sizeof *steps, ascending);
    qsort(commands, {SAMPLES}, sizeof *commands, ascending);
    const double step = steps[{SAMPLES} / 2], call = commands[{SAMPLES} / 2];
    printf("%.1f %.1f %.2f %.0f\\n", step, call, call / step, 100.0 * (double)passed / {SAMPLES} / {BATCH});
}}

int main(int count, char **arguments)
{{
    state ^= count > 2 ? strtoull(arguments[2], NULL, 10) * 0x9E3779B97F4A7C15u : 0u;
    if (count < 2 || arguments[1][0] == 't') {{
        measure();
        return 0;
    }}
    for (uint64_t events = strtoull(arguments[1], NULL, 10); events > 0;) {{
        const uint32_t length = 2 + draw({LONGEST} - 1);
        const uint32_t some = events < length ? (uint32_t)events : length;
        one_run(some);
        events -= some;
    }}
    printf("%llu %llu %llu %llu %llu %llu\\n", (unsigned long long)passed, (unsigned long long)changed,
           (unsigned long long)held, (unsigned long long)sent, (unsigned long long)lost, (unsigned long long)violated);
    return 0;
}}
"""


def main(arguments: Sequence[str]) -> int:
    """Drive each guard; the exit code is 1 if a property was violated."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("events", type=int, nargs="?", default=0)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--time", action="store_true")
    options = parser.parse_args(arguments)
    violated = 0
    for name, example in EXAMPLES.items():
        if options.names and name not in options.names:
            continue
        try:
            found = drivers(example)
        except NoRegionError as error:
            print(f"{name}: left out: {error}")
            continue
        for made in found:
            with tempfile.TemporaryDirectory() as folder:
                said = made.run(Path(folder), "t" if options.time else str(options.events), str(options.seed))
            if options.time:
                step, call, ratio, passed = said.split()
                print(f"{name}: a step {step} ns, a command {call} ns, {ratio} times that; {passed} % pass")
                continue
            counts = list(map(int, said.split()))
            words = ("passed", "changed", "held back", "sent by itself", "runs lost", "runs violated")
            print(f"{name}: {', '.join(f'{n:,} {word}' for n, word in zip(counts, words, strict=True))}", flush=True)
            violated += counts[-1]
    return int(violated > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
