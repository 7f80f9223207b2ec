"""Emitted Rust, compiled into a library that is loaded here, so that its monitors can be replayed."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

from ltlc.assurance.library import LIBRARY, Loaded, load
from ltlc.backends.c.ids import Table
from ltlc.backends.c.instances import OpenTable
from ltlc.backends.rust import File
from ltlc.backends.rust.types import SCALARS, scalar_text, type_text
from ltlc.base.files import scratch
from ltlc.program.types import Scalar, Type, type_of


def compiler() -> str | None:
    """The path of a compiler; None if there is none."""
    return shutil.which("rustc")


class RustLibrary(Loaded):
    """The monitors of an emitted file, compiled by `compiler`. Raises CompilerError, ScratchError."""

    def __init__(self, file: File, path: str) -> None:
        with scratch() as folder:
            (folder / "emitted.rs").write_text(file.text, encoding="utf-8")
            (folder / "gate.rs").write_text("\n".join(_glue(file)), encoding="utf-8")
            flags = ["--edition=2021", "--crate-type=cdylib", "-Copt-level=1", "-Coverflow-checks=on"]
            functions = load([path, *flags, "gate.rs", "-o", LIBRARY], Path(folder))
        super().__init__(functions, list(file.c.samples.group_of), list(file.c.samples.heard))


def _glue(file: File) -> Iterator[str]:
    """Functions with the same names and types whatever was emitted."""
    lifetime = "<'static>" if file.borrows else ""
    judge = "Monitors" if file.c.table is None else file.c.table.stem.capitalize()
    monitors, samples = f"{judge}{lifetime}", f"Samples{lifetime}"
    yield "#![deny(warnings)]"
    yield "pub mod emitted;"
    yield f"use emitted::{{{judge}, Property, Samples}};"
    yield "use std::ffi::{c_void, CStr};"
    yield "use std::os::raw::{c_char, c_int};"
    yield "pub unsafe fn text(value: *const c_char) -> &'static str { CStr::from_ptr(value).to_str().unwrap() }"
    for head, body in (
        ("gate_size(which: c_int) -> usize", f"[size_of::<{monitors}>(), size_of::<{samples}>()][which as usize]"),
        (f"gate_clear(s: *mut {samples})", "s.write(Samples::default())"),
        # A table may be too large for the stack.
        (f"gate_init(m: *mut {monitors})", f"static NEW: {monitors} = {judge}::new(); m.copy_from(&NEW, 1)"),
        (f"gate_begin(m: *mut {monitors}, time: i64) -> bool", _call(file, "begin", "time", "time > i64::MIN")),
        (f"gate_advance(m: *mut {monitors}, time: i64) -> bool", "(*m).advance(time)"),
        (f"gate_next_deadline(m: *const {monitors}) -> i64", _call(file, "next_deadline", "", "emitted::NEVER")),
        (f"gate_set(s: *mut {samples}, number: c_int, value: *const c_void, length: usize)", _set(file)),
        *_steps(file, monitors, samples),
    ):
        yield f'#[no_mangle] pub unsafe extern "C" fn {head} {{ {body.replace("size_of", "std::mem::size_of")} }}'


def _call(file: File, name: str, arguments: str, otherwise: str) -> str:
    """A call of a function that may be missing, or its result in that case."""
    table = file.c.table
    has_it = table is None or f" {file.c.prefix}_{table.stem}_{name}(" in file.c.header
    return f"(*m).{name}({arguments})" if has_it else f"let _ = m; {otherwise}"


def _steps(file: File, monitors: str, samples: str) -> Iterator[tuple[str, str]]:
    """What takes samples, and shows what is known then: the numbers that `c_library` shows."""
    step = f"gate_step(m: *mut {monitors}, time: i64, s: *const {samples}) -> bool"
    show = f"gate_show(m: *const {monitors}, property: c_int, shown: *mut i64)"
    judged = "let told = one.judgement(Property::ALL[0]);"
    match file.c.table:
        case None:
            yield step, "(*m).step(time, &*s)"
            told = "let told = (*m).judgement(Property::ALL[property as usize]);"
            yield show, f"{told} {_shown('told.verdict', 'told.steps', 'told.invalid', 'told.since')}"
        case Table(key=key, is_shared=is_shared):
            id_ = f"id as {scalar_text(SCALARS[key])}"
            yield step, "(*m).share(time, &*s)" if is_shared else "let _ = (m, time, s); false"
            given = f"m: *mut {monitors}, time: i64, id: i64, s: *const {samples}"
            yield f"gate_step_of({given}) -> bool", f"(*m).step(time, {id_}, &*s)"
            yield show, f"let _ = property; {_shown('(*m).verdict()', '(*m).left_out')}"
            known = f"let one = &slice.monitors; {judged} {_shown('told.verdict', 'told.since')} true"
            of = f"match (*m).slice_of({id_}) {{ None => false, Some(slice) => {{ {known} }} }}"
            yield f"gate_show_of(m: *const {monitors}, id: i64, shown: *mut i64) -> bool", of
        case OpenTable():
            yield step, "(*m).step(time, &*s)"
            owed = "if told.verdict == emitted::Verdict::PresumablyViolated { owing += 1 + i64::from(open.more); }"
            owing = f"for open in &(&(*m).open)[..(*m).count as usize] {{ let one = &open.monitors; {judged} {owed} }}"
            number = "[i64::from((*m).left_out), i64::from((*m).no_step), (*m).first.since][property as usize]"
            shown = _shown("(*m).verdict()", "(*m).violated", "owing", number)
            yield show, f"let mut owing = 0i64; {owing} {shown}"


def _shown(*numbers: str) -> str:
    """What writes numbers where they are shown."""
    return " ".join(f"*shown.add({place}) = ({number}) as i64;" for place, number in enumerate(numbers))


def _set(file: File) -> str:
    """What sets the field with a number."""
    given = file.c.samples
    cases = [
        f"{number} => (*s).{file.fields[name]} = Some({_value(type_of(signal))}),"
        for number, (signal, name) in enumerate(given.fields.items())
    ]
    flags = [
        f"{number} => (*s).{file.fields[heard.name]} = true,"
        for number, heard in enumerate(given.heard.values(), len(cases))
        if heard.has_flag
    ]
    return f"let _ = (s, value, length); match number {{ {' '.join([*cases, *flags])} _ => {{}} }}"


def _value(type_: Type) -> str:
    """A value as Python gives it: strings end with NUL, and what lies elsewhere is never freed."""
    if not type_.is_array and type_.scalar is not Scalar.TEXT:
        return f"*(value as *const {type_text(type_)})"
    if not type_.is_array:
        return "text(*(value as *const *const c_char))"
    if type_.scalar is not Scalar.TEXT:
        return f"std::slice::from_raw_parts(value as *const {type_text(type_.element)}, length)"
    texts = "std::slice::from_raw_parts(value as *const *const c_char, length)"
    return f"Box::leak({texts}.iter().map(|each| text(*each)).collect())"
