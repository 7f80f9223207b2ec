"""The examples of when a property begins, judged alike in every form of recording, live, and by what is emitted."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bag_support import FORMS, Sent, made
from c_mutants import read_back
from ros_support import Network, Node, emitted
from stepping import from_text, ns

import ltlc
from ltlc.assurance import c_library
from ltlc.assurance.c_library import Library
from ltlc.assurance.compiled_program import VERDICTS
from ltlc.assurance.programs import load
from ltlc.assurance.reading.outcomes import ReadBack
from ltlc.backends import c, emit
from ltlc.backends.python import standalone_classes
from ltlc.monitoring.judging.run import run
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.evaluation import Value
from ltlc.specification.expressions import Signal

DOUBLE, INTEGER = "std_msgs/msg/Float64", "std_msgs/msg/Int32"
DECLARED = """decl st /st std_msgs/Int32.data
decl cx /cx std_msgs/Float64.data
decl hps /hps std_msgs/Float64.data
decl mode /mode std_msgs/Int32.data
zone yard = [(0, 0), (1, 0), (0, 1)]
"""
EXAMPLES = {
    "after new st and st == 1, never new cx and not cx == 0": Verdict.VIOLATED,
    "always (new cx and cx > 0 implies once new hps)": Verdict.SATISFIED,
    "eventually (new mode and mode == 3) within 3 s": Verdict.VIOLATED,
    "always 1 < 2": Verdict.SATISFIED,
    "eventually 2 < 1 within 1 s": Verdict.VIOLATED,
    "never once true 1 times": Verdict.VIOLATED,
    "never inside(5, 5, yard)": Verdict.PRESUMABLY_SATISFIED,
}
"""Properties that do not wait for any value, some because they read nothing, and what they are on the drive."""

RATES = pytest.mark.parametrize("rate", ["", "_rate_ = 20\n"], ids=["messages", "ticks"])

DRIVE: list[tuple[float, str, float]] = [(0, "st", 1), (0.01, "hps", 7), (0.02, "cx", 0.5), (4, "st", 1)]
"""When, on which topic, and what; `mode` stays silent."""


def as_csv(folder: Path) -> Path:
    path, names = folder / "drive.csv", ("st", "cx", "hps", "mode")
    rows = (f"{time}," + ",".join(str(value) if n == name else "" for n in names) for time, name, value in DRIVE)
    path.write_text("\n".join([f"time,{','.join(names)}", *rows]) + "\n", encoding="utf-8")
    return path


def as_json_lines(folder: Path) -> Path:
    path = folder / "drive.jsonl"
    path.write_text("".join(f"{json.dumps({'time': t, name: v})}\n" for t, name, v in DRIVE), encoding="utf-8")
    return path


def as_bag(form: str, folder: Path) -> Path:
    types = {"st": (INTEGER, int), "cx": (DOUBLE, float), "hps": (DOUBLE, float)}
    messages = [Sent(f"/{n}", types[n][0], ns(t), made(types[n][0], data=types[n][1](v))) for t, n, v in DRIVE]
    return FORMS[form](folder, messages)


@pytest.mark.parametrize(
    "recorded",
    [as_csv, as_json_lines, *(lambda folder, form=form: as_bag(form, folder) for form in ("sqlite3", "mcap"))],
)
@pytest.mark.parametrize("keep_verdicts", [False, True], ids=["columns", "rows"])
@RATES
def test_they_are_judged_alike_in_every_recording(
    recorded: Callable[[Path], Path], keep_verdicts: bool, rate: str, tmp_path: Path
) -> None:
    report = run(*from_text(DECLARED + rate + "\n".join(EXAMPLES)), recorded(tmp_path), keep_verdicts)
    assert report.session is not None
    assert [track.verdict for track in report.session.tracks] == list(EXAMPLES.values())
    steps = 81 if rate else 1
    assert [track.steps for track in report.session.tracks[3:]] == [steps] * 4


@RATES
def test_they_are_judged_alike_by_a_monitor_in_python(rate: str) -> None:
    live = ltlc.monitor(DECLARED + rate + "\n".join(f"p{n}: {each}" for n, each in enumerate(EXAMPLES)))
    for time, name, value in DRIVE:
        live.step({name: value}, time=time)
    assert [each.value for each in live.verdicts.values()] == [each.value for each in EXAMPLES.values()]


@pytest.mark.skipif(c_library.compiler() is None, reason="there is no C compiler here")
@RATES
def test_they_are_judged_alike_by_emitted_c(rate: str) -> None:
    compiled, whole = from_text(DECLARED + rate + "\n".join(EXAMPLES))
    assert all(isinstance(each, ReadBack) for each in read_back(c.emit(compiled, whole), compiled, whole))
    library = Library(c.emit(compiled, whole), str(c_library.compiler()))
    monitors = library.monitors()
    assert monitors.begin(0)
    for time, name, value in DRIVE:
        given: dict[Signal, Value] = {
            s: int(value) if name == "st" else value for s in library.numbers if s.name == name
        }
        assert monitors.step(ns(time), given, [f"/{name}"])
    shown = [VERDICTS[monitors.show(number)[0]] for number in range(len(compiled))]
    assert shown == list(EXAMPLES.values())


@pytest.mark.parametrize("number", range(len(EXAMPLES)))
def test_they_are_judged_alike_by_emitted_python(number: int) -> None:
    property_, verdict = list(EXAMPLES.items())[number]
    compiled, whole = from_text(DECLARED + property_)
    (written,) = standalone_classes(compiled, "props.txt")
    monitor = load(emit("python", compiled, whole), "emitted")[written.name](*[0] * written.timed)
    held: dict[str, Any] = {}
    for time, name, value in DRIVE:
        while written.timed and ns(time) > monitor.due:
            monitor.expire()
        held |= {name: value}
        given = {word: held.get(told.name, told.name == f"new {name}" or None) for word, told in written.parameters}
        if name in property_ or time == 0:
            monitor.step(*[ns(time)] * written.timed, **given)
    assert monitor.verdict.value == verdict.value


@pytest.mark.ros
def test_they_are_judged_alike_live(folder: Path, network: Network, tmp_path: Path) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: install ltlc[ros]")
    from std_msgs.msg import Float64, Int32

    stated = "\n".join(f"p{n}: {each}" for n, each in enumerate(EXAMPLES)).replace("3 s", "500 ms")
    stated += "".join(f"\nheard_{name}: eventually new {name}" for _, name, _ in DRIVE[:3])
    publishers = {
        name: network.publisher(Int32 if name == "st" else Float64, f"/{name}") for name in ("st", "hps", "cx")
    }
    with Node(emitted(DECLARED + stated, folder, "beginnings"), tmp_path) as node:
        network.matched(list(publishers.values()))
        for _, name, value in DRIVE[:3]:
            publisher = publishers[name]
            publisher.publish(Int32(data=int(value)) if name == "st" else Float64(data=float(value)))
            # Two messages that wait on different topics are taken in either order.
            heard = (f"heard_{name}", "satisfied")
            network.wait_until(lambda heard=heard: heard in node.changes, f"the message of {name}")  # type: ignore[misc]
        violated = {(f"p{n}", "violated") for n, verdict in enumerate(EXAMPLES.values()) if verdict is Verdict.VIOLATED}
        network.wait_until(lambda: violated <= set(node.changes), "what is violated")
        assert node.end() == 1
    (run_,) = node.runs
    assert [run_[f"p{n}"]["verdict"] for n in range(len(EXAMPLES))] == [verdict.value for verdict in EXAMPLES.values()]
