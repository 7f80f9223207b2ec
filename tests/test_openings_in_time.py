"""Values at the opening of scopes that open between steps: by definition, in all that judges, and in the gate."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from c_mutants import read_back as read_c_back
from c_mutants import with_source
from columns_support import state
from hypothesis import given, settings
from hypothesis import strategies as st
from openings_support import by_c, by_python, by_rows_and_columns, drawn
from read_mutants import read_back
from replaying import MESSAGES, judged, outcomes
from stepping import emitted, from_text

from ltlc import cli
from ltlc.assurance.c_library import Library, compiler
from ltlc.assurance.c_programs import c_programs
from ltlc.assurance.compiled_program import VERDICTS
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.replay import Deviation, Replayed
from ltlc.backends import emit as emit_text
from ltlc.backends.c import emit
from ltlc.backends.python import standalone_classes

PATH = compiler()
needs_compiler = pytest.mark.skipif(PATH is None, reason="there is no C compiler here")

SIGNALS = "decl a /a Float64.data\ndecl b /b Bool.data\ndecl d /d Bool.data\n"
REOPENED = "after_until b, new d, never @{a, opening} < 1"
EPISODE = "after_until b, b and not previously b, always a =={0.1} @{a, opening}"
BY_ITSELF = "after_until b, new d or a != @{a, opening}, eventually within 1 s, never b"
SECOND = 10**9
Rows = list[tuple[float, dict[str, Any]]]
EXAMPLES: dict[str, tuple[str, Rows, list[tuple[int, str]]]] = {
    "the value held where it reopens violates it": (
        REOPENED,
        [(0, {"a": 2.0, "b": True}), (1, {"a": 0.0, "d": True})],
        [(SECOND, "presumably_satisfied"), (SECOND + 1, "violated"), (4 * SECOND, "violated")],
    ),
    "that of the episode before does not": (
        EPISODE,
        [
            (0, {"b": True, "a": 1.0}),
            (1, {"b": False, "a": 1.0}),
            (2, {"b": True, "a": 5.0}),
            (3, {"b": False, "a": 5.0}),
        ],
        [(2 * SECOND + 1, "presumably_satisfied"), (4 * SECOND, "presumably_satisfied")],
    ),
    "what closes it by comparing with the opening keeps it closed up to the next step": (
        "after_until b and once d within 9 s, a != @{a, opening}, never a > 1",
        [(0, {"a": 1.0, "b": True, "d": True}), (1, {"a": 2.0}), (2, {"d": True})],
        [(SECOND + 1, "presumably_satisfied"), (2 * SECOND - 1, "presumably_satisfied"), (2 * SECOND, "violated")],
    ),
    "with a bound, too": (
        "after_until b, new d, eventually a > @{a, opening} within 1 s",
        [(0, {"a": 2.0, "b": True}), (0.5, {"a": 3.0}), (1, {"a": 0.0, "d": True}), (1.5, {"a": 1.0})],
        [(SECOND, "presumably_satisfied"), (SECOND + 1, "presumably_violated"), (4 * SECOND, "presumably_satisfied")],
    ),
    "in a scope that the scope around it opens": (
        "after_until b, new d, after_until a > @{a, opening} - 1, a < 0, never @{a, opening} < 1",
        [(0, {"a": 2.0, "b": True}), (1, {"a": 0.0, "d": True})],
        [(SECOND, "presumably_satisfied"), (SECOND + 1, "violated")],
    ),
}


@pytest.mark.parametrize(("text", "rows", "said"), EXAMPLES.values(), ids=EXAMPLES)
def test_an_emitted_class_takes_the_value_that_is_held(text: str, rows: Rows, said: list[tuple[int, str]]) -> None:
    compiled, _ = from_text(SIGNALS + text)
    (written,) = standalone_classes(compiled, "props.txt")
    for time, verdict in said:
        monitor, values = emitted(compiled)[written.name](0), dict[str, Any]()
        for at, row in rows:
            if (now := round(at * SECOND)) > time:
                break
            values |= {"d": False, **row}
            monitor.step(now, **{name: (values | {"new d": "d" in row})[s.name] for name, s in written.parameters})
        while time > monitor.due:
            monitor.expire()
        assert monitor.verdict.value == verdict, time


@needs_compiler
@pytest.mark.parametrize(("text", "rows", "said"), EXAMPLES.values(), ids=EXAMPLES)
def test_emitted_c_takes_the_value_that_is_held(text: str, rows: Rows, said: list[tuple[int, str]]) -> None:
    compiled, specification = from_text(SIGNALS + text)
    assert PATH is not None
    library = Library(emit(compiled, specification), PATH)
    signals = {i.signal.name: i.signal for i in compiled[0].specification.inputs()}
    for time, verdict in said:
        monitors = library.monitors()
        for at, row in rows:
            if (now := round(at * SECOND)) > time:
                break
            sample = {signals[name]: value for name, value in row.items() if name in signals}
            assert monitors.step(now, sample, [f"/{name}" for name in row])
        assert monitors.advance(time)
        assert VERDICTS[monitors.show(0)[0]].value == verdict, time


@pytest.mark.parametrize("more", [[], ["--verdicts"]], ids=["columns", "rows"])
@pytest.mark.parametrize(("text", "rows", "said"), EXAMPLES.values(), ids=EXAMPLES)
def test_a_recording_takes_the_value_that_is_held(
    text: str,
    rows: Rows,
    said: list[tuple[int, str]],
    more: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("props.txt").write_text(SIGNALS + text)
    cells = (",".join([str(at), *(str(row.get(name, "")).lower() for name in "abd")]) for at, row in rows)
    Path("run.csv").write_text("\n".join(["time,a,b,d", *cells]) + "\n")
    for time, verdict in said:
        seconds = f"{time // SECOND}.{time % SECOND:09}"
        cli.main(["run", "props.txt", "run.csv", "--until", seconds, "--format", "json", *more])
        (property_,) = json.loads(capsys.readouterr().out)["properties"]
        assert property_["verdict"] == verdict, time


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32))
def test_random_properties_are_judged_as_defined_in_each_nanosecond(seed: int) -> None:
    chance = random.Random(seed)
    case = drawn(chance)
    said, wrong = by_python(case)
    assert wrong == [], case
    by_row, rows, columns = by_rows_and_columns(case, chance)
    assert by_row == said, case
    assert state(rows) == state(columns), case


@needs_compiler
@settings(max_examples=2, deadline=None)
@given(st.integers(0, 2**32))
def test_random_properties_are_judged_alike_in_c(seed: int) -> None:
    chance = random.Random(seed)
    cases = [drawn(chance) for _ in range(10)]
    assert PATH is not None
    for case, said in zip(cases, by_c(cases, PATH), strict=True):
        assert said == by_python(case)[0], case


PROPERTIES = {"reopened": REOPENED, "an episode": EPISODE}


def loads(text: str) -> Iterator[str]:
    """Emitted Python that takes the value at an opening at another instant than it does."""
    taking = list(re.finditer(r"\n +self\._a_opening = a(?=\n)", text))
    assert taking
    for found in taking:
        yield text[: found.start()] + text[found.end() :]
        yield text[: found.end() - 1] + "0.5" + text[found.end() :]
    ((shut, states),) = re.findall(r"(self\.state in \((.*)\))", text)
    numbers = list(map(int, states.split(", ")))
    for number in range(max(numbers) + 2):
        others = {*numbers} ^ {number}
        yield text.replace(shut, f"self.state in {(*sorted(others), 99)}")
    for found in re.finditer(r"\n( +)self\.due = NEVER", text[text.index("def expire") :]):
        at = text.index("def expire") + found.end()
        yield f"{text[:at]}\n{found[1]}self._a_opening = a{text[at:]}"


@pytest.mark.parametrize("property_", PROPERTIES.values(), ids=PROPERTIES)
def test_python_that_takes_a_value_at_another_instant_is_not_read_back(property_: str) -> None:
    compiled, whole = from_text(SIGNALS + "p: " + property_)
    text = emit_text("python", compiled, whole)
    assert isinstance(read_back(text, compiled)[0], ReadBack)
    mutants = list(loads(text))
    accepted = [mutant for mutant in mutants if not isinstance(read_back(mutant, compiled)[0], Difference)]
    assert len(accepted) < len(mutants) / 2
    for mutant in accepted:  # in states that are permanent, or that are none, nothing matters
        assert isinstance(outcomes(SIGNALS + "p: " + property_, "python", text, mutant)[0], Replayed), mutant


REOPENING = "self.state = 0\n                self._a_opening = a"
FAULTS = {
    "it is not taken where the scope reopens": (REOPENING, "self.state = 0"),
    "it is taken at the step that closes": ("self.state in (0, 3)", "self.state in (0, 1, 3)"),
    "it is not taken at a step after the scope has closed": ("self.state in (0, 3)", "self.state == 0"),
    "the scope opens without it": (REOPENING, "self.state = 1\n                self.due = NEVER"),
}


@pytest.mark.parametrize("target", ["python", "ros2"])
@pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS)
def test_the_replay_refuses_python_that_takes_a_value_at_another_instant(fault: tuple[str, str], target: str) -> None:
    (found,) = outcomes(SIGNALS + REOPENED, target)
    assert isinstance(found, Replayed)
    (found,) = outcomes(SIGNALS + REOPENED, target, *fault)
    assert isinstance(found, Deviation)


COMPARED = "after_until b, new d, never a < @{a, opening} - 1"
IN_C = {
    "it is not taken where the scope reopens": (
        REOPENED,
        "self->a_opening = self->a_opening_next;\n            self->held_1 = self->held_1_next;",
        "",
    ),
    "held conditions are not evaluated again": (REOPENED, "self->held_1 = self->held_1_next;", ""),
    "it is taken at the step that closes": (REOPENED, "self->state == 0 ||", "self->state == 1 || self->state == 0 ||"),
    "it is not taken at a step after the scope has closed": (
        REOPENED,
        "self->state == 0 || self->state == 3",
        "self->state == 0",
    ),
    "another value is taken": (COMPARED, "self->a_opening_next = a;", "self->a_opening_next = a_opening;"),
    "what is held is that of the value before": (
        REOPENED,
        "self->held_1_next = a < 1.0;",
        "self->held_1_next = a_opening < 1.0;",
    ),
}


@pytest.mark.parametrize(("text", "right", "wrong"), IN_C.values(), ids=IN_C)
def test_c_that_takes_a_value_at_another_instant_is_refused(text: str, right: str, wrong: str) -> None:
    compiled, whole = from_text(SIGNALS + text)
    files = emit(compiled, whole)
    assert isinstance(read_c_back(files, compiled)[0], ReadBack)
    assert right in files.source
    changed = with_source(files, files.source.replace(right, wrong))
    assert isinstance(read_c_back(changed, compiled)[0], Difference)
    if PATH is None:
        return
    found = c_programs(changed, compiled, whole, MESSAGES)
    assert found is not None
    assert isinstance(judged(compiled[0], found[0]), Deviation)


def test_an_episode_that_the_end_of_news_opens_is_counted() -> None:
    found = outcomes(SIGNALS + "after_until b, new d, never a < 1", "ros2")
    assert all(isinstance(each, Replayed) for each in found)
