"""Records the judged messages in a file that `ltlc run` reads."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TextIO

from ltlc.backends.ros2.node.files import UnusableError
from ltlc.runtime.documents import json_value
from ltlc.runtime.sampling import Value
from ltlc.runtime.times import seconds_text


class Recorder:
    """Writes samples as lines of JSON, with the times that they were judged by.

    Each run has a file, which gets its name when the run has ended: before, and if the
    node is killed, `.part` stands behind it. Its last line has the end of the run.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file: TextIO | None = None
        self._runs = 0
        self._latest = 0
        try:
            self._opened()
        except OSError as error:
            raise UnusableError(f"record is {str(path)!r}: {error.strerror}") from error

    @property
    def _part(self) -> Path:
        return self._path.with_name(f"{self._path.name}.part")

    def _opened(self) -> TextIO:
        if self._file is None:
            self._file = self._part.open("w", encoding="utf-8")
        return self._file

    def write(self, time: int, samples: Iterable[tuple[str, Value]] = ()) -> None:
        """Messages of `time` brought `samples`; none: the run began, or went on."""
        cells = [f'"time": {seconds_text(time)}']
        cells += [f"{json.dumps(n)}: {json.dumps(json_value(v))}" for n, v in samples]
        self._opened().write(f"{{{', '.join(cells)}}}\n")
        self._latest = time

    def save(self) -> None:
        """Let others see what has been written so far."""
        if self._file is not None:
            self._file.flush()

    def end(self, time: int | None) -> None:
        """The run has been watched until `time`; None: it has not begun."""
        if time is not None and time > self._latest:
            self.write(time)
        self._opened().close()
        self._file, self._latest = None, 0
        self._runs += 1
        number = "" if self._runs == 1 else f"_{self._runs}"
        self._part.replace(self._path.with_stem(f"{self._path.stem}{number}"))
