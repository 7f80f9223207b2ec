"""What the script of a page draws, as JSON; series are compressed, for they are most of the page."""

from __future__ import annotations

import base64
import math
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.trails import Trail
from ltlc.interfaces.pages.panels import Drawing, Panel
from ltlc.interfaces.pages.series import Series
from ltlc.monitoring.later import Violation
from ltlc.runtime.reports import moment_text, printable
from ltlc.runtime.session import Session
from ltlc.runtime.times import Scale, span_text
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.expressions import Expression


@dataclass
class Data:
    """What a page carries: `blobs` are base64 of deflated little-endian numbers, each once."""

    blobs: list[str] = field(default_factory=list)
    timelines: list[dict[str, Any]] = field(default_factory=list)
    _places: dict[bytes, int] = field(default_factory=dict)

    def blob(self, numbers: NDArray[Any]) -> dict[str, Any]:
        """Where the script finds `numbers`, and of what type they are."""
        content = numbers.tobytes()
        if content not in self._places:
            self._places[content] = len(self.blobs)
            self.blobs.append(base64.b64encode(zlib.compress(content, 9)).decode())
        return {"blob": self._places[content], "type": numbers.dtype.str.lstrip("<|")}

    def as_json(self) -> dict[str, Any]:
        """The whole."""
        return {"blobs": self.blobs, "timelines": self.timelines}


def timeline(
    data: Data,
    session: Session,
    trail: Trail,
    violations: Sequence[Violation],
    panels: list[Panel],
    series: Mapping[Expression, Series],
    robustness: Series | None = None,
) -> dict[str, Any]:
    """The timeline of one property; times are ns since the session began, as numbers. Its `robustness` comes first."""
    began, ended, scale = session.began, session.time, session.scale
    assert began is not None
    assert ended is not None
    return {
        "clock": _clock(scale, began),
        "end": ended - began,
        "changes": [
            {
                "time": change.moment.time - began,
                "verdict": change.current.value,
                "text": moment_text(change.moment, scale),
            }
            for change in trail.changes
        ],
        "episodes": [
            {
                "scope": printable(span.opening.scope),
                "depth": span.depth,
                "from": span.opening.time - began,
                "to": None if span.closed is None else span.closed.time - began,
            }
            for span in trail.spans
        ],
        "deadlines": [
            {
                "from": deadline.since - began,
                "due": deadline.due - began,
                "to": None if deadline.until is None else deadline.until - began,
            }
            for deadline in trail.deadlines
        ],
        "violations": [
            {
                "from": each.moment.time - began,
                "to": (ended if each.until is None else each.until) - began,
                "text": span_text(lasted) if (lasted := each.lasted(ended)) else "",
            }
            for each in violations
        ],
        "panels": [
            *([] if robustness is None else [_robustness(data, began, robustness)]),
            *(_panel(data, began, panel, series) for panel in panels),
        ],
    }


def _clock(scale: Scale, began: Nanoseconds) -> dict[str, Any]:
    """What is added to times where they are shown, and whether they are since the beginning."""
    return {"zero": began - (scale.zero or 0), "since": scale.zero is not None}


def _panel(data: Data, began: Nanoseconds, panel: Panel, series: Mapping[Expression, Series]) -> dict[str, Any]:
    lines = [{"role": "signal", **_line(data, began, series[panel.expression])}]
    for bound in panel.bounds:
        drawn = _line(data, began, series[bound.expression])
        texts = {"text": printable(bound.text), "shift": bound.shift, "reach": bound.reach}
        lines.append({"role": "bound", **drawn, **texts})
    return {
        "title": printable(panel.title),
        "kind": panel.kind.value,
        "names": [printable(name) for name in series[panel.expression].names] if panel.kind is Drawing.STRING else [],
        "wanted": [printable(name) for name in panel.wanted],
        "lines": lines,
        "limits": list(_limits(panel)),
    }


def _robustness(data: Data, began: Nanoseconds, robustness: Series) -> dict[str, Any]:
    return {
        "title": "robustness",
        "kind": Drawing.NUMBER.value,
        "names": [],
        "wanted": [],
        "lines": [{"role": "signal", **_line(data, began, robustness)}],
        "limits": [{"text": "robustness > 0", "value": 0.0, "reach": 0.0}],
    }


def _limits(panel: Panel) -> Iterator[dict[str, Any]]:
    for limit in panel.limits:
        if math.isfinite(limit.value):
            yield {"text": printable(limit.text), "value": limit.value, "reach": limit.reach}


def _line(data: Data, began: Nanoseconds, series: Series) -> dict[str, Any]:
    """A series: the time between its samples, and their values, as small as they are exact."""
    times, values = series.samples()
    gaps = np.diff(times, prepend=began)
    small = gaps.astype(np.uint32)
    with np.errstate(over="ignore"):
        singles = values.astype(np.float32)
    exact = np.array_equal(singles.astype(np.float64), values, equal_nan=True)
    return {
        "gaps": data.blob(small if (small == gaps).all() else gaps.astype(np.float64)),
        "values": data.blob(singles if exact else values),
        "count": series.count,
        "bucket": series.bucket,
    }
