"""`each` by a key that is an array: each element is a message of its own, and an id may be gone."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bag_support import Sent, made, mcap, rosbag2
from each_by_definition import HEAD, give, plan_of
from language_support import compiled

import ltlc
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.runtime.rows import ByRows
from ltlc.runtime.session import Plan, Session
from ltlc.runtime.slice_keys import Id
from ltlc.runtime.slice_steps import Slices
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict

ARRAYS = """
decl id   /track action_msgs/GoalStatusArray.status_list[].goal_info.stamp.sec
decl dist /track action_msgs/GoalStatusArray.status_list[].goal_info.stamp.nanosec
decl kind /track action_msgs/GoalStatusArray.status_list[].status
decl v    /odom std_msgs/Float64.data
"""

TEXTS = (
    "always (kind == 1 implies eventually kind == 2 within 20 ns)",
    "never (dist < 1 and v > 2)",
    "always age(dist) <= 30 ns",
    "always (kind == 2 implies once kind == 1)",
    "never dist - @{dist, -1} > 1",
    "always (id == g implies kind < 3)",
    "never (gone id and kind == 1)",
    "always (gone id implies once kind == 2)",
    "after_until kind == 1, gone id, eventually kind == 2 within 30 ns",
    "always (gone id and v > 1 implies eventually not gone id)",
    "never (new kind and gone id)",
)

Array = tuple[int, str, Mapping[str, Any]]
"""A message: of `/track`, arrays as long as one another."""


def random_arrays(chance: random.Random) -> list[Array]:
    time, rows = 0, list[Array]()
    for _ in range(chance.randint(1, 25)):
        time += chance.choice([0, 1, 3, 7, 12, 20])
        if chance.random() < 0.3:
            rows.append((time, "/odom", {"v": chance.choice([0.0, 1.5, 2.5])}))
            continue
        ids = chance.choices(range(4), k=chance.randint(0, 3))
        kinds, dists = chance.choices([0, 1, 2], k=len(ids)), chance.choices(range(3), k=len(ids))
        rows.append((time, "/track", {"id": ids, "kind": kinds, "dist": dists}))
    return rows


def arrays_judged(plan: Plan, rows: list[Array], until: int) -> Track:
    judge = ByRows(Session(plan))
    judge.begin(rows[0][0])
    for row in rows:
        give(judge, row)
    judge.advance(until)
    return judge.session.tracks[0]


def slice_judged(plan: Plan, rows: list[Array], id_: Id, until: int) -> Track:
    """By definition: the elements with the id, one after the other, and what says that there is none."""
    judge = ByRows(Session(plan))
    has_ages = bool(plan.properties[0].ages)
    birth = next(time for time, _, values in rows if id_ in values.get("id", ()))
    judge.begin(birth if has_ages else rows[0][0])  # ages of the slice count from its birth
    is_born = is_gone = False
    fields = {name for names in judge.session.fields.values() for name in names}

    def come(time: int, topic: str, values: Mapping[str, object]) -> None:
        taken = {name: value for name, value in values.items() if name in fields}
        if taken or topic:
            judge.samples(time, tuple(taken), list(taken.values()), [topic] if topic in judge.session.fields else [])

    for time, topic, values in rows:
        if topic == "/odom":
            if is_born or not has_ages:
                come(time, topic, values)
            continue
        elements = [dict(zip(values, each, strict=True)) for each in zip(*values.values(), strict=True)]
        mine = [each for each in elements if each["id"] == id_]
        if not mine and is_born and not is_gone:
            come(time, "", {"isgone": True})
            is_gone = True
        for each in mine:
            come(time, topic, {**each, "isgone": False} if is_gone or not is_born else each)
            is_born, is_gone = True, False
    judge.advance(until)
    return judge.session.tracks[0]


@pytest.mark.parametrize("text", TEXTS)
def test_elements_of_an_array_are_messages_of_slices(text: str) -> None:
    chance = random.Random(text)
    sliced = plan_of(f"{ARRAYS}p: each g of id: {text}")
    plain_text = re.sub(r"\bg\b", "id", text.replace("gone id", "isgone"))
    plain = plan_of(f"{HEAD}decl isgone /gone std_msgs/Bool.data\np: {plain_text}")
    for _ in range(40):
        rows = random_arrays(chance)
        until = rows[-1][0] + chance.choice([0, 10, 100])
        track = arrays_judged(sliced, rows, until)
        assert isinstance(track.slices, Slices)
        ids = dict.fromkeys(i for _, topic, values in rows if topic == "/track" for i in values["id"])
        expected = {id_: slice_judged(plain, rows, id_, until) for id_ in ids}
        violated = {i: t.decided_at and t.decided_at.time for i, t in expected.items() if t.verdict is Verdict.VIOLATED}
        assert {i: v.failure.time for i, v in track.slices.ids.violated.items()} == violated
        for id_, one in track.slices.ids.slices.items():
            assert one.verdict is expected[id_].verdict
            assert one.deadline() == expected[id_].deadline()


GOALS = """
decl goal   /status action_msgs/GoalStatusArray.status_list[].goal_info.goal_id
decl status /status action_msgs/GoalStatusArray.status_list[].status
decl other  /feedback unique_identifier_msgs/UUID.uuid
ends: each g of goal, other: eventually status == 4 within 60 s
gone: each g of goal: never (gone goal and status == 2)
"""
SECOND = 10**9
Write = Callable[[Path, Sequence[Sent]], Path]


def goals(*pairs: tuple[int, int]) -> object:
    statuses = [
        made(
            "action_msgs/msg/GoalStatus",
            status=status,
            goal_info=made(
                "action_msgs/msg/GoalInfo",
                goal_id=made("unique_identifier_msgs/msg/UUID", uuid=np.full(16, number, np.uint8)),
            ),
        )
        for number, status in pairs
    ]
    return made("action_msgs/msg/GoalStatusArray", status_list=statuses)


@pytest.mark.parametrize(("write", "name"), [(rosbag2, "goals"), (mcap, "goals.mcap")])
def test_goals_of_an_action_are_told_by_their_uuids(tmp_path: Path, write: Write, name: str) -> None:
    times = ((100, goals((7, 2))), (104, goals((7, 2), (8, 2))), (109, goals((7, 4), (8, 2))), (170, goals((7, 4))))
    sent = [Sent("/status", "action_msgs/msg/GoalStatusArray", time * SECOND, message) for time, message in times]
    path = write(tmp_path / name, sent)
    run = ltlc.run(GOALS.replace("decl other", "# ").replace(", other", ""), path)
    ends, gone = run.document()["properties"]
    eight = "08080808-0808-0808-0808-080808080808"
    assert [(each["id"], each["decided_at"]["time_ns"]) for each in ends["each"]["violated"]] == [
        (eight, 164 * SECOND + 1)
    ]
    assert [(each["id"], each["decided_at"]["time"]) for each in gone["each"]["violated"]] == [(eight, 170.0)]


def test_bytes_by_themselves_and_a_message_of_nothing_else_are_one_id() -> None:
    of = compiled(GOALS).properties[0]
    assert of.slicing is not None
    assert [key.name for key in of.slicing.keys] == ["goal", "other"]


def test_arrays_side_by_side_in_a_message_belong_together() -> None:
    text = "decl joint /j JointState.name decl effort /j JointState.effort\np: each j of joint: never abs(effort) > 5"
    run = ltlc.monitor(text)
    run.step({"joint": ["a", "b"], "effort": [1.0, -7.0]}, time=0.0)
    run.step({"joint": ["b", "c"], "effort": [9.0]}, time=1.0)
    (of,) = run.finish().document()["properties"]
    assert [each["id"] for each in of["each"]["violated"]] == ["b"]
    assert of["each"]["ids"] == 2, "as far as the shortest array goes"


def test_an_array_and_its_elements_may_be_in_one_file() -> None:
    text = "decl name /d DiagnosticArray.status[].name decl level /d DiagnosticArray.status[].level\n"
    text += 'any: never any(level == 3)\nall: each n of name: never level == 2 and n == "x"'
    run = ltlc.monitor(text)
    run.step({"name": ["x", "y"], "level": [1, 3]}, time=0.0)
    assert {label: verdict.value for label, verdict in run.verdicts.items()} == {
        "any": "violated",
        "all": "presumably_satisfied",
    }


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("never gone id", "`id` is not an array that is a key of this property"),
        ("each g of id: never gone kind", "`kind` is not an array that is a key of this property"),
        ("p: each g of id: never v > dist q: each g of kind: never v > dist", "`g` stands for values of `id`"),
    ],
)
def test_what_does_not_fit_is_an_error_at_its_place(text: str, told: str) -> None:
    _, found = load_text(Source("props.txt", f"{ARRAYS}{text}"))
    assert any(told in each.message for each in found), [each.message for each in found]
