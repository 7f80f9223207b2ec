"""What a run has shown, as text."""

from __future__ import annotations

import re
import struct
from collections.abc import Sequence
from math import inf, isfinite

from ltlc.runtime.properties import (
    Condition,
    Failure,
    Moment,
    MonitoredProperty,
)
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Loss, Session
from ltlc.runtime.silence import beginning, lost, malformed, waiting_for
from ltlc.runtime.times import Scale, seconds_text, span_text
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict


def printable(text: str) -> str:
    """`text` with what a terminal would act on, or not show, written as escapes."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def topic_names(labels: Sequence[str]) -> list[str]:
    """Names of topics, all different, of letters, digits and single `_`."""
    found: list[str] = []
    for label in labels:
        words = re.findall(r"[A-Za-z0-9]+", label)
        name = "_".join(words if words and words[0][0].isalpha() else ["p", *words])
        unique, number = name, 1
        while unique in found:
            number += 1
            unique = f"{name}_{number}"
        found.append(unique)
    return found


LONGEST = 200
"""How many items of an array, or characters of a string, are shown to a reader."""


def value_text(value: Value) -> str:
    """A value as the property language writes it; an array cut.

    A double exactly; one that is a binary32 with the fewest digits that identify it.
    """
    if value is None:
        return "no value"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(_shortest(value))
    if not isinstance(value, (tuple, str)):
        return repr(value)
    shown = value[:LONGEST]
    is_text = isinstance(shown, str)
    text = repr(shown) if is_text else f"[{', '.join(map(_item_text, shown))}]"
    return text if len(value) <= LONGEST else f"{text}... ({len(value)} in all)"


def _item_text(item: Value) -> str:
    return repr(_shortest(item) if isinstance(item, float) else item)


def _shortest(value: float) -> float:
    """The double with the fewest digits that is nearest to the same binary32."""
    if not isfinite(value) or _single(value) != value:
        return value
    rounded = (float(f"{value:.{digits}g}") for digits in range(1, 10))
    return next(number for number in rounded if _single(number) == value)


def _single(value: float) -> float:
    """The nearest binary32."""
    try:
        nearest: float = struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:
        return inf
    return nearest


def figure(session: Session, track: Track) -> str:
    """The error message for a violated property: its text, and the failing state."""
    if track.slices is not None:
        return track.slices.figure()
    assert track.decided_at is not None
    return failure_text(track.property, track.decided_at, session.scale)


def failure_text(property_: MonitoredProperty, failure: Failure, scale: Scale) -> str:
    """The error message for a property that is violated.

    The form of Figure 1 of Cordeiro, Fonseca and Timperley, *Formalization and Runtime
    Verification of Invariants for Robotic Systems*, with what led to it, and when.
    """
    since = failure.open_since
    moments = [failure, *([] if since is None else [since]), *failure.opened]
    scale = scale.among(moment.time for moment in moments)
    lines = [f"Error at line {_place(property_)}:"]
    lines.append(f"  {property_.text}")
    lines.append("Failing state:")
    for name, value in failure.values:
        shown = property_.written.get(name, name)
        lines.append(f"  {shown}: {named_text(property_, name, value)}")
    if failure.because:
        lines.append("Because:")
        lines += [f"  {condition_text(property_, c)}" for c in failure.because]
    if since is not None:
        lines.append(f"Unmet since {_owed(property_, since, scale)}")
    clock = f", {seconds_text(failure.time)} by the clock" if scale.has_clock else ""
    lines.append(f"At {moment_text(failure, scale)}{clock}.")
    for depth, opening in enumerate(failure.opened):
        within = f"Inside it, that of `{opening.scope}`" if depth else "The episode"
        lines.append(f"{within} opened at {moment_text(opening, scale)}.")
    return "".join(f"{printable(line)}\n" for line in lines)


def _place(property_: MonitoredProperty) -> str:
    """Line, file and, where the author gave one, label of a property."""
    place = f"{property_.line} of {property_.file}"
    has_label = property_.label != f"line {property_.line}"
    return f"{place} ({property_.label})" if has_label else place


def named_text(property_: MonitoredProperty, name: str, value: Value) -> str:
    """The value of an input, with the name that its message has for it: `ERROR (2)`."""
    constant = property_.constants.get(name, {}).get(value)
    return value_text(value) if constant is None else f"{constant} ({value:g})"


_OPPOSITES = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}


def condition_text(property_: MonitoredProperty, condition: Condition) -> str:
    """What a condition was, what it compared, and by how much the sides differ."""
    parts = [value_text(condition.holds)]
    if condition.left is not None and (compared := _compared(property_, condition)):
        parts.append(compared)
    if condition.age is not None:
        parts.append(f"the age is {span_text(condition.age)}")
    if condition.lasted is not None:
        parts.append(f"{span_text(condition.lasted)} so far")
    if condition.ago is not None:
        parts.append(f"last {span_text(condition.ago)} ago")
    if condition.element is not None:
        index, values = condition.element
        parts += [f"{name}[{index}] is {value_text(value)}" for name, value in values]
    return f"{condition.text}: {', '.join(parts)}"


def _compared(property_: MonitoredProperty, condition: Condition) -> str:
    left, right = value_text(condition.left), value_text(condition.right)
    difference = distance(condition)
    if left == right and difference:
        left, right = repr(condition.left), repr(condition.right)
    by = f" by {difference:.6g}" if difference else ""
    if condition.relation in _OPPOSITES:
        is_so, relation = condition.holds, condition.relation
        return f"{left} {relation if is_so else _OPPOSITES[relation]} {right}{by}"
    if difference is None:
        return f"comparing {left} with {right}"
    if not by:
        return ""
    name = condition.text.partition(" == ")[0]
    if name in property_.constants:
        return f"it is {named_text(property_, name, condition.left)}"
    return f"{left} differs from {right}{by}"


def distance(condition: Condition) -> float | None:
    """By how much the two sides differ, if they are finite numbers."""
    left, right = condition.left, condition.right
    if not all(
        side.__class__ in (int, float) and isfinite(side) for side in (left, right)
    ):
        return None
    found: float = abs(left - right)
    return found


def moment_text(moment: Moment, scale: Scale) -> str:
    """A step, or the clock step after it, and its time."""
    place = f"after step {moment.step}" if moment.by_time else f"step {moment.step}"
    return f"{scale.text(moment.time)} ({place})"


def summary(session: Session) -> str:
    """A line for each property, its verdict and what to know, and what was not seen."""
    lines = [sentence(session, track) for track in session.tracks]
    return "".join(f"{line}\n" for line in [*lines, *unseen(session)])


def unseen(session: Session) -> list[str]:
    """A note on messages that came and went between two ticks."""
    return [
        f"no tick saw {count} of {counted(session.messages[topic], 'message')} "
        f"on {printable(topic)}"
        for topic, count in session.unseen.items()
        if count
    ]


def sentence(session: Session, track: Track) -> str:
    """The result of a property, in one line."""
    verdict = track.verdict.value.replace("_", " ")
    parts = [f"{printable(track.property.label)}: {verdict}{_since(session, track)}"]
    parts += explanation(session, track)
    return "; ".join(parts)


def _since(session: Session, track: Track) -> str:
    if track.slices is not None:
        return track.slices.since()
    if track.decided_at is not None:
        return f" at {moment_text(track.decided_at, session.scale)}"
    return ""


def explanation(session: Session, track: Track) -> list[str]:
    """Remarks on a verdict: what is open, what never came, what was invalid."""
    remarks = []
    if track.verdict is Verdict.NOT_STARTED and not track.invalid:
        remarks += waiting_for(session, track)
    if skips(session, track):
        remarks += [beginning(session, track), _skipped(track)]
    if track.slices is not None:
        remarks += track.slices.remarks()
    elif track.open_since is not None:
        owed = _owed(track.property, track.open_since, session.scale)
        remarks.append(f"unmet since {owed}")
        left = time_left(session, track)
        if left is not None:
            remarks.append(f"{span_text(left)} left")
    if track.times_violated > 1:
        remarks.append(counted(track.times_violated, "violation"))
    if track.never_triggered:
        remarks.append("holds, but never triggered: no episode opened")
    elif track.episodes is not None:
        remarks.append(counted(track.episodes, "episode"))
    if track.slices is None:
        remarks.append(counted(track.steps, "step"))
    for reason, count in track.invalid_because.items():
        remarks.append(f"{counted(count, 'step')} left out: {reason}")
    for name, count in not_measured(session, track).items():
        were = "was NaN, no measurement" if count == 1 else "were NaN, no measurements"
        remarks.append(f"{counted(count, 'element')} of {name} {were}")
    if track.delays:
        remarks.append(_delay(track))
    remarks += [_loss(topic, loss) for topic, loss in lost(session, track).items()]
    for topic, count in malformed(session, track).items():
        were = "was" if count == 1 else "were"
        remarks.append(f"{counted(count, 'message')} on {topic} {were} malformed")
    return [printable(remark) for remark in remarks]


def skips(session: Session, track: Track) -> bool:
    """Whether messages were not judged before a property began, later than the run."""
    return bool(track.skipped) and track.began not in (None, session.began)


def _skipped(track: Track) -> str:
    counts = sorted(track.skipped.items())
    said = [f"{counted(n, 'message')} on {topic}" for topic, n in counts]
    were = "was" if [n for _, n in counts] == [1] else "were"
    return f"{' and '.join(said)} before that {were} not judged"


def not_measured(session: Session, track: Track) -> dict[str, int]:
    """How many elements of the arrays that a property reads were NaN, if some were."""
    counts = session.sampler.not_measured
    names = dict.fromkeys(wanted.signal for wanted in track.property.inputs)
    return {name: counts[name] for name in names if counts.get(name)}


def time_left(session: Session, track: Track) -> int | None:
    """For how long what is still open can wait; None if nothing is, or for ever."""
    if track.slices or track.open_since is None or session.time is None:
        return None
    deadline = track.deadline()
    return None if deadline is None else deadline - 1 - session.time


def _owed(property_: MonitoredProperty, since: Moment, scale: Scale) -> str:
    owed = " or ".join(property_.obligations) or property_.text
    return f"{moment_text(since, scale)}: {owed}"


def _loss(topic: str, loss: Loss) -> str:
    if not loss.count:
        return f"some messages on {topic} may have been lost"
    were = "was" if loss.count == 1 else "were"
    text = f"{counted(loss.count, 'message')} on {topic} {were} lost"
    return text if loss.is_all else f"{text}, and more may have been"


def _delay(track: Track) -> str:
    longest = span_text(track.longest_delay)
    return f"reported late {counted(track.delays, 'time')}, by {longest} at most"


def counted(number: int, noun: str, nouns: str = "") -> str:
    """So many of something."""
    return f"{number} {noun if number == 1 else nouns or noun + 's'}"


def exit_code(verdicts: Sequence[Verdict], has_lost: bool = False) -> int:
    """1 if a property is violated; 3 if one is unmet or never started; otherwise 0.

    Nothing is well where messages have been lost, or were malformed.
    """
    if Verdict.VIOLATED in verdicts:
        return 1
    return 0 if not has_lost and all(verdict.holds for verdict in verdicts) else 3
