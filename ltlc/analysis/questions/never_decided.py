"""Can the monitor say violated, or satisfied, while the robot is running?"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from ltlc.analysis.examples import Example, example_of
from ltlc.analysis.findings import Finding
from ltlc.analysis.search import all_shortest
from ltlc.analysis.subjects import Study, Subject
from ltlc.semantics.durations import duration_text
from ltlc.semantics.monitor import Monitor

MOST_WORDS = 200
"""Of so many short runs, the first on which the verdict changes is shown."""


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning if it can report neither, on any run."""
    monitor = subject.monitor
    if monitor is None or any(verdict.is_permanent for verdict in monitor.verdicts):
        return
    timeout = study.specification.timeout
    end = f"the run ends, after {duration_text(timeout)}" if timeout else "the run ends"
    yield Finding(
        "LTL506",
        subject.specification.span,
        f"no run decides `{subject.label}`: its verdict stays presumable and can change until {end}",
        example=_undecided_run(study, subject, monitor),
        help="say by when it has to happen: `until EVENT, …`, or `after_until EVENT, EVENT, …`",
    )


def _undecided_run(study: Study, subject: Subject, monitor: Monitor) -> Example | None:
    """The shortest run after which both presumable verdicts have been given."""
    words = all_shortest([(subject.formula, monitor)], subject.alphabet, lambda _: True, subject.shut)
    if subject.counts:
        return None
    word = next((w for w in islice(words, MOST_WORDS) if len(set(monitor.run(w))) > 1), None)
    if word is None:
        return None
    caption = "a run on which the verdict changes, and could change again"
    return example_of(study.setting(subject), word, caption, study.verdicts(subject, word))
