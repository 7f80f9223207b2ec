"""Emitted C, compiled into a library that is loaded here, so that its monitors can be stepped."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ltlc.assurance.library import LIBRARY, Loaded, load
from ltlc.backends.c import Files
from ltlc.backends.c.guards import GuardFiles
from ltlc.backends.c.ids import Table
from ltlc.backends.c.instances import OpenTable
from ltlc.backends.c.types import pointer
from ltlc.base.files import scratch
from ltlc.program.types import type_of

COMPILERS = ("cc", "gcc", "clang")

FLAGS = (
    "-std=c99",
    "-pedantic",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Wfloat-conversion",
    "-Werror",
    "-ffp-contract=off",
)
"""What emitted C compiles with, and without a warning."""


def compiler() -> str | None:
    """The path of a C compiler; None if there is none."""
    return next(filter(None, map(shutil.which, COMPILERS)), None)


class Library(Loaded):
    """The monitors of some emitted files, compiled by `compiler`, and a `guard`. Raises CompilerError, ScratchError."""

    def __init__(self, files: Files, path: str, guard: GuardFiles | None = None) -> None:
        with scratch() as folder:
            functions = _load(files, folder, path, guard)
        super().__init__(functions, list(files.samples.group_of), list(files.samples.heard))


def _load(files: Files, folder: Path, path: str, guard: GuardFiles | None) -> Any:
    """Compile in a child, whose time and memory are bounded."""
    texts = {f"{files.stem}.h": files.header, f"{files.stem}.c": files.source}
    texts |= {} if guard is None else guard.texts
    glue = _glue(files) if guard is None else (*_glue(files), *_glue_of(guard, files))
    for name, text in {**texts, "gate.c": "\n".join(glue)}.items():
        (folder / name).write_text(text, encoding="utf-8")
    sources = [name for name in (*texts, "gate.c") if name.endswith(".c")]
    return load([path, *FLAGS, "-O1", "-fPIC", "-shared", *sources, "-o", LIBRARY, "-lm"], folder)


def _glue(files: Files) -> Iterator[str]:
    """Functions with the same names and types whatever was emitted."""
    prefix, header = files.prefix, files.header
    stem = prefix if files.table is None else f"{prefix}_{files.table.stem}"
    judge = f"{prefix}_monitors" if files.table is None else stem
    yield f'#include "{files.stem}.h"'
    yield "size_t gate_size(int which);"
    yield f"size_t gate_size(int which) {{ return which == 0 ? sizeof({judge}) : sizeof({prefix}_samples); }}"
    yield f"void gate_clear({prefix}_samples *s) {{ *s = ({prefix}_samples){{0}}; }}"
    yield f"void gate_init({judge} *m) {{ {stem}_init(m); }}"
    for name in ("begin", "advance"):
        call = (
            f"return {stem}_{name}(m, time);"
            if f"bool {stem}_{name}(" in header
            else "return m != 0 && time > INT64_MIN;"
        )
        yield f"bool gate_{name}({judge} *m, int64_t time) {{ {call} }}"
    has_deadline = f"{stem}_next_deadline(" in header
    call = f"{stem}_next_deadline(m)" if has_deadline else f"m == 0 ? 0 : {prefix.upper()}_NEVER"
    yield f"int64_t gate_next_deadline(const {judge} *m) {{ return {call}; }}"
    yield f"void gate_set({prefix}_samples *s, int number, const void *value, size_t length)"
    yield "{ (void)length; (void)value; switch (number) {"
    for number, (signal, group) in enumerate(files.samples.group_of.items()):
        field, type_ = files.samples.fields[signal], type_of(signal)
        if type_.is_array:
            yield f"case {number}: s->{field}.elements = value; s->{field}.length = length;"
        else:
            yield f"case {number}: s->{field} = *({pointer(type_)})value;"
        yield f"s->has_{group.name} = true; break;"
    for number, heard in enumerate(files.samples.heard.values(), len(files.samples.group_of)):
        if heard.has_flag:
            yield f"case {number}: s->{heard.name} = true; break;"
    yield "default: (void)s; break; } }"
    match files.table:
        case None:
            yield from _of_monitors(prefix)
        case Table() as table:
            yield from _of_table(prefix, table)
        case OpenTable() as table:
            yield from _of_instances(prefix, table)


def _glue_of(guard: GuardFiles, files: Files) -> Iterator[str]:
    """The guards beside them, which share properties; decisions are numbers, and so are topics."""
    own, samples = guard.prefix, f"const {files.prefix}_samples *s"
    yield f'#include "{guard.stem}.h"'
    yield f"size_t gate_guard_size(void); size_t gate_guard_size(void) {{ return sizeof({own}_run); }}"
    yield f"void gate_guard_init({own}_run *g); void gate_guard_init({own}_run *g) {{ {own}_init(g); }}"
    head = f"bool gate_guard_lost(const {own}_run *g)"
    yield f"{head}; {head} {{ return g->has_lost; }}"
    for head, call in (
        (f"int gate_guard_act({own}_run *g, int64_t time)", f"{own}_act(g, time)"),
        (f"int64_t gate_guard_due(const {own}_run *g)", f"{own}_due(g)"),
    ):
        is_there = f"{call.split('(')[0]}(" in guard.header
        unused = "(void)g, (void)time, 0" if "time" in head else f"(void)g, {files.prefix.upper()}_NEVER"
        yield f"{head}; {head} {{ return {f'({head.split()[0]}){call}' if is_there else unused}; }}"
    hearing = [f"{own}_hear_{name}" for name in guard.others.values()]
    for name, called in (("command", guard.commands.values()), ("hear", hearing)):
        head = f"int gate_guard_{name}({own}_run *g, int64_t time, {samples}, int topic)"
        cases = (f"case {n}: return (int){function}(g, time, s);" for n, function in enumerate(called))
        yield f"{head}; {head}"
        yield f"{{ (void)g; (void)time; (void)s; switch (topic) {{ {' '.join(cases)} default: return -1; }} }}"


def _of_monitors(prefix: str) -> Iterator[str]:
    """Steps of all properties, and what is known of each."""
    yield f"bool gate_step({prefix}_monitors *m, int64_t time, const {prefix}_samples *s)"
    yield f"{{ return {prefix}_step(m, time, s); }}"
    yield f"void gate_show(const {prefix}_monitors *m, int property, int64_t *shown) {{"
    yield f"const {prefix}_property p = ({prefix}_property)property; shown[0] = (int64_t){prefix}_verdict_of(m, p);"
    yield f"shown[1] = {prefix}_steps_of(m, p); shown[2] = {prefix}_invalid_of(m, p);"
    yield f"shown[3] = {prefix}_since_of(m, p); }}"


def _of_table(prefix: str, table: Table) -> Iterator[str]:
    """Steps of all ids, if there are any, and of one; what is known of all, and of one."""
    share = f"{prefix}_ids_share(t, time, s)" if table.shared else "t == 0 && time == 0 && s == 0"
    yield f"bool gate_step({prefix}_ids *t, int64_t time, const {prefix}_samples *s) {{ return {share}; }}"
    yield f"bool gate_step_of({prefix}_ids *t, int64_t time, int64_t id, const {prefix}_samples *s)"
    yield f"{{ return {prefix}_ids_step(t, time, ({table.key})id, s); }}"
    yield f"void gate_show(const {prefix}_ids *t, int property, int64_t *shown)"
    yield f"{{ shown[0] = (int64_t){prefix}_ids_verdict(t); shown[1] = {prefix}_left_out_of(t);"
    yield "shown[2] = shown[3] = property; }"
    yield f"bool gate_show_of(const {prefix}_ids *t, int64_t id, int64_t *shown) {{"
    yield f"const {prefix}_slice *const one = {prefix}_slice_of(t, ({table.key})id); if (one == 0) {{ return false; }}"
    yield f"const {prefix}_property p = ({prefix}_property)0;"
    yield f"shown[0] = (int64_t){prefix}_verdict_of(&one->monitors, p);"
    yield f"shown[1] = {prefix}_since_of(&one->monitors, p); return true; }}"


def _of_instances(prefix: str, table: OpenTable) -> Iterator[str]:
    """Steps of all instances; the verdict of all, how many are violated, and how many owe something.

    By number, how many found no place, were no step, and since when the property is violated.
    """
    yield f"bool gate_step({prefix}_instances *t, int64_t time, const {prefix}_samples *s)"
    yield f"{{ return {prefix}_instances_step(t, time, s); }}"
    yield f"void gate_show(const {prefix}_instances *t, int property, int64_t *shown)"
    yield f"{{ shown[0] = (int64_t){prefix}_instances_verdict(t); shown[1] = t->violated; shown[2] = 0;"
    yield "for (uint32_t i = 0; i < t->count; i++) {"
    yield f"if (t->open[i].monitors.{table.writer.name}.verdict == {prefix.upper()}_PRESUMABLY_VIOLATED)"
    yield "{ shown[2] += 1 + t->open[i].more; } }"
    yield "shown[3] = property == 0 ? t->left_out : property == 1 ? t->no_step : t->first.since; }"
