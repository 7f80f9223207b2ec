"""Emitted C and Rust as programs that can be replayed, in libraries that are compiled for that."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

from ltlc.assurance.c_library import Library, compiler
from ltlc.assurance.c_program import CProgram
from ltlc.assurance.c_table import InstancesProgram, TableProgram
from ltlc.assurance.compiled_program import Libraries
from ltlc.assurance.library import Loaded
from ltlc.assurance.messages import Messages
from ltlc.assurance.programs import Program
from ltlc.assurance.rust_library import RustLibrary
from ltlc.assurance.rust_library import compiler as rust_compiler
from ltlc.assurance.traffic import Settings
from ltlc.backends import rust
from ltlc.backends.c import Files, emit
from ltlc.backends.c.ids import Table
from ltlc.backends.c.instances import OpenTable
from ltlc.compiler import Compiled
from ltlc.specification.specification import Specification

Text = TypeVar("Text")
"""What is emitted for a compiled language."""


def c_programs(
    files: Files, compiled: Sequence[Compiled], specification: Specification, messages: Messages
) -> Sequence[Program] | None:
    """For each property the program that its part of emitted C is; None if there is no C compiler."""
    path = compiler()
    if path is None:
        return None

    def written(some: Sequence[Compiled], of: Specification) -> Files:
        return emit(some, of, files.stem)

    def program(libraries: Libraries, number: int, text: Files) -> Program:
        return _program(libraries, number, text, messages)

    return _in_libraries(files, compiled, specification, written, lambda of: Library(of, path), program)


def rust_programs(
    file: rust.File, compiled: Sequence[Compiled], specification: Specification, messages: Messages
) -> Sequence[Program] | None:
    """For each property the program that its part of emitted Rust is; None if there is no compiler for it."""
    path = rust_compiler()
    if path is None:
        return None

    def program(libraries: Libraries, number: int, text: rust.File) -> Program:
        return _program(libraries, number, text.c, messages)

    return _in_libraries(file, compiled, specification, rust.file_of, lambda of: RustLibrary(of, path), program)


def _program(libraries: Libraries, number: int, files: Files, messages: Messages) -> Program:
    """The property with a number, in what is equivalent to emitted C."""
    match files.table:
        case None:
            return CProgram(libraries, number, files)
        case Table():
            return TableProgram(libraries, number, files, messages)
        case OpenTable():
            return InstancesProgram(libraries, number, files)


def _in_libraries(
    text: Text,
    compiled: Sequence[Compiled],
    specification: Specification,
    written: Callable[[Sequence[Compiled], Specification], Text],
    loaded: Callable[[Text], Loaded],
    program: Callable[[Libraries, int, Text], Program],
) -> Sequence[Program]:
    """The programs in the library of `text`, and in those of what is written for other settings.

    A timeout begins with the first step of any property, which the replay of one does not see: each is alone then.
    """
    if specification.timeout is not None and len(compiled) > 1:
        alone = ([each] for each in compiled)
        parts = ((written(one, specification), one) for one in alone)
        return [p for of, one in parts for p in _in_libraries(of, one, specification, written, loaded, program)]
    own = Settings(specification.rate, specification.timeout)

    def library(settings: Settings) -> Loaded:
        changed = replace(specification, rate=settings.rate, timeout=settings.timeout)
        return loaded(text if settings == own else written(compiled, changed))

    made = Libraries(library, own)
    return [program(made, number, text) for number in range(len(compiled))]
