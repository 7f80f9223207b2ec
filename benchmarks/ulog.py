"""How fast flight logs are read, beside pyulog: `python -m benchmarks.ulog [LOG…] [--messages N] [--rounds N]`.

Without a LOG, one of three topics is made in a temporary folder. pyulog decodes all of it; of the same log the topics,
and then one field or all messages, are read. What is compared takes turns; medians of the time of the CPU.
"""

from __future__ import annotations

import argparse
import statistics
import struct
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from pyulog import ULog

from ltlc.inputs.recordings import open_recording
from ltlc.inputs.recordings.bags.messages import LATEST
from ltlc.inputs.recordings.bags.ulog import LAST, ULogStorage
from ltlc.specification.expressions import Field, Signal, ValueType


def written(path: Path, count: int) -> Path:
    """A log in which an attitude comes `count` times, with as many gyroscopes and every tenth time a battery."""
    data = [b"ULog\x01\x12\x35\x01" + bytes(8)]
    formats = [
        "vehicle_attitude:uint64_t timestamp;uint64_t timestamp_sample;float[4] q;float[4] delta_q_reset;"
        "uint8_t quat_reset_counter;uint8_t[7] _padding0;",
        "sensor_gyro:uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float x;float y;float z;"
        "float temperature;uint32_t error_count;uint8_t[3] clip_counter;uint8_t samples;uint8_t[4] _padding0;",
        "battery_status:uint64_t timestamp;float voltage_v;float current_a;float remaining;bool connected;"
        "uint8_t[3] _padding0;",
    ]
    data += [_message("F", text.encode()) for text in formats]
    data += [
        _message("A", struct.pack("<BH", 0, number) + text.partition(":")[0].encode())
        for number, text in enumerate(formats)
    ]
    for number in range(count):
        now = 4000 * number
        data.append(_message("D", struct.pack("<HQQ8fB", 0, now, now, *[0.5] * 8, 1)))
        data.append(_message("D", struct.pack("<HQQI4fI4B", 1, now, now, 7, *[0.1] * 4, 0, 0, 0, 0, 1)))
        if number % 10 == 0:
            data.append(_message("D", struct.pack("<HQ3f?", 2, now, 15.2, 8.0, 0.7, True)))
    path.write_bytes(b"".join(data))
    return path


def _message(kind: str, body: bytes) -> bytes:
    return struct.pack("<HB", len(body), ord(kind)) + body


def ways(path: Path) -> dict[str, Callable[[], object]]:
    """What is compared, of a log."""
    topics = ULogStorage(path, {}).topics
    name, topic = max(topics.items(), key=lambda item: item[1].count or 0)
    signal = Signal("t", ValueType.NUMBER, Field(name, topic.type, ("timestamp",)))

    def messages() -> list[object]:
        storage = ULogStorage(path, {})
        return list(storage.batches(storage.topics, -LATEST, LATEST))

    return {
        "pyulog, all of it": lambda: ULog(str(path)),
        "ltlc, topics": lambda: ULogStorage(path, {}),
        "ltlc, all messages": messages,
        "ltlc, a field as rows": lambda: list(open_recording(path, {"t": signal}).blocks()),
    }


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("logs", nargs="*", type=Path, metavar="LOG")
    parser.add_argument("--messages", type=int, default=200_000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        logs = options.logs or [written(Path(folder) / "made.ulg", options.messages)]
        for log in logs:
            compared = ways(log)
            found: dict[str, list[float]] = {way: [] for way in compared}
            for _ in range(options.rounds):
                for way, read in compared.items():
                    LAST.clear()
                    start = time.process_time()
                    read()
                    found[way].append(time.process_time() - start)
            print(f"{log.name}, {log.stat().st_size / 1e6:.1f} MB")
            whole = statistics.median(found["pyulog, all of it"])
            for way, times in found.items():
                print(f"  {way:<24} {statistics.median(times):6.3f} s  {statistics.median(times) / whole:5.2f}")


if __name__ == "__main__":
    main()
