"""Monitors that were emitted in a language that is compiled, in a library that is loaded here.

The library is made of the files as they were emitted, and of some functions that set the fields of samples and read the
counters: only the compiler knows where in memory these are.
"""

from __future__ import annotations

import ctypes
import os
import subprocess
from collections.abc import Sequence
from errno import ENOSPC
from functools import partial
from pathlib import Path
from typing import Any

from ltlc.automata import Budget, Exceeded
from ltlc.base.limits import run_all
from ltlc.program.types import Scalar, Type, type_of
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Signal

LIBRARY = "emitted.so"
"""What the compiler is to make, in its folder."""

BUDGET = Budget(seconds=60.0, megabytes=2048)
"""What the compiler may use."""


class CompilerError(Exception):
    """The compiler rejects what was emitted; the text is its message."""


class Loaded:
    """Monitors by the functions of a library, which knows fields by the places of `inputs`, then of topics `heard`."""

    def __init__(self, functions: Any, inputs: Sequence[Signal], heard: Sequence[str]) -> None:
        self.functions = functions
        self.numbers = {signal: number for number, signal in enumerate(inputs)}
        self.heard = heard
        for name in ("begin", "step", "advance", "next_deadline"):
            function = getattr(functions, f"gate_{name}")
            function.restype = ctypes.c_int64 if name == "next_deadline" else ctypes.c_bool
            function.argtypes = [ctypes.c_void_p, *([ctypes.c_int64] if name != "next_deadline" else [])]
        functions.gate_step.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p]
        functions.gate_set.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p, ctypes.c_size_t]
        functions.gate_show.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.POINTER(ctypes.c_int64)]

    def monitors(self) -> Monitors:
        """All monitors before a run."""
        return Monitors(self)


class Monitors:
    """The monitors of a library in one run."""

    def __init__(self, library: Loaded) -> None:
        self._numbers, self._heard = library.numbers, library.heard
        self._functions = functions = library.functions
        self._self = ctypes.create_string_buffer(functions.gate_size(0))
        self._samples = ctypes.create_string_buffer(functions.gate_size(1))
        self._shown = (ctypes.c_int64 * 4)()
        self._alive: list[Any] = []
        functions.gate_init(self._self)

    def memory(self) -> bytes:
        """All that they remember."""
        return bytes(self._self)

    def begin(self, time: int) -> bool:
        """The session begins."""
        return bool(self._functions.gate_begin(self._self, time))

    def step(self, time: int, sample: dict[Signal, Value], topics: Sequence[str]) -> bool:
        """Messages have come on `topics`, with these values."""
        self._fill(sample, topics)
        return bool(self._functions.gate_step(self._self, time, self._samples))

    def _fill(self, sample: dict[Signal, Value], topics: Sequence[str]) -> None:
        self._functions.gate_clear(self._samples)
        for signal, value in sample.items():
            if signal in self._numbers:
                memory, length = _memory(type_of(signal), value)
                self._alive.append((memory, value))
                self._functions.gate_set(self._samples, self._numbers[signal], ctypes.byref(memory), length)
        for number, topic in enumerate(self._heard, len(self._numbers)):
            if topic in topics:
                self._functions.gate_set(self._samples, number, None, 0)

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


def load(command: Sequence[str], folder: Path) -> Any:
    """The library that `command` makes in `folder`, in a child, whose time and memory are bounded."""
    library = folder / LIBRARY
    (said,) = run_all([partial(_run, command, folder)], BUDGET)
    if isinstance(said, str) and os.strerror(ENOSPC) in said:
        raise OSError(ENOSPC, os.strerror(ENOSPC), os.fspath(folder))
    if isinstance(said, Exceeded) or said or not library.exists():
        raise CompilerError(str(said) or "nothing was made")
    return ctypes.CDLL(os.fspath(library))


def _run(command: Sequence[str], folder: Path) -> str:
    """The message of the command; empty if all is well."""
    environment = {**os.environ, "LC_ALL": "C"}
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, env=environment)
    return done.stderr or ("" if done.returncode == 0 else f"the compiler ends with {done.returncode}")
