"""Wrong readings of the language, such as other tools have: what a case is for is to tell the definition from some.

A reading takes a specification and a run, and gives the verdicts that somebody would who reads the language so.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import lru_cache
from typing import Any
from unittest.mock import patch

from benchmarks.conformance import wrong
from benchmarks.conformance.cases import Verdicts
from benchmarks.conformance.definition import Definition, definition
from benchmarks.differential import arrivals, forms, judge, past, reference, samples, values
from benchmarks.differential.compare import last_of_each_time
from benchmarks.differential.samples import Recording, Row
from benchmarks.differential.values import NoValueError

Judged = Callable[[str, Recording], Verdicts]


@dataclass(frozen=True)
class Reading:
    """A wrong reading: what it is `about`, in which properties it can matter, and what it gives."""

    family: str
    about: str
    matters: re.Pattern[str]
    judged: Judged


def _by_definition(text: str, recording: Recording) -> Verdicts:
    return definition(text).verdicts(recording)


def instead(*replaced: tuple[Any, str, Any]) -> Judged:
    """The definition with other functions in the place of some of its own."""
    is_read_anew = any(where in (arrivals.Trial, reference, values, values.Reader) for where, _, _ in replaced)
    read = lru_cache(256)(Definition) if is_read_anew else definition

    def judged(text: str, recording: Recording) -> Verdicts:
        with ExitStack() as stack:
            for where, name, by in replaced:
                stack.enter_context(patch.object(where, name, by))
            return read(text).verdicts(recording)

    return judged


def with_text(changed: Callable[[str], str]) -> Judged:
    """The definition, of another specification."""
    return lambda text, recording: _by_definition(changed(text), recording)


def with_rows(changed: Callable[[Sequence[Row]], list[Row]]) -> Judged:
    """The definition, on another run."""

    def judged(text: str, recording: Recording) -> Verdicts:
        rows = changed(recording.rows)
        return _by_definition(text, Recording(rows, rows[0].time, max(recording.end, rows[-1].time)))

    return judged


def with_times(changed: Callable[[int], int]) -> Judged:
    """The definition, on a run at other times; it is another reading only where the verdicts are others."""

    def judged(text: str, recording: Recording) -> Verdicts:
        found = with_rows(lambda rows: [Row(changed(row.time), row.messages) for row in rows])(text, recording)
        expected = _by_definition(text, recording)
        is_same = [verdict for _, verdict in found.changes] == [verdict for _, verdict in expected.changes]
        return expected if is_same else found

    return judged


def with_values(changed: Callable[[Any], Any]) -> Judged:
    """The definition, on a run with other values."""
    return with_rows(lambda rows: [wrong.row_with(row, changed) for row in rows])


def with_verdicts(changed: Callable[[str], str]) -> Judged:
    """Other words for the verdicts of the definition."""

    def judged(text: str, recording: Recording) -> Verdicts:
        found = _by_definition(text, recording)
        shown = [(time, changed(verdict)) for time, verdict in found.changes]
        return Verdicts(last_of_each_time(shown), found.steps)

    return judged


def _replaced(pattern: str, by: str) -> Judged:
    return with_text(lambda text: re.sub(pattern, by, text))


def _at_rows(text: str, recording: Recording) -> Verdicts:
    """What is known at messages only: a verdict that time brings comes with the next, or not at all."""
    found = _by_definition(text, recording)
    times = [row.time for row in recording.rows]
    late = [(next((t for t in times if t >= time), None), verdict) for time, verdict in found.changes]
    return Verdicts(last_of_each_time([(t, v) for t, v in late if t is not None]), found.steps)


_past = {name: getattr(past, name) for name in ("age_at_most", "counted", "historically", "once", "since")}
_EVERYWHERE, _TIMED = r"\w", r"\d (ns|ms|s)|soon|age\(|new |previously|rate\("
_ARRAYS = r"scan|many|ints|uints|ids|kinds|locked|:\}"

_TABLE: Mapping[str, tuple[str, str, str, Judged]] = {
    # Scopes
    "after-until-at-every-opening": (
        "scopes", "every step with X and not Y opens an episode of its own", "after_until",
        instead((judge.AfterUntil, "episodes", wrong.every_episode))),
    "after-until-first-only": (
        "scopes", "after the first episode no other opens", "after_until",
        instead((judge.AfterUntil, "episodes", wrong.first_episode))),
    "after-until-closed-only": (
        "scopes", "an episode that has not been closed is not judged", "after_until",
        instead((judge.AfterUntil, "episodes", wrong.closed_episodes))),
    "after-until-with-its-end": (
        "scopes", "the closing step belongs to the episode", "after_until",
        instead((judge.AfterUntil, "episodes", wrong.longer_episodes))),
    "after-until-opens-anyway": (
        "scopes", "an episode opens at X, even where Y holds", "after_until",
        instead((judge.AfterUntil, "episodes", wrong.eager_episodes))),
    "after-a-step-late": (
        "scopes", "`after` begins behind its event", r"after(?!_)", instead((judge.After, "judged", wrong.after_late))),
    "after-every-event": (
        "scopes", "`after` begins anew at each event", r"after(?!_)",
        instead((judge.After, "judged", wrong.after_each))),
    "until-weak": (
        "scopes", "`until` does not ask for its event", r"until(?<!after_until)",
        instead((judge.Until, "judged", wrong.until_weak))),
    "until-with-its-end": (
        "scopes", "the step of the event belongs to `until`", r"until(?<!after_until)",
        instead((judge.Until, "judged", wrong.until_with_end))),
    "initially-of-the-run": (
        "scopes", "`initially` is about the first step of the run", "initially",
        instead((judge.Initially, "judged", wrong.initially_of_run))),
    "initially-of-nothing": (
        "scopes", "`initially p` holds of no steps", "initially",
        instead((judge.Initially, "judged", wrong.initially_of_nothing))),
    "opening-at-the-beginning": (
        "scopes", "a value at the opening is that at the beginning of the run", "opening",
        instead((judge, "_opened", wrong.opened_at_first))),
    # Bounds
    "within-excludes-its-end": (
        "bounds", "D itself is not within D", r"within|for ",
        instead((judge.Within, "judged", wrong.within_open))),
    "bound-ignored": (
        "bounds", "bounds on temporal keywords make no difference", r"within|for ",
        instead((judge.Within, "judged", wrong.within_ever))),
    "interval-from-its-beginning": (
        "bounds", "B of [A, B] counts from A", r"\[\d",
        instead((judge.Within, "judged", wrong.within_longer))),
    "interval-excludes-its-beginning": (
        "bounds", "A itself is not in [A, B]", r"\[\d",
        instead((judge.Within, "judged", wrong.within_later))),
    "interval-starts-at-once": (
        "bounds", "A of [A, B] makes no difference", r"\[\d",
        instead((judge.Within, "judged", wrong.within_earlier))),
    # The past
    "previously-the-step-before": (
        "past", "`previously p` is what p was at the step before", "previously",
        instead((past, "previously", wrong.previous_step))),
    "previously-at-first": (
        "past", "`previously p` holds at the first instant", "previously",
        instead((past, "previously", wrong.previously_at_first))),
    "once-excludes-its-end": (
        "past", "`once p within D` leaves out what is D ago", "once",
        instead((past, "once", lambda of, d: _past["once"](of, d if d is None else d - 1)))),
    "historically-longer-than": (
        "past", "`historically p for D` needs more than D", "historically",
        instead((past, "historically", lambda of, d: _past["historically"](of, d if d is None else d + 1)))),
    "historically-where-there-is-any": (
        "past", "`historically p for D` is that p held at all instants of the last D there are (MTL)", "historically",
        instead((past, "historically", wrong.historically_as_mtl))),
    "since-excludes-its-end": (
        "past", "`p since q within D` leaves out what is D ago", "since",
        instead((past, "since", lambda p, q, d: _past["since"](p, q, d if d is None else d - 1)))),
    "since-with-its-beginning": (
        "past", "in `p since q` p has to hold where q does", "since",
        instead((past, "since", wrong.since_both))),
    # Counts and rates
    "count-what-holds": (
        "counts", "`once p N times` counts the steps at which p holds", r"times",
        instead((forms, "is_of_messages", lambda _: True))),
    "count-what-begins": (
        "counts", "`once p N times` counts beginnings of p, also of messages", r"times|rate\(",
        instead((forms, "is_of_messages", lambda _: False))),
    "count-one-of-a-time": (
        "counts", "two messages at one time count once", r"times|rate\(",
        with_rows(wrong.last_of_a_time)),
    "count-excludes-its-end": (
        "counts", "a count within D leaves out what is D ago", r"times|rate\(",
        instead((past, "counted", lambda of, m, n, d, p: _past["counted"](of, m, n, d if d is None else d - 1, p)))),
    "rate-from-the-first-moment": (
        "counts", "a rate is not presumed while the first D lasts", r"rate\(",
        instead((past, "counted", lambda of, m, n, d, _: _past["counted"](of, m, n, d, False)))),
    # Messages and ages
    "age-of-valid-messages": (
        "messages", "an age counts from the last message that made a step", r"age\(",
        instead((past, "age_at_most", wrong.age_of_steps))),
    "age-endless-at-first": (
        "messages", "before its first message a topic is older than any D", r"age\(",
        instead((past, "age_at_most", lambda on, h, b, d: _past["age_at_most"](on, h, b - 10**13, d)))),
    "age-excludes-its-end": (
        "messages", "an age of D is not `<= D`", r"age\(",
        instead((past, "age_at_most", lambda on, h, b, d: _past["age_at_most"](on, h, b, d - 1)))),
    "news-that-stays": (
        "messages", "`new s` holds until the next step", "new ",
        instead((past, "news", past.constant))),
    "rows-repeat-all-values": (
        "messages", "each row is a message on every topic that has been heard", _EVERYWHERE,
        with_rows(wrong.filled)),
    "equal-values-are-no-messages": (
        "messages", "a message with the values of the one before is none", _EVERYWHERE,
        with_rows(wrong.that_change)),
    "waits-for-everything": (
        "messages", "a property waits for signals that it reads with their news, too", "new ",
        instead((arrivals.Trial, "is_excused", lambda *_: False))),
    "zero-before-the-first-message": (
        "messages", "a signal is 0, false or empty before its first message", _EVERYWHERE,
        lambda text, recording: with_rows(lambda rows: wrong.begun(text, rows))(text, recording)),
    # Invalid values
    "nan-is-zero": ("invalid", "a NaN is 0", _EVERYWHERE, with_values(lambda v: 0.0 if v != v else v)),
    "nan-holds-the-last-value": (
        "invalid", "a NaN is the value before it, and a step", _EVERYWHERE, with_rows(wrong.held_over_nan)),
    "nan-fails-comparisons": (
        "invalid", "a NaN is a step at which comparisons fail", _EVERYWHERE,
        instead((values, "valued", lambda v: v), (samples.Sampler, "_step", wrong.step_anyway))),
    "nan-elements-are-zero": (
        "invalid", "an element that is NaN is 0", _ARRAYS,
        with_values(lambda v: tuple(0.0 if x != x else x for x in v) if isinstance(v, tuple) else v)),
    "nan-element-spoils-all": (
        "invalid", "a message with an element that is NaN makes no step", _ARRAYS, with_rows(wrong.without_nan)),
    # Arrays and functions
    "all-of-nothing-fails": (
        "arrays", "`all` of no elements is false", r"all\(", instead((values.Reader, "_counted", wrong.counted))),
    "any-is-all": ("arrays", "`any` and `all` are exchanged", r"(any|all)\(", with_text(wrong.exchanged)),
    "extremes-of-nothing": (
        "arrays", "the smallest of no elements is infinite", r"(min|max)\(", instead((values, "_fold", wrong.fold))),
    "median-of-the-lower": (
        "arrays", "a median of an even number is the lower of the middle two", "median",
        instead((values, "_median", wrong.lower_median))),
    "only-the-first-element": (
        "arrays", "an array is its first element", _ARRAYS,
        with_values(lambda v: v[:1] if isinstance(v, tuple) else v)),
    "mod-with-the-sign-of-the-first": (
        "functions", "`mod(x, y)` has the sign of x, as in C", r"mod\(",
        instead((values, "OF_DOUBLES", {**values.OF_DOUBLES, "mod": math.fmod}))),
    "zone-as-a-box": (
        "functions", "a zone is the box around it", "hall", instead((values, "is_within", wrong.in_box))),
    "zone-without-its-border": (
        "functions", "the border of a zone is outside", "hall", instead((values, "is_within", wrong.inside_only))),
    "distance-in-space": (
        "functions", "`distance` is in space, not in the plane", r"\.distance\.",
        _replaced(r"\.distance\.", ".distanceZ.")),
    "signs-ignored": (
        "functions", "numbers are their absolute values", _EVERYWHERE,
        with_values(lambda v: abs(v) if isinstance(v, float | int) and not isinstance(v, bool) else v)),
    # Types of values
    "single-as-double": (
        "types", "a float32 is compared with a literal as a double", r"\b(f|g|scan|level)\b",
        with_text(wrong.singles_as_doubles)),
    "double-as-single": (
        "types", "a double is rounded to binary32", r"\b(v|w|many|pair_x|pair_y)\b",
        with_values(lambda v: values.single(v) if isinstance(v, float) else v)),
    "integer-as-double": (
        "types", "a 64-bit integer is rounded to a double", r"\b(i|u|ints|uints)\b", wrong.integers_as_doubles),
    # Comparisons
    "margin-ignored": (
        "comparisons", "margins make no difference", r"[=<>]\{|_margin_",
        _replaced(r"(?<=[=<>])\{[\d.]+\}|_margin_ = .*\n", "")),
    "margin-always-widens": (
        "comparisons", "a margin on an ordering widens it, on either side of a negation", r"[<>]=?\{",
        instead((reference, "Reader", wrong.always_in_favour))),
    "orderings-are-strict": ("comparisons", "`<=` is `<`, and `>=` is `>`", "[<>]=", _replaced("([<>])=", r"\1")),
    "orderings-are-not-strict": (
        "comparisons", "`<` is `<=`, and `>` is `>=`", "[<>](?!=)", _replaced("([<>])(?!=)", r"\1=")),
    "nearly-equal-is-equal": (
        "comparisons", "numbers are equal if they differ by 1e-9", "[=!]=|in {",
        instead((values, "RELATIONS", wrong.RELATIONS))),
    # History
    "history-of-one-less": (
        "history", "`@{s, -1}` is the sample itself", r"-\d:?\}", _replaced(r"-1(?=\})", "-2")),
    "history-counts-rows": (
        "history", "a sample of one signal is one of all", r"-\d:?\}|when", with_rows(wrong.filled)),
    "when-ignored": (
        "history", "`@{s, when p}` is the latest value of s", "when ",
        instead((samples, "_latched", wrong.latched_anyway))),
    # Time and steps
    "time-at-messages-only": (
        "time", "nothing happens between two messages", _TIMED, _at_rows),
    "time-in-seconds-as-doubles": (
        "time", "times are doubles of seconds", _TIMED, with_times(lambda t: round(t / 1e9 * 1e9))),
    "time-in-milliseconds": (
        "time", "times are whole milliseconds", _TIMED, with_times(lambda t: t // 10**6 * 10**6)),
    "rows-of-one-time-are-one": (
        "time", "messages of one time are one step", _EVERYWHERE, with_rows(wrong.merged)),
    "rate-ignored": ("time", "a step is a message, whatever `_rate_` says", "_rate_", _replaced("_rate_ = .*\n", "")),
    "ticks-miss-their-own-time": (
        "time", "a tick does not see messages of its own time", "_rate_", with_rows(wrong.a_moment_later)),
    "timeout-ignored": ("time", "a run has no timeout", "_timeout_", _replaced("_timeout_ = .*\n", "")),
    # Verdicts
    "nothing-is-final": (
        "verdicts", "no verdict is permanent", _EVERYWHERE,
        with_verdicts(lambda v: {"violated": "presumably_violated", "satisfied": "presumably_satisfied"}.get(v, v))),
    "open-is-violated": (
        "verdicts", "an open obligation is a violation", _EVERYWHERE,
        with_verdicts(lambda v: "violated" if v == "presumably_violated" else v)),
    "good-is-satisfied": (
        "verdicts", "what holds so far is satisfied", _EVERYWHERE,
        with_verdicts(lambda v: "satisfied" if v == "presumably_satisfied" else v)),
    # Ids
    "each-is-one-run": (
        "ids", "all ids share one run", "each . of", with_text(lambda text: re.sub("each . of key: ", "", text))),
    "each-of-the-first": (
        "ids", "only the first id is judged", "each . of", with_rows(wrong.of_first_id)),
    "each-new-of-the-first": (
        "ids", "only the first message opens an instance", "each new", wrong.first_instance),
    "each-new-afterwards": (
        "ids", "an instance begins behind its message", "each new", wrong.later_instances),
}  # fmt: skip

BY_PARTS = "decided-by-parts"
"""Of a verdict that no part of the property decides alone; here it is the reference that comes late, and what it would
have to be is proved. So nothing is drawn for it: it is what drawn cases turn out to be.
"""

READINGS: Mapping[str, Reading] = {
    name: Reading(family, about, re.compile(matters), judged)
    for name, (family, about, matters, judged) in _TABLE.items()
}
"""By name."""


NOT_READ = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    LookupError,
    NoValueError,
    StopIteration,
    TypeError,
    ValueError,
)
"""What the reference raises of a specification that the language does not have, or that it does not know."""


def tells(name: str, text: str, recording: Recording, expected: Verdicts) -> bool:
    """Whether a run shows that a reading is wrong: its verdicts, or their times, are others."""
    try:
        found = READINGS[name].judged(text, recording)
    except NOT_READ:
        return False
    return list(found.changes) != list(expected.changes)


def that_matter(text: str) -> Iterator[str]:
    """The readings that can make a difference to a specification, by what is written in it."""
    own = "\n".join(line for line in text.splitlines() if line.startswith(("p: ", "_")))
    return (name for name, reading in READINGS.items() if reading.matters.search(own))
