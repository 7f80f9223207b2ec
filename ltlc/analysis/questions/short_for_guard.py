"""Is a bound on time shorter than the time that a guard leaves to itself?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.time_bounds import time_bounds
from ltlc.analysis.wording import part_at
from ltlc.semantics.durations import duration_text
from ltlc.semantics.properties import Within
from ltlc.specification.arenas import is_in_game


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each deadline under `_lead_`: the guard leaves the controller no time of its own."""
    specification, of = study.specification, subject.specification
    if of.is_assumed or not specification.guards or not is_in_game(of, specification.guards):
        return
    for bound in time_bounds(of.property):
        if bound.duration < specification.lead and isinstance(part_at(of.property, bound.path), Within):
            lead = duration_text(specification.lead)
            yield Finding(
                "LTL614",
                of.spans[bound.path],
                f"the bound of {duration_text(bound.duration)} is shorter than `_lead_`, {lead}: a guard acts at once",
                label="leaves the controller no time",
                help="set a shorter `_lead_`, if the node is sure to be that fast, or a longer bound",
            )
