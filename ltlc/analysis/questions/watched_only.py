"""Is there a property that no guard of the file keeps?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.guards.controls import controllers
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import listed
from ltlc.specification.arenas import is_in_game


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A note for each property beside a guard that is watched only, and for each that is none of a controller's."""
    guards, of = (*study.specification.guards, *controllers(study.controls)), subject.specification
    if not guards or is_in_game(of, guards):
        return
    topics = listed(list(dict.fromkeys(f"`{guard.out}`" for guard in guards)), "or")
    why = "it is about one id at a time" if of.slicing else f"nothing in it is about {topics}"
    yield Finding(
        "LTL615",
        of.span,
        f"no {'controller' if study.controls else 'guard'} keeps `{subject.label}`: {why}",
        label="watched only",
        help=f"relate it to what is sent on {topics}, or rely on it: `assume`",
    )
