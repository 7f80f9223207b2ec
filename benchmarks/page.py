"""How large the page of `ltlc run --report` becomes, what making it costs, and how long a frame takes in Chromium.

    python -m benchmarks.page [SAMPLES]

Three signals at 1 kHz, a million samples each by default, of which three properties are judged. `judging` is without
trails and without collecting; `trails` and `collecting` are what each adds, CPU seconds. Frames are measured while
zooming in and out by 7 % a frame; `frame` is the time between two, `draw` what the script needs of it.
"""

from __future__ import annotations

import math
import random
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import chromium
import numpy as np
from stepping import from_text

from ltlc.base.diagnostics import Diagnostic
from ltlc.inputs.recordings import Block
from ltlc.inputs.recordings.blocks import Samples
from ltlc.interfaces.pages.report import PageReport
from ltlc.monitoring.judging.run import Judge, Watcher

PROPS = """decl speed /speed Float64.data
decl distance /distance Float64.data
decl battery /battery Float64.data
slow: never speed > 2.4
stop: after_until distance < 1.5, distance > 1.5, eventually speed =={0.02} 0
charge: always (battery < 20 implies eventually battery > 20 within 30 s)
"""

ZOOM = """
const done = arguments[0], draws = [], frames = [];
const { view } = timelines[0];
for (const timeline of timelines) {
  const draw = timeline.draw;
  timeline.draw = function () {
    const start = performance.now();
    draw.call(this);
    draws.push(performance.now() - start);
  };
}
let number = 0, last = performance.now();
requestAnimationFrame(function frame(now) {
  frames.push(now - last);
  last = now;
  if (number++ === 200) return done([draws, frames]);
  view.zoom(number % 100 < 50 ? 0.93 : 1 / 0.93, 0.6 * view.end);
  requestAnimationFrame(frame);
});
"""


def signals(count: int) -> dict[str, list[float]]:
    noise = random.Random(1)
    shares = [n / count for n in range(count)]
    return {
        "speed": [1.6 + 0.25 * math.sin(40 * u) + noise.gauss(0, 0.03) for u in shares],
        "distance": [abs(10 - 20 * u) for u in shares],
        "battery": [100 - 95 * u + 5 * math.sin(60 * u) + noise.gauss(0, 0.1) for u in shares],
    }


class Recorded:
    """A recording in memory."""

    def __init__(self, count: int) -> None:
        self._values = {name: np.array(values) for name, values in signals(count).items()}
        self.columns = tuple(self._values)
        self._count = count

    @property
    def definitions(self) -> dict[str, str]:
        """None: it has no messages."""
        return {}

    @property
    def beginning(self) -> None:
        """That of its first row."""
        return

    def absence(self, name: str) -> str:
        """Every signal is there."""
        return f"it has no {name}"

    def remedy(self, name: str) -> str:
        """None is needed."""
        return ""

    def remarks(self) -> list[Diagnostic]:
        """None."""
        return []

    def blocks(self) -> Iterator[Block]:
        """Rows with a sample of each signal."""
        size = 1 << 16
        for first in range(0, self._count, size):
            times = np.arange(first, min(first + size, self._count)) * 1_000_000
            rows = np.arange(len(times))
            yield Block(times, {n: Samples(rows, v[first : first + size]) for n, v in self._values.items()}, {})


def judged(count: int, keep_trails: bool, *watchers: Watcher) -> tuple[Any, float]:
    compiled, specification = from_text(PROPS)
    recording = Recorded(count)
    start = time.process_time()
    judge = Judge(compiled, specification, keep_trails=keep_trails, open=lambda *_: recording)
    report = judge.judge(Path("memory"), watchers)
    return report, time.process_time() - start


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    page = PageReport(*from_text(PROPS))
    collected = page.collector()
    spent = 0.0

    def take(block: Block) -> None:
        nonlocal spent
        start = time.process_time()
        collected.take(block)
        spent += time.process_time() - start

    _, plain = judged(count, False)
    report, trailing = judged(count, True, take)
    start = time.process_time()
    page.add(report, collected)
    html = page.html()
    made = time.process_time() - start
    print(f"judging {plain:.2f} s, trails {trailing - spent - plain:.2f}, collecting {spent:.2f}, page {made:.2f}")
    print(f"{count} samples of 3 signals: a page of {len(html.encode()) / 1e6:.2f} MB")
    if chromium.MISSING:
        print(chromium.MISSING)
        return
    with tempfile.TemporaryDirectory() as folder, chromium.browser(Path(folder)) as browser:
        (Path(folder) / "page.html").write_text(html, encoding="utf-8")
        start = time.monotonic()
        browser.open(Path(folder) / "page.html")
        print(f"opened and drawn after {time.monotonic() - start:.2f} s")
        for name, times in zip(("draw", "frame"), browser.run_until_done(ZOOM), strict=True):
            quantiles = statistics.quantiles(times, n=20)
            print(f"{name}: median {statistics.median(times):.1f} ms, p95 {quantiles[-1]:.1f} ms")


if __name__ == "__main__":
    main()
