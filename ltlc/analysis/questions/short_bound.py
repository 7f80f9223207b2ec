"""Is there a bound on time that is over before the next tick of `_rate_`?"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ltlc.analysis.findings import Finding
from ltlc.analysis.subjects import Study, Subject
from ltlc.analysis.time_bounds import time_bounds
from ltlc.semantics.durations import UNITS, duration_text


def ask(study: Study, subject: Subject) -> Iterator[Finding]:
    """A warning for each bound under a period: between two ticks nothing is seen, so that it holds at once or never.

    None for ages, which count from the messages themselves.
    """
    rate = study.specification.rate
    if rate is None:
        return
    period = UNITS["s"] / Fraction(rate)
    for bound in time_bounds(subject.specification.property):
        if bound.unbounded is not None and bound.duration < period:
            short, tick = duration_text(bound.duration), duration_text(round(period))
            yield Finding(
                "LTL522",
                subject.specification.spans[bound.path],
                f"the bound of {short} ends before the next tick: `_rate_ = {rate:g}` has one only every {tick}",
                label="covers one tick",
                help=f"set a rate above {float(UNITS['s'] / Fraction(bound.duration)):g}, or a bound of {tick} or more",
            )
