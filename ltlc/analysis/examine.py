"""All findings about a specification before it runs: those of the front end, and of the analyses."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from ltlc.analysis.analyse import analyse
from ltlc.analysis.subjects import Study, Subject
from ltlc.automata.batch import Known
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import Budget, Watch
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.frontend.language import in_order, load_text
from ltlc.frontend.language.suppression import suppress, unsuppressed
from ltlc.semantics.encodings import Encoding
from ltlc.specification.specification import Specification


@dataclass(frozen=True, slots=True)
class Examined:
    """What was analysed, None if it has errors of form, with all findings about it in its order."""

    study: Study | None
    diagnostics: list[Diagnostic]

    @property
    def specification(self) -> Specification | None:
        """The specification; None if it has errors of form."""
        return None if self.study is None else self.study.specification

    @property
    def monitors(self) -> Known:
        """The monitors that have been made, by their shapes."""
        return {} if self.study is None else dict(self.study.monitors)

    @property
    def subjects(self) -> Sequence[Subject]:
        """The properties with what was made of them."""
        return () if self.study is None else self.study.subjects


def examine(
    source: Source | Diagnostic,
    message_paths: Sequence[str],
    encoding: Encoding,
    budget: Budget,
    watch: Watch | None = None,
    *,
    pedantic: bool = False,
    controls: Sequence[str] = (),
    recordings: Iterable[Path] = (),
) -> Examined:
    """The findings about `source`, or why it could not be read; what authors suppress in the text is omitted.

    The messages that `recordings` define are known. Otherwise as `load_text` and `analyse`. Raises SpotMissing.
    """
    if isinstance(source, Diagnostic):
        return Examined(None, [source])
    specification, diagnostics = load_text(source, message_paths, encoding, recordings)
    if specification is None:
        return Examined(None, unsuppressed(diagnostics))
    return examine_loaded(specification, diagnostics, encoding, budget, watch, pedantic=pedantic, controls=controls)


def examine_loaded(
    specification: Specification,
    diagnostics: Sequence[Diagnostic],
    encoding: Encoding,
    budget: Budget,
    watch: Watch | None = None,
    *,
    pedantic: bool = False,
    controls: Sequence[str] = (),
) -> Examined:
    """The findings about a `specification`, of which the front end says `diagnostics`. Raises SpotMissing."""
    found = analyse(specification, encoding, budget, watch, pedantic=pedantic, controls=controls)
    told = in_order(suppress(specification, [*diagnostics, *found.diagnostics], pedantic=pedantic))
    return Examined(found.study, told)
