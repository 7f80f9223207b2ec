"""Verdicts as topics in an MCAP file: read back by two libraries that did not write it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader  # noqa: TID251
from rosbags.typesys import Stores, get_typestore  # noqa: TID251
from stepping import ns

from ltlc.cli import main

PROPS = """decl v /v Float64.data
decl near /near Bool.data
slow: never v > 2
after_until near, not near, eventually v == 0
"""
ROWS = "time,v,near\n0.25,1,false\n1,1,true\n2,3,true\n3,0,true\n4.5,0,false\n"


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("mcap")
    (folder / "props.txt").write_text(PROPS)
    (folder / "run.csv").write_text(ROWS)
    arguments = ["run", str(folder / "props.txt"), str(folder / "run.csv"), "--output", str(folder / "out.mcap")]
    assert main(arguments) == 1
    return folder / "out.mcap"


def messages(path: Path) -> Iterator[tuple[str, int, Any]]:
    store = get_typestore(Stores.ROS2_JAZZY)
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            assert schema is not None
            yield channel.topic, message.log_time, store.deserialize_cdr(message.data, schema.name)


def data(path: Path, topic: str) -> list[tuple[int, Any]]:
    return [(time, message.data) for name, time, message in messages(path) if name == topic]


def test_a_verdict_is_told_at_the_beginning_at_each_change_and_at_the_end(written: Path) -> None:
    changes = [(ns(0.25), "presumably_satisfied"), (ns(2), "violated"), (ns(4.5), "violated")]
    assert data(written, "/ltlc/slow/verdict") == changes
    assert data(written, "/ltlc/slow/code") == [(ns(0.25), 1), (ns(2), -2), (ns(4.5), -2)]
    assert data(written, "/ltlc/slow/violated") == [(ns(0.25), False), (ns(2), True), (ns(4.5), True)]


def test_a_property_that_has_not_started_says_so_at_the_beginning(tmp_path: Path) -> None:
    (tmp_path / "props.txt").write_text(PROPS)
    (tmp_path / "run.csv").write_text("time,v,near\n1,1,\n2,1,true\n")
    arguments = ["run", str(tmp_path / "props.txt"), str(tmp_path / "run.csv"), "--output", str(tmp_path / "out.mcap")]
    assert main(arguments) == 3
    found = data(tmp_path / "out.mcap", "/ltlc/line_4/verdict")
    assert found[:2] == [(ns(1), "not_started"), (ns(2), "presumably_violated")]


def test_only_a_property_with_scopes_has_episodes(written: Path) -> None:
    assert {topic for topic, _, _ in messages(written) if topic.endswith("/episode")} == {"/ltlc/line_4/episode"}


def test_an_episode_is_open_from_what_opens_it_to_what_closes_it(written: Path) -> None:
    changes = [(ns(0.25), False), (ns(1), True), (ns(4.5), False), (ns(4.5), False)]
    assert data(written, "/ltlc/line_4/episode") == changes


def test_diagnostics_have_the_failing_state_in_words(written: Path) -> None:
    arrays = [(time, message) for name, time, message in messages(written) if name == "/diagnostics"]
    found = [(time, m.status[0]) for time, m in arrays if m.status[0].level == 2]
    time, status = found[0]
    assert (time, status.name) == (ns(2), "ltlc: slow")
    assert [(value.key, value.value) for value in status.values] == [("property", "never v > 2"), ("v", "3.0")]
    assert all(m.header.stamp.sec * 10**9 + m.header.stamp.nanosec == time for time, m in arrays)


def test_rosbags_reads_it_as_a_recording_with_the_definitions_in_it(written: Path) -> None:
    with AnyReader([written]) as reader:
        types = {connection.topic: connection.msgtype for connection in reader.connections}
        found = [
            (time, reader.deserialize(raw, connection.msgtype).data)  # type: ignore[attr-defined]
            for connection, time, raw in reader.messages([c for c in reader.connections if c.topic.endswith("/code")])
        ]
    assert types["/ltlc/slow/verdict"] == "std_msgs/msg/String"
    assert types["/diagnostics"] == "diagnostic_msgs/msg/DiagnosticArray"
    assert (ns(2), -2) in found


def test_topics_are_valid_names_and_no_two_are_equal(tmp_path: Path) -> None:
    text = "decl v /v Float64.data\na_2: never v > 1\nforall r in {v}: never r > 2\nnever v > 3\n"
    (tmp_path / "props.txt").write_text(text)
    (tmp_path / "run.csv").write_text("time,v\n0,1\n")
    arguments = ["run", str(tmp_path / "props.txt"), str(tmp_path / "run.csv"), "--output", str(tmp_path / "out.mcap")]
    assert main(arguments) == 0
    topics = {topic for topic, _, _ in messages(tmp_path / "out.mcap")} - {"/diagnostics"}
    assert len(topics) == 9
    assert all(re.fullmatch(r"/ltlc/[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*/[a-z]+", topic) for topic in topics)


def test_nothing_is_written_where_a_time_fits_no_message(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "props.txt").write_text(PROPS)
    (tmp_path / "run.csv").write_text(ROWS.replace("0.25", "-0.25"))
    arguments = ["run", str(tmp_path / "props.txt"), str(tmp_path / "run.csv"), "--output", str(tmp_path / "out.mcap")]
    assert main(arguments) == 2
    assert "between 1970 and 2038" in capsys.readouterr().err
    assert not (tmp_path / "out.mcap").exists()


def test_nothing_is_written_where_nothing_was_judged(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "props.txt").write_text(PROPS)
    (tmp_path / "run.csv").write_text("time,v,near\n")
    arguments = ["run", str(tmp_path / "props.txt"), str(tmp_path / "run.csv"), "--output", str(tmp_path / "out.mcap")]
    assert main(arguments) == 2
    assert "nothing of the recording could be judged" in capsys.readouterr().err
    assert not (tmp_path / "out.mcap").exists()


def test_a_file_that_cannot_be_written_is_told_before_the_recording_is_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "props.txt").write_text(PROPS)
    place = str(tmp_path / "missing" / "out.mcap")
    assert main(["run", str(tmp_path / "props.txt"), str(tmp_path / "none.csv"), "--output", place]) == 2
    assert "out.mcap" in capsys.readouterr().err
