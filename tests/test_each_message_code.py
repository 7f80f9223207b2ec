"""`each new` in nodes and packages: each message opens an instance, as the definition says, and reports name it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from each_by_definition import HEAD, give, plan_of
from replaying import outcomes
from stepping import from_text
from test_each_code import outcome_of
from test_each_message import MANY

from ltlc import cli
from ltlc.assurance.reading.files import written
from ltlc.assurance.reading.outcomes import Difference
from ltlc.assurance.replay import Deviation, Replayed
from ltlc.backends import emit
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Session
from ltlc.runtime.slices import OpenedSlices

EACH = f"{HEAD}p: each new prog: "
ANSWERED = f"{EACH}eventually (new kind and dist == @{{prog, opening}}) within 20 ns"
TEXTS = {
    **{text: f"{EACH}{text}" for text in MANY},
    "an opening": ANSWERED,
    "a topic that is not read": f"{EACH}eventually stop within 15 ns",
    "ages": f"{EACH}initially age(stop) <= 40 ns",
    "the past": f"{EACH}initially ((historically v < 3 for 10 ns) or once new prog)",
    "counts": f"{EACH}never once new stop 3 times within 40 ns",
    "ticks": f"_rate_ = 100000\n{EACH}(eventually kind == 2 within 40 us) and (after kind == 1, eventually stop)",
    "a run that ends": f"_timeout_ = 0.00000002\n{EACH}eventually kind == 2 within 15 ns",
    "a limit": ANSWERED.replace("new prog:", "new prog limit 2:"),
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_emitted_nodes_judge_each_message_as_the_definition_says(text: str) -> None:
    assert all(isinstance(outcome, Replayed) for outcome in outcomes(text, "ros2"))


FAULTS = {
    "a message on another topic": ('topic="/fb"', 'topic="/track"'),
    "no message opens": ('topic="/fb"', 'topic="/nothing"'),
    "an instance with the clocks of the run": ("self.before.fork()", "self.before"),
    "one instance for all": ("state_of(one.monitor)", "()"),
    "an instance that another stands for, uncounted": (
        "+= 1 + self.more.pop(other.id, 0)",
        "+= self.more.pop(other.id, 0)",
    ),
}


@pytest.mark.parametrize(("right", "wrong"), FAULTS.values(), ids=FAULTS)
def test_a_fault_in_what_opens_instances_is_noticed(right: str, wrong: str) -> None:
    assert any(isinstance(outcome, Deviation) for outcome in outcomes(ANSWERED, "ros2", right, wrong))


CHANGES = {
    "no instances": ("slicing=Instances(", "unread=Instances("),
    "slices": ("slicing=Instances(", "slicing=Slicing("),
    "another topic": ('topic="/fb"', 'topic="/track"'),
    "another mark": ('mark="prog (this one)"', 'mark="prog"'),
    "another name": ('name="prog"', 'name="kind"'),
    "another limit": ("limit=1000", "limit=None"),
    "a signal of another topic": ('Reading("dist", "/track", "number")', 'Reading("dist", "/fb", "number")'),
}


@pytest.mark.parametrize(("right", "wrong"), CHANGES.values(), ids=CHANGES)
def test_what_a_node_says_of_instances_is_read_back(right: str, wrong: str) -> None:
    compiled, specification = from_text(ANSWERED)
    code = emit("ros2", compiled, specification)

    def differs(text: str) -> bool:
        (found,) = written(text, [c.machine for c in compiled], [c.specification for c in compiled])
        return isinstance(found, Difference)

    assert right in code
    assert not differs(code)
    assert differs(code.replace(right, wrong))


@pytest.mark.usefixtures("quickly")
def test_a_package_replays_its_instances_where_it_is_installed(tmp_path: Path) -> None:
    text, package = tmp_path / "goals.txt", tmp_path / "package"
    text.write_text(ANSWERED)
    assert cli.main(["build", str(text), "--target", "ament", "-o", str(package), "-q"]) == 0
    assert outcome_of(package).returncode == 0
    runtime = package / "goals_monitor" / "runtime" / "slice_openings.py"
    runtime.write_text(runtime.read_text().replace("self.before.fork()", "self.before"))
    assert outcome_of(package).returncode == 1


def test_a_violation_is_told_once_with_the_time_of_its_message() -> None:
    rows = ByRows(Session(plan_of(ANSWERED)))
    give(rows, (0, "/track", {"id": 1, "kind": 0, "dist": 0.0}))
    for time, value in ((5, 1.0), (10, 2.0), (12, 3.0)):
        give(rows, (time, "/fb", {"fid": 1, "prog": value}))
    give(rows, (15, "/track", {"id": 1, "kind": 0, "dist": 2.0}))
    rows.advance(27)
    (track,) = rows.tracks
    assert isinstance(track.slices, OpenedSlices)
    [(text, line)] = track.slices.untold()
    told = json.loads(line)
    assert "p[prog at +0.000000005 s]" in text
    assert (told["message"], told["opened_at"]["time"], told["verdict"]) == (1, 5e-9, "violated")
    assert "id" not in told
    assert track.slices.listed() == {"violated messages": "+0.000000005 s", "open messages": "+0.000000012 s"}
    assert not [*track.slices.untold()]
