"""A recording that is dropped on the page, as the rows of a run there."""

from __future__ import annotations

import binascii
import json
import math
import os
from base64 import b64decode
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ltlc.base.render.json import documents
from ltlc.frontend.language import load_text
from ltlc.inputs.recordings import RecordingError, open_recording
from ltlc.inputs.recordings.blocks import Block, Samples
from ltlc.inputs.recordings.lacks import signals_of
from ltlc.interfaces.pages.series import sampled
from ltlc.interfaces.serve.questions import MOST_STEPS, Question, bad, with_errors
from ltlc.runtime.documents import json_value
from ltlc.runtime.sampling import Value
from ltlc.runtime.times import seconds_text
from ltlc.specification.expressions import Signal, ValueType
from ltlc.specification.specification import Specification
from ltlc.specification.text import number_text
from ltlc.specification.wire import SINGLES

MOST_CHARACTERS = 1_000_000
"""Of all cells: the page sends them whenever it asks about the run."""


def open_file(question: Question) -> dict[str, Any]:
    """The samples of the signals that the specification reads, in a recording; the first rows of a long one.

    Times count from its beginning. The recording is written to the folder of the question, and removed with it.
    """
    path = _written(question)
    specification, _ = load_text(question.source, question.message_paths, question.encoding, recordings=[path])
    if specification is None:
        raise with_errors()
    try:
        rows, is_whole = _rows(path, specification)
    except RecordingError as error:
        return {"diagnostics": documents([error.diagnostic]), "rows": None, "remark": ""}
    remark = "" if is_whole else f"only the first {len(rows)} rows of {path} are here: `ltlc run` judges all of it"
    return {"diagnostics": [], "rows": rows, "remark": remark}


def _written(question: Question) -> Path:
    """The file that was sent, in the folder of the question, where this process goes, so that messages name it only."""
    os.chdir(question.folder)
    path = Path(Path(question.file).name)
    try:
        path.write_bytes(b64decode(question.content, validate=True))
    except binascii.Error:
        raise bad("`content` is not base64") from None
    except (OSError, ValueError) as error:
        raise bad(f"`file` is not the name of a file: {error}") from None
    return path


def _rows(path: Path, specification: Specification) -> tuple[list[dict[str, Any]], bool]:
    """The rows, and whether these are all. Raises RecordingError."""
    recording = open_recording(path, signals_of(specification.properties))
    signals = {i.signal.name: i.signal for each in specification.properties for i in each.inputs()}
    rows: list[dict[str, Any]] = []
    beginning, last, size = recording.beginning, None, 0
    for block, samples in sampled(recording.blocks(), list(signals.values())):
        for time, cells in _cells(block, samples, signals):
            beginning = time if beginning is None else beginning
            if cells or not rows:
                size += sum(map(len, cells.values()))
                if len(rows) == MOST_STEPS - 1 or size > MOST_CHARACTERS:
                    return rows, False
                rows.append({"time": seconds_text(time - beginning), "cells": cells})
            last = time
    if beginning is not None and last is not None and seconds_text(last - beginning) != rows[-1]["time"]:
        rows.append({"time": seconds_text(last - beginning), "cells": {}})
    return rows, True


def _cells(
    block: Block, samples: Mapping[str, Samples], signals: Mapping[str, Signal]
) -> Iterator[tuple[int, dict[str, str]]]:
    """The time of each row, and the cells of the signals that have a sample in it."""
    cells: list[dict[str, str]] = [{} for _ in block.times]
    for name, found in samples.items():
        for row, value in zip(found.rows.tolist(), found.listed(), strict=True):
            cells[row][name] = _cell(value, signals[name])
    return zip(block.times.tolist(), cells, strict=True)


def _cell(value: Value, signal: Signal) -> str:
    """A value as the table of the page has it: what `ltlc run` takes from it is the same value."""
    if isinstance(value, tuple):
        return (
            f"[{', '.join(json.dumps(json_value(each)) if _is_text(each) else _item(each, signal) for each in value)}]"
        )
    return value if isinstance(value, str) else _item(value, signal)


def _is_text(item: Value) -> bool:
    """Whether JSON has `item` as a string: it has no numbers that are not finite."""
    return isinstance(item, str) or (isinstance(item, float) and not math.isfinite(item))


def _item(item: Value, signal: Signal) -> str:
    if isinstance(item, bool) or signal.type in (ValueType.BOOLEAN, ValueType.BOOLEANS):
        return "true" if item else "false"
    return number_text(item, signal.numbers == SINGLES) if math.isfinite(item) else repr(item)
