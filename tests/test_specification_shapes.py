"""Shapes: what is equal but for names has one, and nothing else; what is judged for one goes for all of it."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from language_support import compiled as specified

from ltlc import backends, cli
from ltlc.analysis.analyse import analyse
from ltlc.analysis.subjects import Study
from ltlc.assurance import exactness, gate
from ltlc.assurance.messages import Messages
from ltlc.assurance.programs import programs
from ltlc.assurance.shapes import renamed_certificate, shape_of
from ltlc.automata import Budget
from ltlc.base.limits import run_all
from ltlc.compiler import Compiled, compile_specification
from ltlc.inputs.messages.definitions import MessageTypes, shipped
from ltlc.semantics.certificate import Certificate, check
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.ltl import Atom
from ltlc.specification.shapes import Shape
from ltlc.specification.specification import Specification

BUDGET = Budget(seconds=60.0, megabytes=1024)

FLEET = (
    "stop: forall r in {robot1, robot2, robot3}: "
    "after_until r.distance.sign < 1, r.distance.sign > 3, eventually r.velocity < 0.01"
)


def compile_text(text: str) -> tuple[Specification, list[Compiled]]:
    specification = specified(text)
    compiled, problems = compile_specification(specification, EPISODE, BUDGET)
    assert not problems
    return specification, compiled


def keys(text: str) -> list[Any]:
    return [shape_of(each).key for each in compile_text(text)[1]]


@pytest.mark.parametrize(
    "text",
    [
        FLEET,
        "forall r in {a, b}: always r.orientation.yaw < 1 and r.distanceZ.sign > 2",
        "_simulator_ = tf\nforall r in {a, b}: never r.velocity > 2",
        "decl x1 /x Bool.data decl x2 /y Bool.data\nforall k in {x1, x2}: always eventually new k within 2 s",
        'decl m1 /a String.data decl m2 /b String.data\nforall m in {m1, m2}: always m == "IDLE"',
        "decl p1 /a Point decl p2 /b Point\nforall p in {p1, p2}: always age(p) < 1 s and p.x < 2",
    ],
)
def test_properties_that_differ_in_names_only_have_one_shape(text: str) -> None:
    assert len(set(keys(text))) == 1


NUMBERS = (
    "decl a /a Float64.data decl b /b Float64.data decl i /i Float32.data decl s /s String.data decl t /t String.data\n"
)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("never a > 2", "never b > 3"),
        ("never a > 2", "never b >= 2"),
        ("never a * 0 > 1", "never b * -0 > 1"),
        ("never a > 2", "always a > 2"),
        ("never a > 2", "never i > 2"),
        ("never a == 2", "never b =={0.1} 2"),
        ("never a + b > 2", "never a + a > 2"),
        ("never (a > 2 and b > 2)", "never (a > 2 and a > 3)"),
        ("never (a > 1 and @{a, -1} > 1)", "never (b > 1 and @{b, -2} > 1)"),
        ('never s == "X"', 'never t == "Y"'),
        ("eventually a > 2 within 1 s", "eventually b > 2 within 2 s"),
        ("never p.velocity > 1", "never p.velocity_angular > 1"),
        ("never p.distance.q > 1", "never p.distanceZ.q > 1"),
        ("never robot.position.x > 1", "never robot.position.y > 1"),
    ],
)
def test_properties_that_differ_in_more_have_different_shapes(one: str, other: str) -> None:
    first, second = keys(f"{NUMBERS}x: {one}\ny: {other}")
    assert first != second


def function(code: str) -> Callable[..., Any]:
    names: dict[str, Any] = {}
    exec(code, names)
    found: Callable[..., Any] = names["f"]
    return found


def key(*values: Any, names: str = "") -> Any:
    shape = Shape()
    for name in names.split():
        shape.add(Atom(name))
    for value in values:
        shape.add(value)
    return shape.key


def test_code_has_the_shape_of_code_that_is_called_otherwise() -> None:
    one = function("def f(x, y):\n    'One.'\n    return x < 1 and y.real > 2.5")
    two = function("def f(v, w):\n    'Two, which is longer.'\n    return v < 1 and w.real > 2.5")
    assert key(one) == key(two)


@pytest.mark.parametrize(
    "other",
    [
        "def f(x, y): return x < 2 and y.real > 2.5",
        "def f(x, y): return x < 1.0 and y.real > 2.5",
        "def f(x, y): return x <= 1 and y.real > 2.5",
        "def f(x, y): return x < 1 or y.real > 2.5",
        "def f(x, y): return x < 1 and y.imag > 2.5",
        "def f(y, x): return x < 1 and y.real > 2.5",
        "def f(x, y=1): return x < 1 and y.real > 2.5",
        "def f(x, y): return x < 1 and y.real > -2.5",
    ],
)
def test_code_that_does_something_else_has_another_shape(other: str) -> None:
    assert key(function("def f(x, y): return x < 1 and y.real > 2.5")) != key(function(other))


def test_private_attributes_may_be_called_otherwise_but_private_functions_not() -> None:
    one, two = (function(f"def f(x):\n    x._{name} = 1\n    return x._{name}") for name in ("left", "right"))
    assert key(one) == key(two)
    assert key(one) != key(function("def f(x):\n    x._left = 1\n    return x._right"))
    one, two = (function(f"def _a(): ...\ndef _b(): ...\ndef f(): return _{name}()") for name in "ab")
    assert key(one) != key(two)


def test_a_name_in_code_is_that_of_the_specification() -> None:
    one, two = (function(f"def f(x): return x == '{name}'") for name in ("robot1", "robot2"))
    assert key(one) != key(two)
    assert key(one, names="robot1") == key(two, names="robot2")
    assert key(one, names="robot1 robot2") != key(two, names="robot1 robot2")


def test_a_text_that_is_a_name_elsewhere_stands_for_itself() -> None:
    text = 'decl r1 /r1 String.data decl r2 /r2 String.data decl o /o String.data\n{}: always {} == "r1"\n'
    one, two = keys("".join([text.format("x", "r1"), 'y: always r2 == "r1"']))
    assert one != two


@pytest.mark.parametrize("target", ["python", "ros2"])
def test_a_fault_in_the_code_of_one_copy_is_found_in_that_copy(target: str) -> None:
    specification, compiled = compile_text(FLEET)
    text = backends.emit(target, compiled, specification)
    start = text.index("class StopRobot3")
    wrong = text[:start] + re.sub(r"robot3_velocity < 0\.01", "robot3_velocity < 0.02", text[start:], count=1)
    assert wrong != text
    messages = Messages(MessageTypes(shipped()))
    judged = gate.judge_all(compiled, programs(target, wrong, compiled, specification, messages), messages, BUDGET)
    assert [isinstance(each, gate.Judgement) and each.passed for each in judged] == [True, True, False]


def test_a_fault_in_the_monitor_of_one_copy_is_found_in_that_copy() -> None:
    _, (one, two, three) = compile_text(FLEET)
    wrong = replace(two, monitor=replace(two.monitor, edges=two.monitor.edges[::-1]))
    judged = gate.judge_all([one, wrong, three], None, Messages(MessageTypes(shipped())), BUDGET)
    assert [isinstance(each, gate.Judgement) and each.passed for each in judged] == [True, False, True]


def test_only_one_of_a_shape_is_judged_and_its_certificate_is_that_of_each(monkeypatch: pytest.MonkeyPatch) -> None:
    _, compiled = compile_text(FLEET)
    jobs: list[int] = []

    def counted(some: Sequence[Callable[[], Any]], *args: Any, **kwargs: Any) -> Any:
        jobs.append(len(some))
        return run_all(some, *args, **kwargs)

    monkeypatch.setattr(gate, "run_all", counted)
    judged = gate.judge_all(compiled, None, Messages(MessageTypes(shipped())), BUDGET)
    assert sum(jobs) == 3, "the monitor of one property, its code as it runs and as it is written"
    for each, judgement in zip(compiled, judged, strict=True):
        assert isinstance(judgement, gate.Judgement)
        assert isinstance(judgement.certificate, Certificate)
        assert judgement.certificate == exactness.checked_certificate(each)
        assert check(judgement.certificate).exact


def test_a_certificate_that_is_not_about_a_property_is_not_renamed_to_it() -> None:
    _, (one, two) = compile_text("decl a /a Bool.data decl b /b Bool.data\nx: eventually a\ny: always b")
    certificate = exactness.checked_certificate(one)
    assert isinstance(certificate, Certificate)
    assert renamed_certificate(certificate, {"a": "a"}, one) == certificate
    assert renamed_certificate(certificate, {"a": "b"}, two) is None
    assert renamed_certificate(certificate, {"a": "b"}, one) is None


def test_certificates_of_copies_are_accepted_when_they_are_read_again(tmp_path: Path) -> None:
    path, certificates = tmp_path / "props.txt", tmp_path / "certificates"
    path.write_text(
        FLEET + "\nsoon: forall r in {a, b}: always (r.velocity > 1 implies eventually r.velocity < 1 within 2 s)"
    )
    assert cli.main(["build", str(path), "-o", str(tmp_path / "out"), "--certificate", str(certificates)]) == 0
    assert cli.main(["certify", str(path), str(certificates)]) == 0


FOUND = """
decl e1 /e1 Bool.data
decl e2 /e2 Bool.data
lax: forall r in {robot1, robot2, robot3}: after_until r.velocity > 1, r.velocity > 0, eventually r.position.x > 2
one: forall r in {robot1, robot2, robot3}: never r.position.y > 2
two: forall r in {robot1, robot2, robot3}: never r.position.y > 3
odd: never robot3.position.y > 4
good: forall r in {s1, s2}: eventually r.velocity > 2
bad: forall e in {e1, e2}: always e and eventually not e
"""


def test_what_is_found_by_shape_is_what_is_found_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    by_shape = analyse(specified(FOUND), EPISODE, BUDGET).diagnostics
    monkeypatch.setattr(Study, "shape", lambda *_: None)
    assert {d.code for d in by_shape} >= {"LTL501", "LTL510", "LTL602"}
    assert by_shape == analyse(specified(FOUND), EPISODE, BUDGET).diagnostics
