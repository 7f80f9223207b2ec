"""`ltlc.build`: monitors, judged by the gate, then a ROS 2 node or another output, as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from os import PathLike
from pathlib import Path

from ltlc.backends import FILE_NAMES
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.errors import UnusableInput
from ltlc.base.files import write_all
from ltlc.base.limits import Budget
from ltlc.base.nearest import did_you_mean
from ltlc.dataclass import dataclass
from ltlc.interfaces.api.prepare import Text, encoding_of, folders, prepare, read
from ltlc.interfaces.building.build import Built, TooLargeError
from ltlc.interfaces.building.build import build as build_judged
from ltlc.interfaces.building.targets import Target, UnfitError, target_of


@dataclass(frozen=True)
class Build:
    """An output that passed the gate: `files` by their paths, and other `diagnostics`.

    `judgements` has for each property, by its label, the size of its monitor and what was checked.
    """

    diagnostics: tuple[Diagnostic, ...]
    judgements: Mapping[str, str]
    files: Mapping[Path, str | bytes]
    _built: Built

    @property
    def text(self) -> str:
        """The text of the first file, which is the only one but of `c`, `ament` and `tests`."""
        first = next(iter(self.files.values()))
        assert isinstance(first, str)
        return first

    @cached_property
    def certificates(self) -> str:
        """The monitors' certificates, for `ltlc certify`. Raises UnusableInput if they are too large for it."""
        try:
            return self._built.certificates()
        except TooLargeError as error:
            raise UnusableInput((), str(error)) from None

    def __str__(self) -> str:
        note = [self._built.made.note] if self._built.made.note else []
        return "\n".join([*(f"{label}: {told}" for label, told in self.judgements.items()), *note])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        from ltlc.interfaces.api.display import build_html

        return build_html(self.judgements, self._built.compiled)

    def write(self) -> list[Path]:
        """Write all the files or none, and say which. Raises OSError."""
        self._built.target.refuse()
        write_all(self.files)
        return list(self.files)


def build(
    specification: Text,
    target: str = "ros2",
    *,
    output: str | PathLike[str] | None = None,
    encoding: str = "episode",
    message_paths: Sequence[str | PathLike[str]] = (),
    budget: Budget | None = None,
) -> Build:
    """The output of `specification` for a target: `ros2`, `ament`, `python`, `c`, `rust`, `hoa`, `dot`, `json` or
    `tests`.

    >>> import ltlc
    >>> built = ltlc.build("slow: never robot.velocity > 2", "hoa")
    >>> built.text.splitlines()[0]
    'HOA: v1'
    >>> sorted(map(str, built.files))
    ['specification.hoa']

    A `str` is the text of a specification, a `pathlib.Path` a file, after which the output is called unless there is
    an `output`. Nothing is written before `write` is called. `budget` is what the translation of each property may use;
    judging it, six times the seconds. The analyses of `check` are not made.

    Raises UnusableInput if the text has errors, a property has no form in the target, or the gate finds fault with one,
    which the diagnostics tell; and SpotMissing.
    """
    if target not in FILE_NAMES:
        hint = did_you_mean(str(target), FILE_NAMES) or f"the targets are {', '.join(FILE_NAMES)}"
        raise UnusableInput((), f"there is no target `{target}`: {hint}")
    paths, budget = folders(message_paths), budget or Budget()
    prepared = prepare(read(specification), paths, encoding_of(encoding), budget)
    stem = Path(prepared.specification.source.name).stem
    made_for = target_of(target, None if output is None else Path(output), stem)
    try:
        built = build_judged(prepared.specification, prepared.compiled, made_for, paths, budget)
    except UnfitError as error:
        raise UnusableInput(error.diagnostics) from None
    if failures := built.failures():
        raise UnusableInput(failures)
    return Build(prepared.diagnostics, dict(built.summaries()), _files(made_for, built), built)


def _files(target: Target, built: Built) -> Mapping[Path, str | bytes]:
    """The output. Raises UnusableInput if it depends on what stands in its place, and that cannot be."""
    try:
        return built.made.files()
    except OSError as error:
        raise UnusableInput((), f"{target.told[0]} cannot be written: {error.strerror or error}") from None
