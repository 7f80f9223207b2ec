"""Live, recorded and emitted, a number of a message is judged as it is on the wire: against exact arithmetic."""

from __future__ import annotations

import json
import math
from array import array
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from replaying import MESSAGES
from stepping import emitted, from_text

from ltlc.assurance.programs import load
from ltlc.backends import emit
from ltlc.backends.python import standalone_classes
from ltlc.compiler import Compiled
from ltlc.monitoring.judging.run import run
from ltlc.specification.specification import Specification

CODES = {
    "Float32": "f",
    "Float64": "d",
    "Int8": "b",
    "Int16": "h",
    "Int32": "i",
    "Int64": "q",
    "UInt8": "B",
    "UInt16": "H",
    "UInt32": "I",
    "UInt64": "Q",
    "Byte": "B",
    "Char": "B",
}
"""The messages of a single number, and how `array` calls the number."""

HARD = ["0", "0.3", "0.1", "0.5", "1e-45", "16777217", "3.4028235e38", "1e39", "1e999", "127.5", "128", "255", "256"]
HARD += ["65535", "2147483648", "9007199254740992", "9007199254740993", "9223372036854775807", "18446744073709551615"]


class Compared(NamedTuple):
    """`FORM(x) RELATION{MARGIN} LITERAL`, and its left side as an exact number; arithmetic and margins make doubles."""

    text: str
    form: Callable[[float], float]
    relation: str
    literal: str
    margin: float = 0.0

    def __str__(self) -> str:
        margin = f"{{{self.margin!r}}}" if self.margin else ""
        return f"{self.text} {self.relation}{margin} {self.literal}"

    def holds(self, value: float, code: str) -> bool:
        """Under `never`, where a margin makes an ordering harder to satisfy."""
        left, right = self.form(value), exact(self.literal, "d" if "*" in self.text else code)
        if self.margin and self.relation == "==":
            return float(left) == float(right) or abs(float(left) - float(right)) <= self.margin
        if self.margin:
            right = float(right) + (self.margin if ">" in self.relation else -self.margin)
        answers = {"<": left < right, "<=": left <= right, "==": left == right, ">": left > right, ">=": left >= right}
        return answers[self.relation]


def exact(literal: str, code: str) -> float | Fraction:
    """The number that a literal is beside one of type `code`."""
    sign, digits = (-1, literal[1:]) if literal.startswith("-") else (1, literal)
    if code == "f":
        return sign * single(float(digits))
    if code == "d" or not digits.isdigit():
        return sign * float(digits)
    return sign * Fraction(digits)


def single(value: float) -> float:
    """As C converts a double: what is beyond the binary32 becomes infinite."""
    return array("f", [value])[0] if abs(value) < 3.4028235677973366e38 or math.isinf(value) else math.inf


FORMS: list[tuple[str, Callable[[float], float]]] = [
    ("x", lambda x: x),
    ("-x", lambda x: -x),
    ("abs(x)", abs),
    ("min(x, x)", lambda x: x),
    ("x * 1", float),
    ("x * x", lambda x: float(x) * float(x)),
]


def values(name: str) -> st.SearchStrategy[Any]:
    if name.startswith("Float"):
        return st.floats(allow_nan=False, width=32 if name == "Float32" else 64) | st.sampled_from(
            [single(float(h)) if name == "Float32" else float(h) for h in HARD]
        )
    code = CODES[name]
    bits = 8 * array(code).itemsize
    least, most = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if code.islower() else (0, 2**bits - 1)
    near = [n + d for n in (least, most, 0, 2**53, -(2**53)) for d in (-2, -1, 0, 1, 2) if least <= n + d <= most]
    return st.sampled_from(near) | st.integers(least, most)


@st.composite
def literals(draw: st.DrawFn, value: Any) -> str:
    """Near the value, or hard whatever it is."""
    near = (
        [f"{abs(value)}", f"{abs(value):.7g}"]
        if isinstance(value, float)
        else [f"{abs(value + d)}" for d in (-1, 0, 1)]
    )
    text = draw(st.sampled_from([*near, *HARD]))
    text = "1e999" if text == "inf" else text
    return draw(st.sampled_from(["", "-"])) + text


@st.composite
def cases(draw: st.DrawFn) -> tuple[str, list[Compared], list[Any]]:
    """A type of message, comparisons, and values of it."""
    name = draw(st.sampled_from(sorted(CODES)))
    run = draw(st.lists(values(name), min_size=1, max_size=5))
    found = []
    for _ in range(draw(st.integers(1, 4))):
        form, relation = draw(st.sampled_from(FORMS)), draw(st.sampled_from(["<", "<=", "==", ">", ">="]))
        margin = draw(st.sampled_from([0.0, 0.0, 0.1, 1e-9, 1e300]))
        found.append(Compared(*form, relation, draw(literals(draw(st.sampled_from(run)))), margin))
    return name, found, run


def specification(name: str, compared: list[Compared]) -> tuple[list[Compiled], Specification]:
    lines = [f"decl x /x {name}.data", *(f"never {c}" for c in compared)]
    return from_text("\n".join(lines))


Answers = list[bool]
"""Of each property, whether it is violated."""


def live(name: str, found: list[Compiled], spec: Specification, run_: list[Any], wire: Callable[[Any], Any]) -> Answers:
    """What an emitted node says of messages, each after it has gone through `wire`."""
    node = load(emit("ros2", found, spec), "emitted")
    (topic,) = node["topics_to_read"]()
    session = node["Session"](node["plan"]())
    rows = node["ByRows"](session)
    for time, value in enumerate(run_):
        message = wire(MESSAGES.build(f"std_msgs/msg/{name}", {("data",): value}))
        rows.message(time, topic.name, node["unpacked"](topic.read(message)))
    return [track.verdict.value == "violated" for track in session.tracks]


def recorded(file: str, content: str, found: list[Compiled], spec: Specification) -> Answers:
    with TemporaryDirectory() as folder:
        path = Path(folder) / file
        path.write_text(content)
        report = run(found, spec, path)
    assert report.session is not None, report.diagnostics
    return [track.verdict.value == "violated" for track in report.session.tracks]


def standalone(found: list[Compiled], run_: list[Any]) -> Answers:
    module = emitted(found)
    monitors = [module[written.name]() for written in standalone_classes(found, "props.txt")]
    return [[monitor.step(x=value).value for value in run_][-1] == "violated" for monitor in monitors]


@settings(max_examples=15, deadline=None)
@given(cases())
def test_live_recorded_and_emitted_agree_with_exact_arithmetic(case: tuple[str, list[Compared], list[Any]]) -> None:
    name, compared, run_ = case
    code = CODES[name]
    found, spec = specification(name, compared)
    expected = [any(c.holds(value, code) for value in run_) for c in compared]
    assert live(name, found, spec, run_, lambda message: message) == expected
    assert standalone(found, run_) == expected
    short = [f"{value:.9g}" if code == "f" else repr(value) for value in run_]
    for cells in (short, [repr(value) for value in run_]):
        csv = "".join(f"{time},{cell}\n" for time, cell in enumerate(cells))
        assert recorded("run.csv", f"time,x\n{csv}", found, spec) == expected
    lines = "".join(f'{{"time": {time}, "x": {json.dumps(value)}}}\n' for time, value in enumerate(run_))
    assert recorded("run.jsonl", lines, found, spec) == expected


@pytest.mark.ros
@pytest.mark.parametrize("name", sorted(CODES))
def test_what_rclpy_makes_of_the_bytes_is_what_the_types_say(name: str) -> None:
    serialization = pytest.importorskip("rclpy.serialization")

    def wire(message: Any) -> Any:
        return serialization.deserialize_message(serialization.serialize_message(message), type(message))

    @settings(max_examples=4, deadline=None)
    @given(st.data())
    def agree(data: st.DataObject) -> None:
        run_ = data.draw(st.lists(values(name), min_size=1, max_size=4))
        literal = data.draw(literals(data.draw(st.sampled_from(run_))))
        compared = [Compared("x", lambda x: x, relation, literal) for relation in ("<", "==", ">")]
        found, spec = specification(name, compared)
        expected = [any(c.holds(value, CODES[name]) for value in run_) for c in compared]
        assert live(name, found, spec, run_, wire) == expected

    agree()


def test_arrays_hold_the_numbers_of_their_elements() -> None:
    text = """
    decl ids /ids UInt64MultiArray.data
    decl scan /scan LaserScan.ranges
    never max(ids) == 9007199254740993
    never ids[1] == 9007199254740993
    never min(scan) >= 0.3
    never scan[0] == 0.3
    """
    found, spec = from_text(text)
    node = load(emit("ros2", found, spec), "emitted")
    session = node["Session"](node["plan"]())
    rows = node["ByRows"](session)
    big = (2**53, 2**53 + 1)
    said: dict[str, array[Any]] = {"/ids": array("Q", big), "/scan": array("f", [0.3])}
    for topic in node["topics_to_read"]():
        field = "data" if topic.name == "/ids" else "ranges"
        message = MESSAGES.build(topic.message, {(field,): tuple(said[topic.name])})
        rows.message(0, topic.name, node["unpacked"](topic.read(message)))
    assert all(track.verdict.value == "violated" for track in session.tracks)
    line = {"time": 0, "ids": big, "ids[1]": big[1], "scan": [0.3], "scan[0]": 0.3}
    assert recorded("run.jsonl", json.dumps(line), found, spec) == [True] * 4
