"""From a text or a file to monitors of runs, or an exception that says why there are none."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from ltlc.analysis.examine import examine_loaded
from ltlc.automata.batch import Known
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget, Watch
from ltlc.base.nearest import did_you_mean
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.frontend.language import load_text, read_source
from ltlc.frontend.language.suppression import suppress, unsuppressed
from ltlc.semantics.encodings import ENCODINGS, Encoding
from ltlc.specification.specification import Specification

if TYPE_CHECKING:
    from ltlc.compiler import Compiled

Text = str | PathLike[str]
"""A specification: a `str` is its text, a path (`pathlib.Path`) the file that it is in."""

NAME = "specification"
"""What a text is called that is in no file."""

FILES = (".txt", ".ltlc")
"""How a `str` ends that was meant as the name of a file."""


@dataclass(frozen=True)
class Prepared:
    """A specification with its monitors, each made within `budget`, and further findings.

    Properties that were not chosen are `left_out`: they are in the text, and nowhere else.
    """

    specification: Specification
    compiled: Sequence[Compiled]
    diagnostics: tuple[Diagnostic, ...]
    budget: Budget
    left_out: tuple[str, ...] = ()

    def only(self, labels: Sequence[str]) -> Prepared:
        """The same with the properties called so only; with all of them, if there are no `labels`.

        That of a `forall` is the label of all that it stands for. Raises UnusableInput for one that no property has.
        """
        known = [each.label for each in self.specification.properties]
        chosen = set() if labels else set(known)
        for label in labels:
            meant = {each for each in known if label in (each, each.partition("[")[0])}
            if not meant:
                hint = did_you_mean(label, known) or f"there are {', '.join(known)}"
                raise UnusableInput((), f"there is no property `{label}`: {hint}")
            chosen |= meant
        properties = tuple(each for each in self.specification.properties if each.label in chosen)
        return replace(
            self,
            specification=replace(self.specification, properties=properties),
            compiled=[each for each in self.compiled if each.specification.label in chosen],
            left_out=tuple(label for label in known if label not in chosen),
        )

    @cached_property
    def late(self) -> tuple[Diagnostic, ...]:
        """A warning for each property whose verdicts may come late, to be reported when these monitors run."""
        from ltlc.assurance.exactness import late_verdicts

        return tuple(late_verdicts(self.specification.source, self.compiled, self.budget))


def read(specification: object) -> Source | Diagnostic:
    """The text of a specification, or why its file cannot be read. Raises UnusableInput for what is neither."""
    if not isinstance(specification, str | PathLike):
        hint = "a specification is a string, or the `pathlib.Path` of a file"
        raise UnusableInput((), f"{specification!r:.100} is not a specification; {hint}")
    if isinstance(specification, str):
        if specification.endswith(FILES) and not any(map(str.isspace, specification)):
            hint = f"give a file as a path: `pathlib.Path({specification!r})`"
            raise UnusableInput((), f"`{specification}` is not a specification; {hint}")
        return Source(NAME, specification)
    return read_source(Path(specification))


def encoding_of(name: str, known: Mapping[str, Encoding] = ENCODINGS) -> Encoding:
    """The encoding called `name`. Raises UnusableInput."""
    if name not in known:
        hint = did_you_mean(str(name), known) or f"the encodings are {', '.join(known)}"
        raise UnusableInput((), f"there is no encoding `{name}`: {hint}")
    return known[name]


def folders(message_paths: Sequence[str | PathLike[str]]) -> list[str]:
    """The names of folders of messages. Raises UnusableInput for one by itself, whose letters would be taken."""
    if isinstance(message_paths, str | PathLike):
        raise UnusableInput((), f"`message_paths` must be a list of folders: `[{str(message_paths)!r}]`")
    return [str(path) for path in message_paths]


def prepare(
    source: Source | Diagnostic,
    message_paths: Sequence[str | PathLike[str]],
    encoding: Encoding,
    budget: Budget,
    watch: Watch | None = None,
    recordings: Iterable[Path] = (),
    analyses: Budget | None = None,
) -> Prepared:
    """The specification that `source` states, with its monitors, each made within `budget`.

    It is analysed within `analyses`, or not at all. The messages that `recordings` define are known, too.

    Raises UnusableInput if it could not be read, as a diagnostic in its place says, if it has errors, or a property for
    whose monitor `budget` does not suffice; and SpotMissing.
    """
    if isinstance(source, Diagnostic):
        raise UnusableInput([source])
    specification, diagnostics = load_text(source, folders(message_paths), encoding, recordings)
    if specification is None:
        raise UnusableInput(unsuppressed(diagnostics))
    known: Known = {}
    if analyses is None:
        remarks = suppress(specification, diagnostics)
    else:
        examined = examine_loaded(specification, diagnostics, encoding, analyses, watch)
        remarks = examined.diagnostics
        known = examined.monitors
    from ltlc.compiler import compile_specification  # `ltlc check` does without

    compiled, problems = compile_specification(specification, encoding, budget, watch, known)
    if problems:
        raise UnusableInput([*remarks, *problems])
    return Prepared(specification, compiled, tuple(remarks), budget)
