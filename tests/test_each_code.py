"""`each` in nodes and packages: what is emitted slices as the definition says, and reports name the ids."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from each_by_definition import HEAD
from replaying import outcomes
from stepping import from_text
from test_each_arrays import ARRAYS, GOALS

import ltlc
from ltlc import cli
from ltlc.assurance.reading.files import written
from ltlc.assurance.reading.outcomes import Difference
from ltlc.assurance.replay import Deviation, Replayed
from ltlc.backends import emit
from ltlc.base.errors import UnusableInput

RESPONSE = f"{HEAD}p: each g of id: always (kind == 1 implies eventually kind == 2 within 20 ns)"
LIVES = (
    f"{HEAD}p: each g of id: after_until new dist, age(dist) > 25 ns, always (kind == 1 implies eventually kind == 2)"
)
TEXTS = {
    "response": RESPONSE,
    "lives": LIVES,
    "two topics": f"{HEAD}p: each g of id, fid: always (kind == 1 implies eventually prog > 2 within 20 ns)",
    "with a topic of all": f"{HEAD}p: each g of id: never (dist < 1 and v > @{{v, -1}})",
    "the id as a value": f"{HEAD}p: each g of id: never (g == 3 and v > 2)",
    "ages": f"{HEAD}p: each g of id: always (dist < 1 implies age(stop) <= 40 ns)",
    "history": f"{HEAD}p: each g of id: never abs(dist - @{{dist, -1}}) > 2",
    "latches": f"{HEAD}p: each g of id: always dist <= @{{dist, opening}} + 2",
    "ticks": f"_rate_ = 100000\n{HEAD}p: each g of id: always (dist < 1 implies eventually v < 1 within 15 us)",
    "a run that ends": f"_timeout_ = 0.00000002\n{HEAD}p: each g of id: eventually kind == 2 within 15 ns",
    "elements": f"{ARRAYS}p: each g of id: always (id == g implies kind < 3)",
    "gone": f"{ARRAYS}p: each g of id: after_until kind == 1, gone id, eventually kind == 2 within 30 ns",
    "bytes": GOALS,
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_emitted_nodes_judge_the_slices_of_the_definition(text: str) -> None:
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(text, "ros2"))


FAULTS = {
    "a key that is no key": (TEXTS["two topics"], ', Key("/fb", "fid")', ""),
    "the elements of another array": (TEXTS["elements"], '"kind": "kind[g]"', '"id": "kind[g]"'),
    "what is gone": (TEXTS["gone"], 'gone="gone id"', "gone=None"),
    "two ids in one place": (RESPONSE, "limit=1000", "limit=1"),
    "ages of what others said before": (TEXTS["ages"], "self._last_heard.get(signal, self._begins)", "self._begins"),
    "an id that is one for all": (TEXTS["the id as a value"], "found[self._id] = id_", "pass"),
    "samples of another slice": (TEXTS["history"], "self.sampler.known.copy()", "self.sampler.known"),
    "a topic of all that only new slices hear": (
        TEXTS["with a topic of all"],
        "self._give(time, one, row.rest, values)",
        "pass",
    ),
    "an array that is one message": (TEXTS["elements"], "ids[:count]", "ids[:1]"),
    "ticks that see nothing of a slice": (
        TEXTS["ticks"],
        "part.update.take(known, time, (*latest.values(), *given))",
        "pass",
    ),
    "bytes in another order": (GOALS, "UUID(bytes=value)", "UUID(bytes_le=value)"),
}


@pytest.mark.parametrize(("text", "right", "wrong"), FAULTS.values(), ids=FAULTS)
def test_a_fault_in_what_slices_a_run_is_noticed(text: str, right: str, wrong: str) -> None:
    assert any(isinstance(outcome, Deviation) for outcome in outcomes(text, "ros2", right, wrong))


SLICINGS = {
    "no slices": ("slicing=Slicing(", "unread=Slicing("),
    "another key": ('Key("/fb", "fid")', 'Key("/fb", "prog")'),
    "another limit": ("limit=1000", "limit=None"),
    "what is forgotten": ("as_new=frozenset([])", "as_new=frozenset([0])"),
    "another id": ('variable="g"', 'variable="h"'),
    "a signal less": ('Reading("prog", "/fb", "number"),', ""),
    "a signal of another topic": ('Reading("prog", "/fb", "number")', 'Reading("prog", "/track", "number")'),
}


@pytest.mark.parametrize(("right", "wrong"), SLICINGS.values(), ids=SLICINGS)
def test_what_a_node_says_of_slices_is_read_back(right: str, wrong: str) -> None:
    compiled, specification = from_text(TEXTS["two topics"])
    code = emit("ros2", compiled, specification)

    def differs(text: str) -> bool:
        (found,) = written(text, [c.machine for c in compiled], [c.specification for c in compiled])
        return isinstance(found, Difference)

    assert right in code
    assert not differs(code)
    assert differs(code.replace(right, wrong))


def test_what_is_not_judged_for_each_id_is_not_sliced() -> None:
    (one,), _ = from_text(RESPONSE.replace("each g of id: ", ""))
    sliced = emit("ros2", *from_text(RESPONSE)).replace("each g of id: ", "")
    (found,) = written(sliced, [one.machine], [one.specification])
    assert isinstance(found, Difference)


@pytest.mark.parametrize("target", ["python", "c", "rust", "hoa", "dot", "json"])
def test_other_targets_refuse_by_name_what_is_judged_for_each_id(target: str) -> None:
    for text in (RESPONSE, 'decl goal /g action_msgs/GoalInfo.goal_id\nnever goal == "x"'):
        with pytest.raises(UnusableInput) as refused:
            ltlc.build(text, target)
        assert [each.code for each in refused.value.diagnostics] == ["LTL708"]


@pytest.mark.usefixtures("quickly")
def test_a_change_in_what_slices_a_run_is_refused_by_certify(tmp_path: Path) -> None:
    text, node, certificate = tmp_path / "props.txt", tmp_path / "node.py", tmp_path / "props.cert"
    text.write_text(TEXTS["the id as a value"])
    assert cli.main(["build", str(text), "-o", str(node), "--certificate", str(certificate), "-q"]) == 0
    command = ["certify", str(text), str(certificate), "--code", str(node), "-q"]
    assert cli.main(command) == 0
    for right, wrong in (("limit=1000", "limit=999"), ("found[self._id] = id_", "pass")):
        code = node.read_text()
        node.write_text(code.replace(right, wrong))
        assert cli.main(command) == 1
        node.write_text(code)


def outcome_of(package: Path) -> subprocess.CompletedProcess[str]:
    """What the tests of a package say of it."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test"]
    environment = {**os.environ, "PYTHONPATH": str(package)}
    return subprocess.run(command, cwd=package, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.usefixtures("quickly")
def test_a_package_replays_its_slices_where_it_is_installed(tmp_path: Path) -> None:
    text, package = tmp_path / "goals.txt", tmp_path / "package"
    text.write_text(TEXTS["gone"])
    assert cli.main(["build", str(text), "--target", "ament", "-o", str(package), "-q"]) == 0
    ran = outcome_of(package)
    assert ran.returncode == 0, ran.stdout
    assert "20 passed" in ran.stdout
    runtime = package / "goals_monitor" / "runtime" / "slice_steps.py"
    code = runtime.read_text()
    runtime.write_text(code.replace("self._give(time, one, part, (True,))", "pass"))
    assert outcome_of(package).returncode == 1
