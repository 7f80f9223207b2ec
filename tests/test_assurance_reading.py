"""Reading back: emitted text is accepted as it is, and refused once it does anything else, by state and letter."""

from __future__ import annotations

import random
import re
import subprocess
import sys
from collections.abc import Callable
from itertools import islice
from typing import Any, TypeVar

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from read_mutants import read_back, read_in_time, text_mutants, verdicts_of
from stepping import from_text, machines, samples, specification
from test_assurance_time import KINDS, Kind
from timed import Draw
from timed import compiled as compiled_in_time
from timed_mutants import class_text, code_differs

from ltlc.assurance.gate import Subject, judge, judge_all
from ltlc.assurance.messages import Messages
from ltlc.assurance.programs import programs
from ltlc.assurance.reading.files import Written, written
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.automata import Budget
from ltlc.backends import emit
from ltlc.backends.python import standalone_classes
from ltlc.compiler import Compiled
from ltlc.inputs.messages.definitions import MessageTypes, shipped
from ltlc.specification.expressions import Signal

Found = TypeVar("Found")

D, V, B = "decl d /d Float32.data\n", "decl v /v Float64.data\n", "decl b /b Bool.data\n"
TEXTS = {
    "stop sign": D + V + "after_until d < 1, d > 3, eventually v =={0.01} 0",
    "between": D + V + "after d > v and v > 1, eventually d - 1 =={0.5} v or not d + v =={0.1} 3",
    "margins": D + V + "never v >{0.1} 2 or d <{0.1} v",
    "arithmetic": V + "after v > 1, eventually 1 / v > 3 or sqrt(v) + v * 2 > 1 or v / 3 < -v",
    "history": D + V + "never v - @{v, -2} > 0.2 or @{d, -1} == @{v, -1}",
    "wide integers": "decl id /i UInt64.data\n" + V + "never id == 9007199254740993 or id * 2 > v or min(id, 3) == 3",
    "strings": 'decl mode /m String.data\nuntil mode in {"done", "off"}, mode != "fault"',
    "elements": "decl scan /scan LaserScan.ranges\n" + V + "never any(scan < 0.3) or count(not scan > v) >= 3",
    "combinations": "decl scan /scan LaserScan.ranges\ndecl ids /ids std_msgs/Int64MultiArray.data\n"
    + V
    + "never any(scan - v < ids over (scan), (ids)) or count(scan < ids over (ids), (scan)) >= 3",
    "arrays": "decl scan /scan LaserScan.ranges\nalways min(scan[2:]) > 0.3 and sum(scan) < 9 and len(scan) > 2",
    "parallel": "decl sec /s action_msgs/GoalStatusArray.status_list[].goal_info.stamp.sec\n"
    "decl state /s action_msgs/GoalStatusArray.status_list[].status\nnever any(sec == 3 and not state in {4, 5})",
    "opening": B + D + V + "after_until b, v > 3, always d <= @{d, opening} + 0.1",
    "opening in time": B + D + "after_until b, d > 9, always d > @{d, opening} for 3 s",
    "response": B + V + "always (b implies eventually v > 1 within 5 s)",
    "age": V + "never age(v) > 2 s",
    "age beside values": D + V + "always (age(v) > 2 s implies v < d)",
    "news": B + V + "always (new v implies once b within 3 s)",
    "past": B + V + "always (previously b implies historically v > 1 for 2 s)",
    "two clocks": B + D + "(always eventually b within 3 s) and (always eventually d > 2 within 7 s)",
    "counts": B + V + "always (not once v > 1 3 times within 2 s or once new b 2 times)",
    "rate": B + V + "always (rate(v) >= 4 Hz over 1 s or b)",
    "decided": V + "always v >= 0 or v < 0",
    "never before": V + "decl u /u UInt8.data\nalways (v > 0 implies previously u < u)",
    "never soon": V + "decl u /u UInt8.data\nafter v > 0, eventually u > 300 within 1 s",
    "never old": V + "decl u /u UInt8.data\nafter u < u, always age(v) < 1 s",
    "many states": "".join(f"decl l{n} /l{n} Bool.data\n" for n in range(4))
    + " and ".join(f"(eventually l{n})" for n in range(4)),
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_emitted_classes_are_read_back_as_their_monitors(text: str) -> None:
    compiled, whole = from_text(text)
    assert all(isinstance(found, ReadBack) for found in read_back(emit("python", compiled, whole), compiled))


def test_an_emitted_node_is_read_back_as_its_monitors() -> None:
    declared = dict.fromkeys(line for text in TEXTS.values() for line in text.split("\n")[:-1])
    names = {line.split()[1]: line for line in declared}
    properties = [text.split("\n")[-1] for text in TEXTS.values()]
    compiled, whole = from_text("\n".join([*names.values(), *(f"p{n}: {p}" for n, p in enumerate(properties))]))
    found = read_back(emit("ros2", compiled, whole), compiled)
    assert [str(each) for each in found if not isinstance(each, ReadBack)] == []
    assert len(found) == len(TEXTS)


@settings(max_examples=25)
@given(machines())
def test_any_machine_over_any_conditions_is_read_back(compiled: Compiled) -> None:
    text = emit("python", [compiled], specification([compiled]))
    assert [str(each) for each in read_back(text, [compiled]) if isinstance(each, Difference)] == []


@pytest.mark.parametrize("number", range(10))
def test_any_property_with_clocks_is_read_back(number: int) -> None:
    compiled = compiled_in_time(Draw(number).property(2, 2))
    assert isinstance(read_in_time(class_text(compiled), compiled), ReadBack)


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_no_change_of_a_class_with_clocks_that_alters_a_verdict_is_accepted(kind: Kind) -> None:
    compiled = compiled_in_time(kind(3))
    text = class_text(compiled)
    accepted = [
        mutant
        for mutant in islice(text_mutants(text, "Emitted", random.Random(0)), 12)
        if isinstance(read_in_time(mutant, compiled), ReadBack)
    ]
    assert [mutant for mutant in accepted if code_differs(compiled, mutant)] == []


@settings(max_examples=4)
@given(machines(), st.lists(samples(), min_size=4, max_size=4))
def test_no_change_of_a_class_that_alters_a_verdict_is_accepted(
    compiled: Compiled, drawn: list[dict[Signal, Any]]
) -> None:
    [made] = standalone_classes([compiled], "props.txt")
    chance = random.Random(0)
    frames = [{name: values[signal] for name, signal in made.parameters} for values in drawn]
    runs = [[chance.choice(frames) for _ in range(8)] for _ in range(10)]
    text = emit("python", [compiled], specification([compiled]))
    right = verdicts_of(text, made.name, runs)
    for mutant in islice(text_mutants(text, made.name, chance), 8):
        if verdicts_of(mutant, made.name, runs) != right:
            assert isinstance(read_back(mutant, [compiled])[0], Difference), mutant


STOP, RESPONSE, AGED, TWO = (TEXTS[name] for name in ("stop sign", "response", "age beside values", "two clocks"))
CHANGED = {
    "what infinity is": (
        TEXTS["stop sign"],
        "        if not d <= INFINITY",
        "        INFINITY = v\n        if not d <= INFINITY",
        "does not test for NaN",
    ),
    "a threshold": (
        STOP,
        "d > 3.0",
        "d > 3.0000000000000004",
        "in state 1, `d > 3.0000000000000004` is not a condition",
    ),
    "a successor": (
        STOP,
        "self.state = 3",
        "self.state = 0",
        "in state 1, `verdict` is VIOLATED instead of PRESUMABLY_SATISFIED in state 0",
    ),
    "a verdict": (
        STOP,
        "self.verdict = VIOLATED",
        "self.verdict = SATISFIED",
        "in state 3, the verdict is SATISFIED instead of VIOLATED",
    ),
    "a relation": (STOP, "if d < 1.0", "if d <= 1.0", "`d <= 1.0` is not a condition"),
    "a negation": (
        STOP,
        "-0.01 <= v <= 0.01",
        "not -0.01 <= v <= 0.01",
        "in state 0, a step does something else",
    ),
    "an invalid step": (
        STOP,
        "not d <= INFINITY or not v <= INFINITY",
        "not d <= INFINITY",
        "what makes a step invalid",
    ),
    "what it answers": (
        STOP,
        "return self.verdict\n\n\nclass",
        "return VIOLATED\n\n\nclass",
        "it does not return the verdict",
    ),
    "a duration": (RESPONSE, "time + 5_000_000_000", "time + 5_000_000_001", "in state 0, a step does something else"),
    "a clock that goes on": (
        RESPONSE,
        "PRESUMABLY_SATISFIED\n            self.due = NEVER",
        "PRESUMABLY_SATISFIED",
        "in state 0, a clock step that is due is not taken",
    ),
    "a clock step": (
        RESPONSE,
        "self.state = 2\n        self.verdict = VIOLATED",
        "self.state = 2",
        "in state 2, the verdict is",
    ),
    "a clock step not taken": (
        RESPONSE,
        "time > self.due:\n            self.expire()",
        "time > self.due:",
        "after a clock step, the step is not taken with",
    ),
    "a clock step that is not due": (RESPONSE, "if self.due >= NEVER:", "if self.due > NEVER:", "where none is due"),
    "another value": (RESPONSE, "return self.step(time, b, v)", "return self.step(time, v, b)", "is not taken with"),
    "a value at an opening": (
        TEXTS["opening"],
        "d if self.state == 0 else self._d_opening",
        "d if self.state == 2 else self._d_opening",
        "when it takes values at openings",
    ),
    "what is kept": (
        TEXTS["opening"],
        "self._d_opening = d_opening",
        "self._d_opening = d",
        "a value at an opening is not kept",
    ),
    "a sample": (TEXTS["history"], "v_2_ago = self._v[-3]", "v_2_ago = self._v[-2]", "is not as long as"),
    "samples that are not there": (
        TEXTS["history"],
        "len(self._v) < 3",
        "len(self._v) < 2",
        "may be read that are not there",
    ),
    "a double": (TEXTS["arithmetic"], "v = number(v)", "v = v", "does not occur in emitted functions"),
    "an integer made a double": (
        TEXTS["wide integers"],
        "float(id_2) * 2.0",
        "id_2 * 2.0",
        "is not in the table of functions",
    ),
    "a value beside elements": (
        TEXTS["elements"],
        "if not v <= INFINITY",
        "if not float(sum(1 for each_scan in scan if each_scan <= INFINITY and each_scan <= v)) <= INFINITY",
        "what makes a step invalid",
    ),
    "an array compared": (
        TEXTS["arrays"],
        "    if not value <= INFINITY",
        "    if not scan <= INFINITY or not value <= INFINITY",
        "`not(measured(scan))` computes with an unsuitable operand",
    ),
    "which elements count": (TEXTS["elements"], "each_scan <= v", "each_scan < v", "is not a condition"),
    "the session": (
        TEXTS["age"],
        "session + 2_000_000_000",
        "session + 2_000_000_00",
        "`due_0` is session + 200000000",
    ),
    "an age": (
        TEXTS["age"],
        "due_0 = time + 2_000_000_000",
        "due_0 = time + 2_000_000",
        "`due_0` is session + 2000000000 instead of",
    ),
    "when an age is late": (
        TEXTS["age"],
        "if time <= self.due_0:",
        "if time > self.due_0:",
        "`due = due_0` is not an outcome of a decision",
    ),
    "an age at a step without one": (
        TEXTS["age beside values"],
        "self.due = time - 1",
        "self.due = time",
        "does more than renew ages",
    ),
    "an age that NaN leaves late": (
        TEXTS["age beside values"],
        "if time > self.due_0 and",
        "if time <= self.due_0 and",
        "does more than renew ages",
    ),
    "news that is over": (
        TEXTS["news"],
        "self.due = time\n",
        "self.due = self.due_0\n",
        "in state 0, a step does something else",
    ),
    "a due time that is over": (
        TEXTS["news"],
        "            else:\n                self.due = self.due_0\n        elif state == 1:",
        "        elif state == 1:",
        "`due` keeps its value",
    ),
    "a clock step after the last verdict": (
        AGED,
        "        elif state == 1:  # violated\n            self.due = NEVER\n        elif state == 2:"
        "  # presumably satisfied\n            if time",
        "        elif state == 2:  # presumably satisfied\n            if time",
        "after a permanent verdict",
    ),
    "an end in the midst": (STOP, "self.state = 3", "return self.verdict", "is not an outcome of a decision"),
    "a method": (STOP, "self.state = 0\n        return", "self.spoil()\n        return", "`spoil` is not called so"),
    "an attribute": (STOP, "self.state = 3", "self.stat = 3", "`stat = 3` is not an outcome of a decision"),
    "a due time": (RESPONSE, "time + 5_000_000_000", "time * 5_000_000_000", "which is not a due time"),
    "the first verdict": (
        STOP,
        "if state == 0:  # presumably satisfied\n            self.verdict = PRESUMABLY_SATISFIED",
        "if state == 0:",
        "the first step sets no verdict",
    ),
    "a clock twice": (
        RESPONSE,
        "self.due = time + 5_000_000_000",
        "self.due = time + 5_000_000_000; self.due = time + 5_000_000_000",
        "a clock is set twice",
    ),
    "the first clock to be due": (
        TWO,
        "self.due_0 = time + 3_000_000_000\n                self.due = min(self.due_0, self.due_1)",
        "self.due_0 = time + 3_000_000_000",
        "`due` is not min(due_0, due_1)",
    ),
    "another clock to be due": (
        TWO,
        "min(self.due_0, self.due_1)",
        "self.due_0",
        "is due_0 instead of min(due_0, due_1)",
    ),
    "the time of a clock step": (TWO, "time = self.due + 1", "time = self.due", "`due` has no value"),
    "elements as they come": (
        TEXTS["elements"],
        "scan = elements_of(scan)",
        "pass",
        "does not occur in emitted functions",
    ),
    "elements that are not taken apart": (
        TEXTS["elements"],
        "        scan = elements_of(scan)\n",
        "",
        "is not converted",
    ),
    "integers that elements may be": (
        TEXTS["arrays"],
        "doubles_of(scan)",
        "elements_of(scan)",
        "before its operands are",
    ),
    "is not the right value at an opening": (
        TEXTS["opening"],
        "else self._d_opening",
        "else d",
        "is not the right value at an opening",
    ),
    "a further value at an opening": (
        TEXTS["opening"],
        "self._d_opening: float",
        "self._d_opening: float\n        self._e: float",
        "a value at an opening is not taken",
    ),
    "an age that a step without one leaves late": (
        AGED,
        "            if time > self.due_0 and self.verdict is not NOT_STARTED:\n                self.due = time - 1\n",
        "",
        "does not renew an age that is late",
    ),
    "one of two ages": (
        D + V + "always (age(v) < 2 s or age(d) < 3 s or v > d)",
        "            if time > self.due_1 and self.verdict is not NOT_STARTED:\n                self.due = time - 1\n",
        "",
        "some messages renew ages that are late",
    ),
    "a double that is none": (
        B + V + "never b and v + 1 > 2",
        "if type(v) is not float:\n            v = number(v)",
        "b = number(b)",
        "`b` must not be made a double",
    ),
    "an integer that is none": (
        "decl id /i UInt64.data\n" + V + "never id > 3 and v + 1 > 2",
        "if type(v) is not float:\n            v = number(v)",
        "id_2 = number(id_2)",
        "`id_2` must not be made a double",
    ),
    "an array that is none": (
        "decl scan /scan LaserScan.ranges\n" + V + "never any(scan < 0.3) and v + 1 > 2",
        "if type(v) is not float:\n            v = number(v)",
        "v = elements_of(v)",
        "`v` must not be converted by `elements_of`",
    ),
    "the value of another signal": (TEXTS["opening"], "= d if self.state", "= b if self.state", "is taken elsewhere"),
    "what a step that is none does": (
        STOP,
        "            self.invalid += 1\n",
        "            self.invalid += 1\n            self.state = 1\n",
        "an invalid step does more than it should",
    ),
    "the beginning": (STOP, "self.invalid = 0", "self.invalid = 1", "a monitor begins differently"),
    "the beginning twice": (
        STOP,
        "self.invalid = 0",
        "self.invalid = 0; self.invalid = 0",
        "the function that initialises a monitor differs",
    ),
    "a name that is set": (STOP, "        if not d <=", "        d = v\n        if not d <=", "`d` is set again"),
    "a clock that hides a method": (TWO, "due_1", "expire", "an attribute has the name of something else"),
    "a function": (TEXTS["arithmetic"], "if right != 0:", "if right >= 0:", "the function `divide` is not that of"),
    "a name": (STOP, "INFINITY = math.inf", "INFINITY = 1e308", "`INFINITY` is not a constant of a monitor"),
    "a second name": (STOP, "INFINITY = math.inf", "INFINITY = math.inf\nINFINITY = math.inf", "defined twice"),
    "the order of verdicts": (
        STOP,
        "VIOLATED, PRESUMABLY_VIOLATED, PRESUMABLY_SATISFIED",
        "PRESUMABLY_VIOLATED, VIOLATED, PRESUMABLY_SATISFIED",
        "instead of",
    ),
    "what all are given": (STOP, ".step(d, v)", ".step(v, d)", "does not receive the inputs of its monitors"),
    "a class": (STOP, "class Line3:", "class Line3(dict):", "contains more than its methods"),
    "a slot that is missing": (
        STOP,
        '("invalid", "state", ',
        '("invalid", ',
        "the slots of `Line3` are not the attributes",
    ),
    "a slot too many": (
        STOP,
        '("invalid", ',
        '("__dict__", "invalid", ',
        "the slots of `Line3` are not the attributes",
    ),
    "a slot that is no text": (STOP, '("invalid", ', '("invalid", 1, ', "the slots of `Line3` are not the attributes"),
    "no slots": (STOP, '    __slots__ = ("invalid", "state", "verdict")\n', "", "the slots of `Line3` are not"),
    "a decorator": (
        STOP,
        "    def step(self, d: float, v: float) -> Verdict:",
        "    @staticmethod\n    def step(self, d: float, v: float) -> Verdict:",
        "are not plain",
    ),
}


@pytest.mark.parametrize(("text", "right", "wrong", "said"), CHANGED.values(), ids=CHANGED)
def test_a_changed_text_is_refused_and_the_change_is_named(text: str, right: str, wrong: str, said: str) -> None:
    compiled, whole = from_text(text)
    emitted = emit("python", compiled, whole)
    assert right in emitted
    (found,) = read_back(emitted.replace(right, wrong), compiled)
    assert isinstance(found, Difference)
    assert said in str(found)


TWO_MONITORS = V + B + "a: never v > 1\nb: always (b implies eventually v > 3 within 2 s)\n"
IN_MONITORS = {
    "one left out": ('            "a": self.a.step(v),\n', "", "does not step each monitor once"),
    "what one is made as": ("self.a = A()", "self.a = A", "creates something other than monitors"),
    "a label": ('"a": self.a.', '"c": self.a.', "`c` in `Monitors` is not `a`"),
    "labels exchanged": ('"a": self.a.', '"b": self.a.', "`b` in `Monitors` is not `a`"),
    "an invalid step": ('"a": self.a.step(v)', '"a": self.a.verdict', "does not step each monitor once"),
    "what a step is given": ("self.b.step(time, b, v)", "self.b.step(time, v, b)", "does not step each monitor once"),
    "what a method takes": (
        "    def advance(self, time:",
        "    def advance(self, now:",
        "does not receive the inputs of its monitors",
    ),
    "clock steps": ("            self.b.expire()", "            self.a.expire()", "does not take the clock steps"),
    "when clock steps are taken": (
        "while time > self.b.due",
        "while time >= self.b.due",
        "does not take the clock steps",
    ),
    "verdicts": ('"a": self.a.verdict', '"a": self.b.verdict', "does not return the verdict"),
    "what is answered": (
        'return {\n            "a": self.a.verdict',
        'return "a", {\n            "a": self.a.verdict',
        "does not return",
    ),
    "another class": ("class Monitors:", "class Monitors(dict):", "`Monitors` contains more than its methods"),
    "a method left out": (
        "    def step(self, time: int, v: float, b: bool) -> dict",
        "    def steps(self) -> dict",
        "has no `step`",
    ),
}


@pytest.mark.parametrize(("right", "wrong", "said"), IN_MONITORS.values(), ids=IN_MONITORS)
def test_what_steps_all_monitors_is_read_back(right: str, wrong: str, said: str) -> None:
    compiled, whole = from_text(TWO_MONITORS)
    emitted = emit("python", compiled, whole)
    assert right in emitted
    assert said in str(read_back(emitted.replace(right, wrong), compiled)[0])


def test_signals_that_change_their_names_are_refused() -> None:
    compiled, whole = from_text(STOP)
    changed = re.sub(r"\bd\b", "w", emit("python", compiled, whole))
    assert "`w` of `Line3` does not recall its signal" in str(read_back(changed, compiled)[0])


def test_news_that_is_over_is_not_asked_for() -> None:
    compiled, whole = from_text(TEXTS["news"])
    text = emit("python", compiled, whole)
    for right, wrong in (
        (
            "        return self.verdict\n\n    def",
            "        self._values = (new_v,)\n        return self.verdict\n\n    def",
        ),
        ("        time = self.due + 1\n", "        time = self.due + 1\n        (new_v,) = self._values\n"),
        ("            if time > self.due_0:", "            if new_v:"),
    ):
        assert right in text
        text = text.replace(right, wrong)
    assert "`new_v` is evaluated after the news is over" in str(read_back(text, compiled)[0])


NODE = V + "never age(v) > 2 s\nslow: never v > 1\n"
IN_PLANS = {
    "inputs": ('inputs=(Input("v"),)', 'inputs=(Input("v", 1),)', "`slow` does not receive what it reads"),
    "ages": (
        'Age("v", "due_0", 2000000000)',
        'Age("v", "due_0", 200000000)',
        "`due_0` is session + 2000000000 instead of",
    ),
    "what a step takes": (
        "def step(self, v: float)",
        "def step(self, v: float, w: float)",
        "a step takes 2 values, not 1",
    ),
    "its text": ('text="never v > 1"', 'text="never v > 2"', "`slow` does not receive what it reads"),
    "how old": ('Age("v", "due_0", 2000000000)', 'Age("v", 2000000000)', "is not an age"),
    "the monitor": ("monitor=Slow", "monitor=Verdict", "the class `Verdict` contains more than its methods"),
}


IN_SIGNALS = {
    "what computes one": (
        "robot_position_x - 10.0",
        "robot_position_x - 11.0",
        "does not compute `robot.distance",
    ),
    "what it does": (
        "    return norm",
        "    robot_position_y = 0.0\n    return norm",
        "does more than compute a signal",
    ),
    "what it is given": (
        '(Input("robot.position.x"), Input("robot.position.y")),',
        '(Input("robot.position.x"),),',
        "does not receive",
    ),
    "a topic": ('x", "/model/robot/odometry"', 'x", "/odometry"', "`robot.position.x` is read from the wrong place"),
    "a type": ('odometry", "number"', 'odometry", "integer"', "`robot.position.x` is read from the wrong place"),
    "one left out": (
        '            Reading("robot.position.y", "/model/robot/odometry", "number"),\n',
        "",
        "does not receive what it is computed from",
    ),
    "the last left out": (
        "            Derived(\n",
        '            Reading("robot.position.x", "/model/robot/odometry", "number"),\n            Derived(\n',
        "`robot.position.x` occurs twice",
    ),
}


@pytest.mark.parametrize(("right", "wrong", "said"), IN_SIGNALS.values(), ids=IN_SIGNALS)
def test_what_a_node_reads_and_computes_is_read_back(right: str, wrong: str, said: str) -> None:
    declared = "model robot:\n    position /odom Odometry.pose.pose.position\n;\nobject sign at (10, 0, 0)\n"
    compiled, whole = from_text(declared + "never robot.distance.sign < 1 or robot.position.x > 3")
    emitted = emit("ros2", compiled, whole)
    assert right in emitted
    assert isinstance(read_back(emitted, compiled)[0], ReadBack)
    assert said in str(read_back(emitted.replace(right, wrong), compiled)[0])


@pytest.mark.parametrize(("right", "wrong", "said"), IN_PLANS.values(), ids=IN_PLANS)
def test_what_a_node_gives_its_monitors_is_read_back(right: str, wrong: str, said: str) -> None:
    compiled, whole = from_text(NODE)
    emitted = emit("ros2", compiled, whole)
    assert right in emitted
    found = read_back(emitted.replace(right, wrong), compiled)
    assert any(said in str(each) for each in found)


def parsed(found: Found) -> Callable[[], Found]:
    return lambda: found


def test_the_gate_refuses_what_is_not_read_back() -> None:
    [compiled], whole = from_text(STOP)
    emitted = emit("python", [compiled], whole)
    messages = Messages(MessageTypes(shipped()))
    found = programs("python", emitted, [compiled], whole, messages)
    assert found is not None
    wrong = emitted.replace("elif state == 2 and d > 3.0", "elif state == 2 and d > 3.5")
    for text, passes in ((emitted, True), (wrong, False)):
        (part,) = written(text, [compiled.machine], [compiled.specification])
        assert isinstance(part, Written)
        judgement = judge(Subject(compiled, found[0], parsed(part)), messages)
        assert judgement.passed is passes
        assert isinstance(judgement.reading, ReadBack) is passes
        (same,) = judge_all([compiled], found, messages, Budget(seconds=60.0), written=parsed([part]))
        assert same == judgement


def test_reading_back_shares_nothing_with_what_writes() -> None:
    program = "import sys, ltlc.assurance.reading.files; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()
    foreign = ("ltlc.backends", "ltlc.automata", "ltlc.compiler", "spot", "jinja2")
    assert [module for module in loaded if module.startswith(foreign)] == []


def test_a_name_that_some_function_binds_anew_is_refused() -> None:
    compiled, whole = from_text(STOP)
    text = emit("python", compiled, whole) + "\n\ndef spoil() -> None:\n    global INFINITY\n    INFINITY = 0.0\n"
    assert "`INFINITY` is defined twice" in str(read_back(text, compiled)[0])
