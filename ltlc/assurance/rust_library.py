"""Emitted Rust, compiled into a library that is loaded here, so that its monitors can be replayed."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

from ltlc.assurance.library import LIBRARY, Loaded, load
from ltlc.backends.rust import File
from ltlc.backends.rust.types import type_text
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
    monitors, samples = f"Monitors{lifetime}", f"Samples{lifetime}"
    yield "#![deny(warnings)]"
    yield "pub mod emitted;"
    yield "use emitted::{Monitors, Property, Samples};"
    yield "use std::ffi::{c_void, CStr};"
    yield "use std::os::raw::{c_char, c_int};"
    yield "pub unsafe fn text(value: *const c_char) -> &'static str { CStr::from_ptr(value).to_str().unwrap() }"
    for head, body in (
        ("gate_size(which: c_int) -> usize", f"[size_of::<{monitors}>(), size_of::<{samples}>()][which as usize]"),
        (f"gate_clear(s: *mut {samples})", "s.write(Samples::default())"),
        (f"gate_init(m: *mut {monitors})", "m.write(Monitors::new())"),
        (f"gate_begin(m: *mut {monitors}, time: i64) -> bool", "(*m).begin(time)"),
        (f"gate_advance(m: *mut {monitors}, time: i64) -> bool", "(*m).advance(time)"),
        (f"gate_next_deadline(m: *const {monitors}) -> i64", "(*m).next_deadline()"),
        (f"gate_step(m: *mut {monitors}, time: i64, s: *const {samples}) -> bool", "(*m).step(time, &*s)"),
        (f"gate_set(s: *mut {samples}, number: c_int, value: *const c_void, length: usize)", _set(file)),
        (f"gate_show(m: *const {monitors}, property: c_int, shown: *mut i64)", _SHOW),
    ):
        yield f'#[no_mangle] pub unsafe extern "C" fn {head} {{ {body.replace("size_of", "std::mem::size_of")} }}'


_SHOW = """
let told = (*m).judgement(Property::ALL[property as usize]);
let numbers = [told.verdict as i64, i64::from(told.steps), i64::from(told.invalid), told.since];
shown.copy_from_nonoverlapping(numbers.as_ptr(), 4);
"""


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
