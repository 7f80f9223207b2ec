"""Extracts of a recording: what was recorded around the violations of each property."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ltlc.dataclass import dataclass
from ltlc.monitoring.later import MOST, Violation, all_violations, violation_at
from ltlc.runtime.reports import topic_names
from ltlc.runtime.session import Session
from ltlc.runtime.times import Scale
from ltlc.runtime.tracking import Track
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict


@dataclass(frozen=True, slots=True)
class Extract:
    """The part of a recording from `since` to `until`, both included, in which a property was violated, `last` then.

    The property is the one with the `label`. It gets the `name` of a file, and `text` says of which violations it is.
    """

    label: str
    name: str
    text: str
    since: Nanoseconds
    last: Nanoseconds
    until: Nanoseconds


def extracts(session: Session, before: Nanoseconds, after: Nanoseconds) -> Iterator[Extract]:
    """What to extract of a recording: each violation, from so long `before` it to so long `after`.

    If something was owed, from so long before it was. Parts of one property that overlap are one.
    """
    scale = Scale(session.beginning)
    names = topic_names([track.property.label for track in session.tracks])
    for name, track in zip(names, session.tracks, strict=True):
        found = _violations(track)
        parts = _joined(found, before, after)
        of_property = scale.among(end.moment.time for part in parts for end in (part[0], part[-1]))
        for part in parts:
            first, last = part[0].moment.time, part[-1].moment.time
            when = of_property.text(first)
            text = f"{track.property.label} at {when}"
            if len(part) > 1:
                text += f" and {len(part) - 1} more up to {of_property.text(last)}"
            since = min(each.owed for each in part) - before
            if part[0].opened < since:
                text += f", in an episode that opened before it, at {of_property.text(part[0].opened)}"
            if part is parts[-1] and len(found) >= MOST:
                text += f" (violations after the first {MOST} are not looked for)"
            yield Extract(
                track.property.label,
                f"{name}{when.replace(' ', '')}.mcap",
                text,
                since,
                last,
                last + after,
            )


def _joined(violations: Iterable[Violation], before: Nanoseconds, after: Nanoseconds) -> list[list[Violation]]:
    """The violations in the order of time, those together whose parts of the recording overlap."""
    joined: list[list[Violation]] = []
    for each in sorted(violations, key=lambda violation: violation.moment.time):
        together = [each]
        while joined and min(v.owed for v in together) - before <= joined[-1][-1].moment.time + after:
            together = joined.pop() + together
        joined.append(together)
    return joined


def _violations(track: Track) -> list[Violation]:
    """The violations of a property that are known: of `each`, the first for each id."""
    found = all_violations(track)
    if found is not None:
        return found
    if track.slices is not None:
        return [violation_at(each.failure) for each in track.slices.ids.violated.values()]
    failure = track.decided_at
    return [violation_at(failure)] if failure is not None and track.verdict is Verdict.VIOLATED else []
