"""What `ltlc run --timing` reports: how each property was judged, why, and how long it took."""

from __future__ import annotations

from ltlc.monitoring.columns.session import ByBlocks, Way

_MS = 1_000_000


def timing(blocks: ByBlocks, reading: int, judging: int, reporting: int) -> str:
    """A line for the whole, whose times are in ns, and one for each property."""
    parts = {"reading": reading, "judging": judging, "reporting": reporting}
    whole = ", ".join(f"{what} {time / _MS:.1f} ms" for what, time in parts.items())
    shared = f"comparing with constants {blocks.nanoseconds / _MS:.1f} ms, by rows {blocks.by_rows / _MS:.1f} ms"
    lines = [f"timing: {whole}; of judging, {shared}", *(f"timing: {_of(way)}" for way in blocks.ways)]
    return "".join(f"{line}\n" for line in lines)


def _of(way: Way) -> str:
    label, by_rows = way.track.property.label, sum(way.because.values())
    is_stepped = way.forward is None and way.track.slices is None
    columns = "by columns, stepped where its conditions change" if is_stepped else "by columns"
    because = "; ".join(way.because)
    if by_rows == way.blocks:
        return f"{label}: by rows: {because}" if because else f"{label}: no rows"
    took = f"{label}: {columns}, {way.nanoseconds / _MS:.1f} ms"
    return f"{took}; {by_rows} of {way.blocks} blocks by rows: {because}" if by_rows else took
