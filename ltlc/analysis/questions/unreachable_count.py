"""Is there a count that cannot be reached within its time at the ticks of `_rate_`?"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.wording import all_parts
from ltlc.semantics.durations import UNITS, Nanoseconds, duration_text
from ltlc.semantics.properties import Now, Throughout
from ltlc.semantics.timed_atoms import Occurred


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each count of more than can occur at the ticks of so long a time; none without `_rate_`."""
    rate = study.specification.rate
    if rate is None:
        return
    for path, part in all_parts(subject.specification.property):
        count = part.predicate if isinstance(part, Now | Throughout) else part
        if not isinstance(count, Occurred) or count.within is None:
            continue
        ticks = _ticks(count.within, rate)
        most = (ticks + 1) // 2 if count.begins else ticks
        if count.times > most:
            yield Finding(
                "LTL526",
                subject.specification.spans[path],
                f"`_rate_ = {rate:g}` has {ticks} ticks in {duration_text(count.within)}: "
                f"at most {most} occurrences can be counted, not {count.times}",
                label="never holds",
                help="ask for fewer occurrences, or allow more time",
            )


def _ticks(duration: Nanoseconds, rate: float) -> int:
    """How many ticks, each of which is at a whole nanosecond, can be in a closed interval of this duration."""
    return int((duration + 1) * Fraction(rate) / UNITS["s"]) + 1
