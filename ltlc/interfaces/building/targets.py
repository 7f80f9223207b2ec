"""What is made for each target: code that the gate judges, and the files that are written."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from ltlc import backends
from ltlc.assurance.messages import Messages
from ltlc.assurance.programs import Monitored, Program, programs
from ltlc.assurance.reading.outcomes import Difference, Written
from ltlc.assurance.told_runs import told_runs
from ltlc.backends.spelling import NotInTargetError
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.files import refuse_unwritable
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.program.guards import GuardProgram
from ltlc.specification.specification import Specification

if TYPE_CHECKING:
    from ltlc.backends import c
    from ltlc.backends.ament.metadata import Metadata

_NODE = "ROS 2"


@dataclass(frozen=True)
class Unit:
    """What one output is made of: the properties of `specification` that it monitors, and what its guards run."""

    specification: Specification
    compiled: Sequence[Compiled]
    messages: Messages
    guards: Sequence[GuardProgram] = ()


@dataclass(frozen=True)
class Made:
    """The code of each property, as what can be run and as text, None where there is none; and what comes of it.

    `written` parses the text, which takes time, once for each process that asks. `files` makes the files, by their
    paths, once the code has been judged; `note` is to be said with them. Those `beside` are of a guard, of which `flaw`
    finds what its code does otherwise than it should.
    """

    programs: Sequence[Program] | None
    written: Callable[[], Sequence[Written | Difference]] | None
    files: Callable[[], Mapping[Path, str | bytes]]
    note: str = ""
    beside: Sequence[Path] = ()
    flaw: Callable[[], str | None] = lambda: None


class UnfitError(Exception):
    """Properties that the target cannot express; `diagnostics` say which, and why."""

    def __init__(self, diagnostics: Sequence[Diagnostic]) -> None:
        super().__init__("the target does not support some of the properties")
        self.diagnostics = diagnostics


class Target(Protocol):
    """Where output goes to, and how it is made; `told` are the paths that are named once it is written."""

    @property
    def name(self) -> str:
        """What it is called."""
        ...

    @property
    def told(self) -> Sequence[Path]:
        """The message about what was written."""
        ...

    def refuse(self) -> None:
        """Raise OSError if the output cannot be written."""
        ...

    def make(self, unit: Unit) -> Made:
        """The code, that of the guards included if the target has guards. Raises UnfitError."""
        ...


def target_of(name: str, output: Path | None, stem: str) -> Target:
    """The target called `name`; without an `output`, it goes to where the file `STEM.txt` suggests."""
    path = output or Path(backends.FILE_NAMES[name].format(stem=stem))
    match name:
        case "c":
            return _C(path)
        case "rust":
            return _Rust(path)
        case "ament":
            return _Package(path)
        case "tests":
            from ltlc.interfaces.building.runs import Tests  # takes time, as what writes recordings does

            return Tests(path)
        case _:
            return _Text(name, path)


@dataclass(frozen=True)
class _Text:
    """One file."""

    name: str
    path: Path

    @property
    def told(self) -> Sequence[Path]:
        return [self.path]

    def refuse(self) -> None:
        refuse_unwritable(self.path)

    def make(self, unit: Unit) -> Made:
        try:
            text = backends.emit(self.name, unit.compiled, unit.specification, unit.guards)
        except NotInTargetError:
            emit = partial(backends.emit, self.name)
            raise UnfitError(_unfit(_NODE if self.name == "ros2" else self.name.capitalize(), emit, unit)) from None
        code = programs(self.name, text, unit.compiled, unit.specification, unit.messages)
        read = None if code is None else cache(partial(_written, text, unit))
        return Made(code, read, lambda: {self.path: text})


def _written(text: str, unit: Unit) -> Sequence[Written | Difference]:
    from ltlc.assurance.reading.files import written  # takes time, and is asked for in a child

    compiled = unit.compiled
    return written(text, [each.machine for each in compiled], [each.specification for each in compiled], unit.guards)


@dataclass(frozen=True)
class _C:
    """A source file in C, its header, and one that wraps it for C++."""

    path: Path
    name = "c"

    @property
    def told(self) -> Sequence[Path]:
        return [self.path, *(self.path.parent / f"{self.path.stem}{suffix}" for suffix in (".h", ".hpp"))]

    def refuse(self) -> None:
        if self.path.suffix != ".c":
            raise OSError("the name of a C source file must end in .c")
        for path in self.told:
            refuse_unwritable(path)

    def make(self, unit: Unit) -> Made:
        from ltlc.assurance.c_programs import c_programs  # takes time, as what reads C does
        from ltlc.assurance.reading.c.files import written as written_in_c
        from ltlc.backends import c

        specification, compiled = unit.specification, unit.compiled
        try:
            files = c.emit(compiled, specification, self.path.stem)
        except NotInTargetError:
            raise UnfitError(_unfit("C", c.emit, unit)) from None
        texts = dict(zip(self.told, (files.source, files.header, files.wrapper), strict=True))
        own = (specification.rate, specification.timeout)
        made = Made(
            c_programs(files, compiled, specification, unit.messages),
            cache(partial(written_in_c, files.header, files.source, compiled, *own)),
            lambda: texts,
            f"worst case: {files.bound}",
        )
        return self._guarded(made, files, unit) if unit.guards else made

    def _guarded(self, made: Made, files: c.Files, unit: Unit) -> Made:
        """With the files of guards. Raises UnfitError."""
        from ltlc.assurance.c_guard import flaw
        from ltlc.backends.c.guards import emit

        specification = unit.specification
        try:
            emitted = emit(files, unit.guards)
        except NotInTargetError as error:
            message = f"the guard of `{specification.guards[0].out}` cannot be written in C: it has {error}"
            span = specification.guards[0].span
            help = "nothing was written; to emit the monitors alone, build the properties from a file without a guard"
            raise UnfitError([diagnostic("LTL708", specification.source, span, message, help=help)]) from None
        texts = {self.path.with_name(name): text for guard in emitted for name, text in guard.texts.items()}
        return replace(
            made,
            files=lambda: {**made.files(), **texts},
            note="; ".join(
                [made.note, *(f"{each.bound} a call of the guard of {' and '.join(each.commands)}" for each in emitted)]
            ),
            beside=[*texts],
            flaw=lambda: flaw(files, emitted, unit.guards, unit.compiled, specification, unit.messages),
        )


@dataclass(frozen=True)
class _Rust:
    """A module in Rust."""

    path: Path
    name = "rust"

    @property
    def told(self) -> Sequence[Path]:
        return [self.path]

    def refuse(self) -> None:
        refuse_unwritable(self.path)

    def make(self, unit: Unit) -> Made:
        from ltlc.assurance.c_programs import rust_programs  # takes time, as what reads Rust does
        from ltlc.assurance.reading.rust import written as written_in_rust
        from ltlc.backends import rust

        specification, compiled = unit.specification, unit.compiled
        try:
            file = rust.file_of(compiled, specification)
        except NotInTargetError:
            raise UnfitError(_unfit("Rust", rust.emit, unit)) from None
        own = (specification.rate, specification.timeout)
        read = cache(partial(written_in_rust, file.text, file.c.header, file.c.source, compiled, *own))
        return Made(rust_programs(file, compiled, specification, unit.messages), read, lambda: {self.path: file.text})


def _unfit(language: str, emit: Callable[[Sequence[Compiled], Specification], object], unit: Unit) -> list[Diagnostic]:
    """A diagnostic for each property that cannot be written in a language yet, or not beside the others."""
    specification, compiled = unit.specification, unit.compiled
    of_all = next((each for each in compiled if each.specification.slicing is not None), compiled[0])
    for tried in ([(each, [each]) for each in compiled], [(of_all, compiled)]):
        found = []
        for each, beside in tried:
            try:
                emit(beside, specification)
            except NotInTargetError as error:
                message = f"`{each.specification.label}` cannot be written in {language}: it has {error}"
                other = f"; {error.instead}" if error.instead else ""
                node = "" if language == _NODE else "; the target `ros2` supports it"
                help = f"nothing was written{other}{node}"
                found.append(diagnostic("LTL708", specification.source, each.specification.span, message, help=help))
        if found:
            break
    return found


@dataclass(frozen=True)
class _Package:
    """The folder of a package for colcon, whose node is that of the target `ros2`, taken apart."""

    path: Path
    name = "ament"

    @property
    def told(self) -> Sequence[Path]:
        return [self.path]

    @cached_property
    def metadata(self) -> Metadata:
        """The manifest of the package that is there. Raises OSError if something else is."""
        from ltlc.backends.ament.folder import earlier  # takes time, as what reads XML does

        return earlier(self.path)

    def refuse(self) -> None:
        _ = self.metadata

    def make(self, unit: Unit) -> Made:
        from ltlc.backends import ament

        node = _Text("ros2", self.path).make(unit)

        def files() -> Mapping[Path, str]:
            monitored = [each for each in node.programs or () if isinstance(each, Monitored)]
            runs = told_runs(unit.compiled, monitored, unit.messages)
            made = ament.emit(unit.compiled, unit.specification, runs, self.metadata, unit.guards)
            return {self.path / name: text for name, text in made.items()}

        return Made(node.programs, node.written, files)
