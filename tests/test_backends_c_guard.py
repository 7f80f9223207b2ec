"""A guard in C: the runtime's guard beside it, its text read back, the judge in C, and what a user does with it."""

from __future__ import annotations

import random
import re
import subprocess
import textwrap
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from effort import share_of
from guard_mutants import mutants
from guarding import programs
from quick_gate import quick_gate

from benchmarks.guarded import CMD, EXAMPLES, SCAN
from benchmarks.guarded_c import drivers
from ltlc.assurance import c_guard
from ltlc.assurance.c_guard import HOLD, PASS, EmittedGuard, flaw
from ltlc.assurance.c_library import FLAGS, Library, compiler
from ltlc.assurance.library import CompilerError
from ltlc.assurance.messages import Messages
from ltlc.backends import c
from ltlc.backends.c import guards
from ltlc.backends.spelling import NotInTargetError
from ltlc.base.limits import Budget, run_all
from ltlc.cli import main
from ltlc.frontend.language import types_for
from ltlc.specification.expressions import Signal

needs_compiler = pytest.mark.skipif(compiler() is None, reason="no C compiler")

MS = 1_000_000


def flaw_in(text: str, source: str | None = None) -> str | None:
    """What is wrong with the guard in `text`, or with another text of its source file."""
    specification, compiled, _, of = programs(text)
    files = c.emit(compiled, specification, "g")
    emitted = guards.emit(files, of)
    emitted = emitted if source is None else [replace(each, source=source) for each in emitted]
    messages = Messages(types_for(specification.source, [])[0])
    try:
        return flaw(files, emitted, of, compiled, specification, messages)
    except CompilerError:
        return "it does not compile"


@needs_compiler
@pytest.mark.parametrize("name", EXAMPLES)
def test_a_guard_in_c_decides_as_the_runtime_does(name: str) -> None:
    assert flaw_in(EXAMPLES[name].text) is None


ALL = f"""{CMD}{SCAN}decl estop /estop std_msgs/Bool.data
decl joy /joy std_msgs/Bool.data
assume never min(scan) < 0
near: always (min(scan) < 0.5 implies eventually speed <= 0.2 within 100 ms)
slow: always (new speed and min(scan) < 0.5 implies speed <= 0.2)
still: always (estop and previously estop implies speed == 0)
held: always (age(joy) > 500 ms and previously age(joy) > 500 ms implies speed == 0)
"""
"""A guard that does all that guards do."""


@needs_compiler
def test_a_changed_guard_is_noticed() -> None:
    specification, compiled, _, of = programs(ALL)
    (guard,) = guards.emit(c.emit(compiled, specification, "g"), of)
    drawn = random.Random(0).sample([*mutants(guard.source)], share_of(20))
    # A change can make an endless loop, so each is run in a child.
    found = run_all([partial(flaw_in, ALL, text) for _, text in drawn], Budget(60, 2048))
    assert not [what for (what, _), wrong in zip(drawn, found, strict=True) if wrong is None]


@needs_compiler
def test_what_leaves_a_guard_in_c_violates_nothing_as_the_monitors_in_c_judge(tmp_path: Path) -> None:
    for name, is_sent in {"near": True, "e-stop until reset": True, "two guards": True, "a sure pose": False}.items():
        (made,) = drivers(EXAMPLES[name])
        flags = ("-fsanitize=address,undefined", "-fno-sanitize-recover")
        passed, changed, _, sent, lost, violated = map(int, made.run(tmp_path, "20000", "7", flags=flags).split())
        assert min(passed, changed) > 0
        assert (sent > 0) is is_sent
        assert (lost, violated) == (0, 0)


@needs_compiler
def test_the_judge_in_c_finds_what_a_guard_that_minds_nothing_lets_through(tmp_path: Path) -> None:
    (made,) = drivers(EXAMPLES["near"])
    source = made.texts["g_guard.c"].replace("return target == 1;", "return true;")
    assert source != made.texts["g_guard.c"]
    *_, violated = replace(made, texts={**made.texts, "g_guard.c": source}).run(tmp_path, "2000", "7").split()
    assert int(violated) > 0


class Near:
    """The guard of the first example in C, or of another text, with messages by their values."""

    def __init__(self, text: str = EXAMPLES["near"].text) -> None:
        specification, compiled, _, of = programs(text)
        files = c.emit(compiled, specification, "g")
        (guard,) = guards.emit(files, of)
        path = compiler()
        assert path is not None
        self.guard = EmittedGuard(Library(files, path, guard), guard)
        self.signals: dict[str, Signal] = {signal.name: signal for signal in files.samples.group_of}

    def scan(self, time: int, nearest: float) -> int:
        return self.guard.hear(time, "/scan", {self.signals["scan"]: (nearest, 9.0)})

    def command(self, time: int, speed: float) -> int:
        return self.guard.command(time, "/cmd_vel", {self.signals["speed"]: speed})


STOP = 2


@needs_compiler
def test_nothing_leaves_a_guard_in_c_before_its_topics_have_spoken() -> None:
    near = Near()
    assert near.command(0, 0.0) == HOLD
    assert near.scan(1, 5.0) == HOLD
    assert near.command(2, 1.0) == PASS


@needs_compiler
def test_a_guard_in_c_whose_first_scan_is_not_a_number_is_silent_until_there_is_one() -> None:
    near = Near()
    assert near.scan(0, float("nan")) == HOLD  # 9.0 is a number: the smallest is 9.0
    assert near.command(1, 1.0) == PASS
    near = Near()
    assert near.guard.hear(0, "/scan", {near.signals["scan"]: (float("nan"),)}) == HOLD
    assert near.command(1, 0.0) == HOLD
    assert not near.guard.has_lost
    assert near.scan(2, 5.0) == HOLD
    assert near.command(3, 1.0) == PASS


@needs_compiler
def test_a_guard_in_c_acts_ahead_of_a_deadline_as_long_as_that_is_not_over() -> None:
    for late in (0, 5 * MS, 10 * MS):
        near = Near()
        near.scan(0, 5.0)
        near.command(1, 1.0)
        near.scan(2, 0.25)
        assert near.guard.act(3) == HOLD  # what was news is news no more
        assert near.guard.due() == 90 * MS + 2
        assert near.guard.act(90 * MS + 2 + late) == STOP
        assert not near.guard.has_lost


@needs_compiler
def test_a_guard_in_c_that_acts_too_late_has_lost_and_sends_its_first_fallback_ever_after() -> None:
    near = Near()
    near.scan(0, 5.0)
    near.command(1, 1.0)
    near.scan(2, 0.25)
    assert near.guard.act(100 * MS + 3) == HOLD
    assert near.guard.has_lost
    assert near.command(101 * MS, 0.0) == STOP
    assert near.scan(102 * MS, 9.0) == HOLD
    assert near.command(103 * MS, 1.0) == STOP


@needs_compiler
@pytest.mark.parametrize("late", [-1, 0, 1])
def test_an_answer_to_what_time_does_may_be_late_by_the_lead_and_no_more(late: int) -> None:
    near = Near(
        f"{CMD}decl joy /joy std_msgs/Bool.data\n"
        "p: always (age(joy) > 500 ms and previously age(joy) > 500 ms implies speed == 0)"
    )
    near.guard.hear(0, "/joy", {})
    assert near.command(1, 1.0) == PASS
    due = near.guard.due()
    assert due == 500 * MS + 1
    assert near.guard.act(due + 10 * MS + late) == (HOLD if late > 0 else STOP)
    assert near.guard.has_lost is (late > 0)


@needs_compiler
def test_a_guard_in_c_that_is_not_asked_to_act_has_lost() -> None:
    near = Near()
    near.scan(0, 5.0)
    near.command(1, 1.0)
    near.scan(2, 0.25)
    assert near.command(101 * MS, 1.0) == STOP
    assert near.guard.has_lost


@needs_compiler
def test_a_command_that_is_no_number_does_not_pass_and_none_with_an_earlier_time() -> None:
    near = Near()
    near.scan(10, 5.0)
    assert near.command(11, float("nan")) == STOP
    assert near.command(10, 0.0) == HOLD
    assert near.command(12, 0.1) == PASS


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (f"{CMD}guarded: never speed > 1", "begins with `guard`"),
        (
            f"{CMD}guard /cmd_vel/act_raw to /cmd_vel/act\ndecl act /cmd_vel/act std_msgs/Bool.data\n"
            "p: never speed > 1\nq: never new act",
            "`guard_cmd_vel` and `guard_cmd_vel_act`",
        ),
    ],
)
def test_what_a_guard_in_c_does_not_have_is_refused_by_name(text: str, why: str) -> None:
    specification, compiled, _, of = programs(text)
    with pytest.raises(NotInTargetError, match=why):
        guards.emit(c.emit(compiled, specification, "g"), of)


def test_independent_guards_have_files_of_their_own_and_those_that_share_a_property_one_run() -> None:
    specification, compiled, _, of = programs(EXAMPLES["three guards, two that share"].text)
    found = guards.emit(c.emit(compiled, specification, "g"), of)
    assert [[*each.texts] for each in found] == [
        ["g_guard_cmd_vel.h", "g_guard_cmd_vel.c"],
        ["g_guard_lamp.h", "g_guard_lamp.c"],
    ]
    assert [each.commands for each in found] == [
        {"/cmd_vel": "g_guard_cmd_vel_cmd_vel", "/grip": "g_guard_cmd_vel_grip"},
        {"/lamp": "g_guard_lamp"},
    ]
    assert found[0].sent == ("G_GUARD_CMD_VEL_CMD_VEL_STOP", "G_GUARD_CMD_VEL_GRIP_OPEN")


PROPERTIES = EXAMPLES["near"].text.replace("p:", "near:").replace("q:", "slow:")


@needs_compiler
def test_a_guard_is_built_certified_and_compiled_with_a_program(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(c_guard, "EVENTS", 200)
    (tmp_path / "p.txt").write_text(PROPERTIES, encoding="utf-8")
    files = [str(tmp_path / name) for name in ("p.txt", "p.cert", "p.c")]
    with quick_gate():
        assert main(["build", files[0], "-t", "c", "-o", files[2], "--certificate", files[1]]) == 0
    said = capsys.readouterr().out
    assert "conditions and decisions a call of the guard" in said
    assert f"wrote {tmp_path / 'p_guard.h'}" in said
    assert main(["certify", files[0], files[1], "--code", files[2]]) == 0
    assert "guard /cmd_vel: where it rests, read back, matches its region" in capsys.readouterr().out
    (tmp_path / "main.c").write_text(MAIN, encoding="utf-8")
    command = [compiler() or "", *FLAGS, "p.c", "p_guard.c", "main.c", "-o", "main", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    assert subprocess.run([tmp_path / "main"], check=True, capture_output=True, text=True).stdout == "0 1 0 2 \n"
    guard = tmp_path / "p_guard.c"
    guard.write_text(
        guard.read_text(encoding="utf-8").replace("is_silent = true", "is_silent = false"), encoding="utf-8"
    )
    assert main(["certify", files[0], files[1], "--code", files[2]]) == 1
    assert "in `p_guard_init`" in capsys.readouterr().out
    guard.unlink()
    assert main(["certify", files[0], files[1], "--code", files[2]]) == 1
    assert "it is missing" in capsys.readouterr().out


MAIN = """#include "p_guard.h"
#include <stdio.h>

int main(void)
{
    static const float clear[] = {2.0f}, near[] = {0.25f};
    const p_samples free_way = {.scan = {clear, 1}, .has_scan = true}, person = {.scan = {near, 1}, .has_scan = true};
    const p_samples fast = {.speed = 1.0, .has_speed = true};
    p_guard_run run;
    p_guard_init(&run);
    printf("%d ", p_guard_hear_scan(&run, 0, &free_way));
    printf("%d ", p_guard(&run, 1, &fast));
    printf("%d ", p_guard_hear_scan(&run, 2, &person));
    while (p_guard_due(&run) < 90000000) {
        (void)p_guard_act(&run, p_guard_due(&run));
    }
    printf("%d \\n", p_guard_act(&run, p_guard_due(&run)));
    return run.has_lost;
}
"""


@needs_compiler
def test_the_program_of_the_documentation_prints_what_it_says(tmp_path: Path) -> None:
    page = (Path(__file__).parent.parent / "docs" / "c.md").read_text(encoding="utf-8")
    blocks = [textwrap.dedent(each) for each in re.findall(r"(?:^    .*\n|^\n)+", page, re.MULTILINE)]
    specification, compiled, _, of = programs(next(each for each in blocks if "# safe.txt" in each))
    files = c.emit(compiled, specification, "safe")
    (guard,) = guards.emit(files, of)
    texts = {"safe.h": files.header, "safe.c": files.source, "safe_guard.h": guard.header, "safe_guard.c": guard.source}
    for name, text in {**texts, "main.c": next(each for each in blocks if "safe_guard.h" in each)}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    command = [compiler() or "", *FLAGS, "safe.c", "safe_guard.c", "main.c", "-o", "main", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    said = subprocess.run([tmp_path / "main"], check=True, capture_output=True, text=True).stdout
    assert [line.split(": ")[1] for line in said.splitlines()] == ["nothing"] * 2 + ["the command", "nothing"] + [
        "stop"
    ] * 2


def test_a_worst_case_is_stated_in_the_header() -> None:
    specification, compiled, _, of = programs(
        f"{CMD}{SCAN}slow: always (new speed and min(scan) < 0.5 implies speed <= 0.2)"
    )
    (guard,) = guards.emit(c.emit(compiled, specification, "g"), of)
    assert str(guard.bound) in " ".join(guard.header.replace("*", "").split())


@needs_compiler
def test_files_of_independent_guards_are_certified_one_by_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(c_guard, "EVENTS", 200)
    (tmp_path / "p.txt").write_text(EXAMPLES["three guards, two that share"].text, encoding="utf-8")
    files = [str(tmp_path / name) for name in ("p.txt", "p.cert", "p.c")]
    with quick_gate():
        assert main(["build", files[0], "-t", "c", "-o", files[2], "--certificate", files[1]]) == 0
    assert "decisions a call of the guard of /cmd_vel and /grip; at most" in capsys.readouterr().out
    assert main(["certify", files[0], files[1], "--code", files[2]]) == 0
    said = capsys.readouterr().out
    for out in ("/cmd_vel", "/grip", "/lamp"):
        assert f"guard {out}: where it rests, read back, matches its region" in said
    (tmp_path / "p_guard_lamp.h").unlink()
    assert main(["certify", files[0], files[1], "--code", files[2]]) == 1
    assert "p_guard_lamp.h: it is missing" in " ".join(capsys.readouterr().out.split())
