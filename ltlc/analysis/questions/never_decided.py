"""Can the monitor say violated, or satisfied, while the robot is running?"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning if it can say neither, on any run."""
    monitor = subject.monitor
    if monitor is None or any(verdict.is_permanent for verdict in monitor.verdicts):
        return
    timeout = study.specification.timeout
    end = f"the run ends, after {timeout:g} s" if timeout else "the run ends"
    yield Finding(
        "LTL506",
        subject.specification.span,
        f"no run decides `{subject.label}`: its verdict is only presumed, and can change until {end}",
        help="say until when it has to happen: `until EVENT, …`, or `after_until EVENT, EVENT, …`",
    )
