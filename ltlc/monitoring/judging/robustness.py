"""By how much properties hold in a run, as text and data."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ltlc.monitoring.columns.curves import Curve
from ltlc.runtime.session import Session
from ltlc.runtime.slice_reports import id_text
from ltlc.runtime.times import seconds

NO_NUMBERS = "no comparison of numbers decides it"
NOT_STARTED = "not started"


def robustness_report(session: Session, curve: Curve) -> dict[str, Any]:
    """That of a property in the JSON document of `ltlc run`; its `margin` is null for the `reason` beside it."""
    if reason := _reason(curve):
        return {"margin": None, "reason": reason}
    found: dict[str, Any] = {"margin": curve.whole, "reason": None}
    if curve.decided is not None:
        time, comparison = curve.decided
        offset = {} if session.beginning is None else {"offset": seconds(time - session.beginning)}
        found |= {"comparison": comparison, "time": seconds(time), "time_ns": time, **offset}
    if curve.opened_at is not None:
        found["opened_at"] = seconds(curve.opened_at)
    if curve.id is not None:
        found["id"] = curve.id
    return found


def robustness_text(session: Session, curves: Mapping[str, Curve]) -> str:
    """A line for each property, the one that is violated most, or closest to it, first."""
    ranked = sorted(curves, key=lambda label: math.inf if _reason(curves[label]) else curves[label].whole or 0.0)
    return "".join(
        ["\nRobustness:\n", *(f"  {label}: {robustness_sentence(session, curves[label])}\n" for label in ranked)]
    )


def robustness_sentence(session: Session, curve: Curve) -> str:
    """The margin, when and by which comparison; or why there is none."""
    if reason := _reason(curve):
        return f"none: {reason}"
    margin = f"{curve.whole:.6g}"
    of = f" of id {id_text(curve.id)}" if curve.id is not None else ""
    if curve.opened_at is not None:
        of = f" from the message at {session.scale.text(curve.opened_at)} on"
    if curve.decided is None:
        return margin + of
    time, comparison = curve.decided
    return f"{margin} at {session.scale.text(time)}{',' * bool(of)}{of}: {comparison}"


def _reason(curve: Curve) -> str:
    """Why there is no number; empty if there is."""
    if curve.reason:
        return curve.reason
    if curve.whole is None:
        return NOT_STARTED
    return NO_NUMBERS if math.isinf(curve.whole) else ""
