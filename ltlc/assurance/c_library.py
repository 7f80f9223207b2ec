"""Emitted C, compiled into a library that is loaded here, so that its monitors can be stepped.

The library is made of the files as they were emitted, and of some functions that set the fields of samples and read the
counters: only the compiler knows where in memory these are.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from errno import ENOSPC
from functools import partial
from pathlib import Path
from typing import Any

from ltlc.automata import Budget, Exceeded
from ltlc.backends.c import Files
from ltlc.backends.c.types import pointer
from ltlc.files import scratch
from ltlc.limits import run_all
from ltlc.program.types import Scalar, Type, type_of
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Signal

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

BUDGET = Budget(seconds=60.0, megabytes=2048)
"""What the compiler may use."""


class CompilerError(Exception):
    """The compiler does not accept what was emitted; the text is what it says."""


def compiler() -> str | None:
    """The path of a C compiler; None if there is none."""
    return next(filter(None, map(shutil.which, COMPILERS)), None)


class Library:
    """The monitors of some emitted files, compiled by `compiler`. Raises CompilerError, ScratchError."""

    def __init__(self, files: Files, path: str) -> None:
        self._files = files
        with scratch() as folder:
            self._library: Any = _load(files, folder, path)
        for name in ("begin", "step", "advance", "next_deadline"):
            function = getattr(self._library, f"gate_{name}")
            function.restype = ctypes.c_int64 if name == "next_deadline" else ctypes.c_bool
            function.argtypes = [ctypes.c_void_p, *([ctypes.c_int64] if name != "next_deadline" else [])]
        self._library.gate_step.argtypes.append(ctypes.c_void_p)
        self._library.gate_step.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p]
        self._library.gate_set.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p, ctypes.c_size_t]
        self._library.gate_show.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.POINTER(ctypes.c_int64)]
        self.numbers = {signal: number for number, signal in enumerate(files.samples.group_of)}

    def monitors(self) -> Monitors:
        """All monitors before a run."""
        return Monitors(self, self._library)


class Monitors:
    """The monitors of a library in one run."""

    def __init__(self, library: Library, functions: Any) -> None:
        self._numbers = library.numbers
        self._files = library._files
        self._functions = functions
        self._self = ctypes.create_string_buffer(functions.gate_size(0))
        self._samples = ctypes.create_string_buffer(functions.gate_size(1))
        self._shown = (ctypes.c_int64 * 4)()
        self._alive: list[Any] = []
        functions.gate_init(self._self)

    def begin(self, time: int) -> bool:
        """The session begins."""
        return bool(self._functions.gate_begin(self._self, time))

    def step(self, time: int, sample: dict[Signal, Value], topics: Sequence[str]) -> bool:
        """Messages have come on `topics`, with these values."""
        ctypes.memset(self._samples, 0, len(self._samples))
        for signal, value in sample.items():
            if signal in self._numbers:
                memory, length = _memory(type_of(signal), value)
                self._alive.append((memory, value))
                self._functions.gate_set(self._samples, self._numbers[signal], ctypes.byref(memory), length)
        for number, topic in enumerate(self._files.samples.heard, len(self._numbers)):
            if topic in topics:
                self._functions.gate_set(self._samples, number, None, 0)
        return bool(self._functions.gate_step(self._self, time, self._samples))

    def advance(self, time: int) -> bool:
        """It is `time` now."""
        return bool(self._functions.gate_advance(self._self, time))

    def next_deadline(self) -> int:
        """When there is something to do next."""
        return int(self._functions.gate_next_deadline(self._self))

    def show(self, number: int) -> tuple[int, int, int, int]:
        """Verdict, steps, invalid steps, and when the verdict came, of the property with this number."""
        self._functions.gate_show(self._self, number, self._shown)
        verdict, steps, invalid, since = self._shown
        return verdict, steps, invalid, since


def _memory(type_: Type, value: Value) -> tuple[Any, int]:
    """A value as C has it, and how many elements it has."""
    kind = _ctype(type_)
    if not type_.is_array:
        return kind(_converted(type_, value)), 0
    assert isinstance(value, tuple)
    return (kind * max(1, len(value)))(*(_converted(type_, each) for each in value)), len(value)


def _ctype(type_: Type) -> Any:
    return _CTYPES.get(type_.scalar) or getattr(ctypes, f"c_{type_.scalar.value}")


_CTYPES: dict[Scalar, Any] = {
    Scalar.DOUBLE: ctypes.c_double,
    Scalar.SINGLE: ctypes.c_float,
    Scalar.BOOL: ctypes.c_bool,
    Scalar.TEXT: ctypes.c_char_p,
}


def _converted(type_: Type, value: Any) -> Any:
    if type_.scalar.is_integer:
        return int(value)
    return value.encode() if isinstance(value, str) else value


def _load(files: Files, folder: Path, path: str) -> Any:
    """Compile in a child, whose time and memory are bounded."""
    stem = files.stem
    (folder / f"{stem}.h").write_text(files.header, encoding="utf-8")
    (folder / f"{stem}.c").write_text(files.source, encoding="utf-8")
    (folder / "gate.c").write_text("\n".join(_glue(files)), encoding="utf-8")
    library = folder / "emitted.so"
    command = [path, *FLAGS, "-O1", "-fPIC", "-shared", f"{stem}.c", "gate.c", "-o", library.name, "-lm"]
    (said,) = run_all([partial(_run, command, folder)], BUDGET)
    if isinstance(said, str) and os.strerror(ENOSPC) in said:
        raise OSError(ENOSPC, os.strerror(ENOSPC), os.fspath(folder))
    if isinstance(said, Exceeded) or said or not library.exists():
        raise CompilerError(str(said) or "nothing was made")
    return ctypes.CDLL(os.fspath(library))


def _run(command: Sequence[str], folder: Path) -> str:
    """What the command says; nothing if all is well."""
    environment = {**os.environ, "LC_ALL": "C"}
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, env=environment)
    return done.stderr or ("" if done.returncode == 0 else f"the compiler ends with {done.returncode}")


def _glue(files: Files) -> Iterator[str]:
    """Functions with the same names and types whatever was emitted."""
    prefix, header = files.prefix, files.header
    yield f'#include "{files.stem}.h"'
    yield "size_t gate_size(int which);"
    yield f"size_t gate_size(int which) {{ return which == 0 ? sizeof({prefix}_monitors) : sizeof({prefix}_samples); }}"
    yield f"void gate_init({prefix}_monitors *m);"
    yield f"void gate_init({prefix}_monitors *m) {{ {prefix}_init(m); }}"
    for name in ("begin", "advance"):
        call = (
            f"return {prefix}_{name}(m, time);" if f"bool {prefix}_{name}(" in header else "return m != 0 && time >= 0;"
        )
        yield f"bool gate_{name}({prefix}_monitors *m, int64_t time);"
        yield f"bool gate_{name}({prefix}_monitors *m, int64_t time) {{ {call} }}"
    has_deadline = f"{prefix}_next_deadline(" in header
    call = f"{prefix}_next_deadline(m)" if has_deadline else f"m == 0 ? 0 : {prefix.upper()}_NEVER"
    yield f"int64_t gate_next_deadline(const {prefix}_monitors *m);"
    yield f"int64_t gate_next_deadline(const {prefix}_monitors *m) {{ return {call}; }}"
    yield f"bool gate_step({prefix}_monitors *m, int64_t time, const {prefix}_samples *s);"
    yield f"bool gate_step({prefix}_monitors *m, int64_t time, const {prefix}_samples *s)"
    yield f"{{ return {prefix}_step(m, time, s); }}"
    yield f"void gate_set({prefix}_samples *s, int number, const void *value, size_t length);"
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
    yield f"void gate_show(const {prefix}_monitors *m, int property, int64_t *shown);"
    yield f"void gate_show(const {prefix}_monitors *m, int property, int64_t *shown) {{"
    yield f"const {prefix}_property p = ({prefix}_property)property; shown[0] = (int64_t){prefix}_verdict_of(m, p);"
    yield f"shown[1] = {prefix}_steps_of(m, p); shown[2] = {prefix}_invalid_of(m, p);"
    yield f"shown[3] = {prefix}_since_of(m, p); }}"
