"""`ltlc run --cut`: what was recorded around each violation is copied bit for bit, from bags of all forms."""

from __future__ import annotations

import io
import random
import shutil
import sqlite3
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from bag_support import FORMS, ODOMETRY, STORE, TWIST, Sent, made, mcap, odometry, random_message, ros1, rosbag2
from effort import share_of
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from rosbags.highlevel import AnyReader  # noqa: TID251
from test_files import with_little_room

from ltlc.cli import main
from ltlc.inputs.recordings.bags.copying import Copier
from ltlc.inputs.recordings.rows import RecordingError

SECOND = 10**9
BEGAN = 1_700_000_000 * SECOND
SPEED = "decl speed /odom Odometry.twist.twist.linear.x\n"
HEAD = f"{SPEED}decl x /odom Odometry.pose.pose.position.x\n"
SLOW = f"{SPEED}slow: never speed > 2\n"


class Found(NamedTuple):
    """A message as it lies in a file."""

    topic: str
    type: str
    time: int
    data: bytes


def drive(seconds: Sequence[float], fast: Sequence[float] = ()) -> list[Sent]:
    """Odometry at these times, `fast` at some, and other messages in between."""
    sent = []
    for at in seconds:
        time = BEGAN + round(at * SECOND)
        speed = 3.0 if at in fast else 1.0
        sent.append(odometry(time, twist__twist__linear__x=speed))
        sent.append(Sent("/cmd", TWIST, time + 1, made(TWIST)))
    return sent


def by_mcap(path: Path) -> list[Found]:
    with path.open("rb") as file:
        found = list(make_reader(file).iter_messages(log_time_order=False))
    return [Found(c.topic, s.name if s else "", m.log_time, m.data) for s, c, m in found]


def by_rosbags(path: Path) -> list[Found]:
    with AnyReader([path]) as reader:
        return [Found(c.topic, c.msgtype, time, bytes(data)) for c, time, data in reader.messages()]


def wanted(sent: Sequence[Sent], since: int, until: int) -> list[Found]:
    inside = (each for each in sent if since <= each.time <= until)
    return [Found(each.topic, each.type, each.time, each.cdr) for each in inside]


def copied(path: Path, since: int, until: int, target: Path) -> Path:
    with Copier(path) as copier, target.open("wb") as file:
        copier.copy(since, until, file)
    return target


def many(chance: random.Random, count: int) -> list[Sent]:
    """Messages on three topics, some at one time."""
    time, sent = BEGAN, []
    for _ in range(count):
        time += chance.choice((0, 1, 1000, 10_000_000))
        topic, type_ = chance.choice((("/odom", ODOMETRY), ("/cmd", TWIST), ("/level", "own_msgs/msg/Level")))
        sent.append(Sent(topic, type_, time, random_message(type_, chance)))
    return sent


def windows(chance: random.Random, sent: Sequence[Sent]) -> Iterator[tuple[int, int]]:
    times = [each.time for each in sent]
    yield times[0], times[-1]
    yield times[0] - SECOND, times[-1] + SECOND
    for _ in range(6):
        yield tuple(sorted(chance.choice(times) + chance.choice((-1, 0, 1)) for _ in range(2)))  # type: ignore[misc]


@pytest.mark.parametrize("form", sorted(FORMS.keys() - {"ros1"}))
def test_an_extract_has_the_messages_of_its_time_bit_for_bit_in_their_order(tmp_path: Path, form: str) -> None:
    chance = random.Random(form)
    sent = many(chance, 300)
    bag = FORMS[form](tmp_path, sent)
    for since, until in windows(chance, sent):
        extract = copied(bag, since, until, tmp_path / "extract.mcap")
        assert by_mcap(extract) == wanted(sent, since, until)
        if wanted(sent, since, until):  # of a file without messages rosbags reads none
            assert sorted(by_rosbags(extract)) == sorted(wanted(sent, since, until))


def test_messages_of_ros_1_are_kept_and_judged_as_they_were(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sent = drive([0, 1, 2, 3, 9], fast=[2])
    bag = ros1(tmp_path / "a.bag", sent)
    extract = copied(bag, BEGAN + SECOND, BEGAN + 3 * SECOND, tmp_path / "extract.mcap")
    raw = [bytes(STORE.cdr_to_ros1(each.cdr, each.type)) for each in sent]
    kept = [(s, data) for s, data in zip(sent, raw, strict=True) if SECOND <= s.time - BEGAN <= 3 * SECOND]
    assert [(f.topic, f.time, f.data) for f in by_mcap(extract)] == [(s.topic, s.time, data) for s, data in kept]
    (tmp_path / "p.ltlc").write_text(SLOW)
    assert main(["run", str(tmp_path / "p.ltlc"), str(extract), "--absolute"]) == 1
    assert "violated at 1700000002 s" in capsys.readouterr().out


def test_the_files_of_a_split_bag_whose_channels_have_other_numbers_become_one(tmp_path: Path) -> None:
    first, second = many(random.Random(1), 200), many(random.Random(2), 200)
    late = [Sent(s.topic, s.type, s.time + 100 * SECOND, s.message) for s in second]
    topics = list(dict.fromkeys(each.topic for each in first))
    ordered = sorted(late, key=lambda each: topics[::-1].index(each.topic))
    (tmp_path / "bag").mkdir()
    mcap(tmp_path / "bag/bag_0.mcap", first)
    mcap(tmp_path / "bag/bag_1.mcap", ordered)
    extract = copied(tmp_path / "bag", BEGAN, BEGAN + 500 * SECOND, tmp_path / "extract.mcap")
    assert by_mcap(extract) == wanted([*first, *ordered], 0, 1 << 62)
    with extract.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert len(summary.channels) == len(topics)


def test_chunks_inside_the_time_of_an_extract_are_copied_as_they_are(tmp_path: Path) -> None:
    sent = many(random.Random(3), 400)
    bag = mcap(tmp_path / "a.mcap", sent, "ZSTD")
    extract = copied(bag, sent[100].time, sent[300].time, tmp_path / "extract.mcap")

    def chunks(path: Path) -> list[bytes]:
        records = StreamReader(io.BytesIO(path.read_bytes()), emit_chunks=True).records
        return [each.data for each in records if isinstance(each, Chunk)]

    inside = [each for each in chunks(extract) if each in chunks(bag)]
    assert len(inside) == len(chunks(extract)) - 2  # those at its ends have fewer messages
    assert len(inside) > 3


def channels(path: Path) -> dict[str, tuple[Any, ...]]:
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    schemas = summary.schemas
    return {
        c.topic: (
            c.message_encoding,
            c.metadata,
            *((s.name, s.encoding, s.data) if (s := schemas[c.schema_id]) else ()),
        )
        for c in summary.channels.values()
    }


def test_schemas_and_quality_of_service_are_those_of_the_recording(tmp_path: Path) -> None:
    sent = drive([0, 1])
    bag = rosbag2(tmp_path / "bag", sent, "mcap")
    extract = copied(bag, BEGAN, BEGAN + SECOND, tmp_path / "extract.mcap")
    assert channels(extract) == channels(next(bag.glob("*.mcap")))
    assert "offered_qos_profiles" in channels(extract)["/odom"][1]


def test_a_database_without_definitions_has_those_that_it_is_judged_by(tmp_path: Path) -> None:
    sent = drive([0, 1])
    bag = rosbag2(tmp_path / "bag", sent)
    with sqlite3.connect(next(bag.glob("*.db3"))) as database:
        database.execute("delete from message_definitions")
    extract = copied(bag, BEGAN, BEGAN + SECOND, tmp_path / "extract.mcap")
    with AnyReader([extract]) as reader:
        read: list[Any] = [
            reader.deserialize(data, c.msgtype) for c, _, data in reader.messages() if c.topic == "/odom"
        ]
    assert [each.twist.twist.linear.x for each in read] == [1.0, 1.0]


def test_the_chunk_that_a_killed_recorder_left_unfinished_is_copied_as_far_as_it_goes(tmp_path: Path) -> None:
    sent = many(random.Random(4), 200)
    whole = mcap(tmp_path / "whole.mcap", sent, is_finished=False)
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[:-1000])
    found = by_mcap(copied(cut, BEGAN, BEGAN + 500 * SECOND, tmp_path / "extract.mcap"))
    assert found == wanted(sent, 0, 1 << 62)[: len(found)]
    assert len(found) > 100


def test_a_damaged_chunk_is_reported(tmp_path: Path) -> None:
    sent = many(random.Random(5), 200)
    bag = mcap(tmp_path / "a.mcap", sent, "ZSTD")
    content = bytearray(bag.read_bytes())
    content[len(content) // 3] ^= 255
    bag.write_bytes(content)
    with Copier(bag) as copier, pytest.raises(RecordingError, match="damaged"):
        copy_parts(copier, sent)


def test_an_index_that_is_not_that_of_its_channel_is_reported(tmp_path: Path) -> None:
    sent = many(random.Random(6), 200)
    bag = mcap(tmp_path / "a.mcap", sent)
    with bag.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    place = next(iter(summary.chunk_indexes[1].message_index_offsets.values()))
    content = bytearray(bag.read_bytes())
    content[place + 9] = 77
    bag.write_bytes(content)
    with Copier(bag) as copier, pytest.raises(RecordingError, match="the index of the chunk at byte"):
        copier.copy(BEGAN, BEGAN + 500 * SECOND, io.BytesIO())


def copy_parts(copier: Copier, sent: Sequence[Sent]) -> None:
    for first, last in pairwise(range(0, len(sent), 10)):
        copier.copy(sent[first].time, sent[last].time, io.BytesIO())


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.ltlc").write_text(SLOW)
    return tmp_path


def ran(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    code = main(["run", *arguments])
    return code, capsys.readouterr().err


def test_each_violation_has_a_file_named_by_property_and_time(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mcap(here / "a.mcap", drive(range(60), fast=[10, 40]))
    code, told = ran(capsys, "p.ltlc", "a.mcap", "--cut", "out/cut", "--before", "2s", "--after", "1500 ms")
    assert (code, sorted(path.name for path in Path("out/cut").iterdir())) == (1, ["slow+10s.mcap", "slow+40s.mcap"])
    assert "ltlc: wrote out/cut/slow+10s.mcap: slow at +10 s, 8 messages\n" in told
    times = [(each.time - BEGAN) // SECOND for each in by_mcap(Path("out/cut/slow+40s.mcap"))]
    assert times == [38, 38, 39, 39, 40, 40, 41, 41]


def test_violations_of_one_property_whose_parts_overlap_share_a_file(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "p.ltlc").write_text(f"{SLOW}near: never speed > 2.5\n")
    mcap(here / "a.mcap", drive(range(60), fast=[10, 17, 24, 40]))
    _, told = ran(capsys, "p.ltlc", "a.mcap", "--cut", "cut")
    assert "slow+10s.mcap: slow at +10 s and 2 more up to +24 s, 43 messages" in told
    assert "near+10s.mcap: near at +10 s and 2 more up to +24 s, 43 messages" in told
    assert len(list(Path("cut").iterdir())) == 4


def test_the_last_of_violations_that_are_close_together_is_not_written_as_the_first(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mcap(here / "a.mcap", drive([0, 1, 2, 2.0001, 2.0002, 3], fast=[2, 2.0002]))
    _, told = ran(capsys, "p.ltlc", "a.mcap", "--cut", "cut")
    assert "slow at +2 s and 1 more up to +2.0002 s" in told


def test_an_extract_goes_back_to_when_something_began_to_be_owed(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "p.ltlc").write_text(f"{HEAD}answer: after speed > 2, eventually x > 5 within 20 s\n")
    mcap(here / "a.mcap", drive(range(60), fast=[10]))
    ran(capsys, "p.ltlc", "a.mcap", "--cut", "cut")
    found = by_mcap(here / "cut/answer+30s.mcap")
    assert (found[0].time - BEGAN, found[-1].time - BEGAN) == (5 * SECOND, 32 * SECOND + 1)


def test_an_episode_that_opened_before_the_extract_is_mentioned(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "p.ltlc").write_text(f"{HEAD}calm: after speed > 2, never x > 5\nnow: never x > 5\n")
    sent = [*drive(range(40), fast=[10]), odometry(BEGAN + 40 * SECOND, pose__pose__position__x=6.0)]
    mcap(here / "a.mcap", sent)
    _, told = ran(capsys, "p.ltlc", "a.mcap", "--cut", "cut")
    assert "calm at +40 s, in an episode that opened before it, at +10 s, 11 messages\n" in told
    assert "now at +40 s, 11 messages\n" in told


@pytest.mark.parametrize(
    "text",
    ["never speed > 2", "always (speed < 2 or x > 0.5)", "always (speed > 2 implies eventually x > 0.5 within 3 s)"],
)
def test_a_property_is_violated_in_its_extracts_when_it_was_in_the_recording(
    here: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    (here / "p.ltlc").write_text(f"{HEAD}p: {text}\n")
    for seed in range(share_of(35)):
        chance, sent, time = random.Random(seed), [], BEGAN
        for _ in range(150):
            time += chance.choice((0, 10**8, 10**9, 3 * 10**9))
            speed, x = chance.choice((1.0,) * 20 + (3.0,)), chance.choice((0.0, 0.0, 1.0))
            sent.append(odometry(time, twist__twist__linear__x=speed, pose__pose__position__x=x))
        shutil.rmtree("cut", ignore_errors=True)
        rosbag2(here / f"bag{seed}", sent, chance.choice(("mcap", "sqlite3")))
        ran(capsys, "p.ltlc", f"bag{seed}", "--cut", "cut")
        for extract in Path("cut").glob("*"):
            offset = float(extract.stem.partition("+")[2].removesuffix("s"))
            main(["run", "p.ltlc", str(extract), "--absolute"])
            report = capsys.readouterr().out
            at = float(report.rpartition("p: violated at ")[2].partition(" s")[0])
            assert at == pytest.approx(sent[0].time / 1e9 + offset, abs=0.0011)


def test_without_a_violation_nothing_is_written_and_that_is_said(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mcap(here / "a.mcap", drive(range(5)))
    code, told = ran(capsys, "p.ltlc", "a.mcap", "--cut", "cut")
    assert (code, told) == (0, "ltlc: nothing is written to cut: no property is violated\n")
    assert not Path("cut").exists()


def test_a_file_of_the_same_name_is_replaced_and_that_is_said(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mcap(here / "a.mcap", drive(range(5), fast=[2]))
    Path("cut").mkdir()
    Path("cut/slow+2s.mcap").write_text("old")
    code, told = ran(capsys, "p.ltlc", "a.mcap", "--cut", "cut")
    assert (code, told) == (1, "ltlc: replaced cut/slow+2s.mcap: slow at +2 s, 9 messages\n")
    assert len(by_mcap(Path("cut/slow+2s.mcap"))) == 9


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ("a.csv --cut cut", "--cut copies messages from bags; a.csv is a table"),
        ("a.mcap --cut cut --stamp header", "omit --stamp header"),
        ("a.mcap --cut p.ltlc", "--cut p.ltlc: not a folder"),
        ("bag --cut bag/cut", "bag/cut is not written: that file is an input"),
        ("a.mcap --before 1s", "--before and --after need --cut"),
        ("a.mcap --after 1s", "--before and --after need --cut"),
    ],
)
def test_what_cannot_be_cut_is_refused_before_it_is_judged(
    here: Path, capsys: pytest.CaptureFixture[str], arguments: str, told: str
) -> None:
    sent = drive(range(5), fast=[2])
    mcap(here / "a.mcap", sent)
    rosbag2(here / "bag", sent)
    (here / "a.csv").write_text("time,speed\n0,3\n")
    before = sorted(here.rglob("*"))
    code = main(["run", "p.ltlc", *arguments.split()])
    printed = capsys.readouterr()
    assert (code, printed.out, sorted(here.rglob("*"))) == (2, "", before)
    assert told in printed.err


def test_on_a_full_disk_no_half_of_an_extract_is_left(here: Path) -> None:
    mcap(here / "a.mcap", drive(range(5), fast=[2]))
    done = with_little_room("run p.ltlc a.mcap --cut cut", 4)
    assert done.returncode == 2
    assert "ltlc: cut/slow+2s.mcap cannot be written: File too large" in done.stderr
    assert list(Path("cut").iterdir()) == []


@pytest.mark.parametrize("text", ["", "5 parsecs", "-1s", "s", "1.s"])
def test_a_duration_that_is_none_is_refused(here: Path, capsys: pytest.CaptureFixture[str], text: str) -> None:
    with pytest.raises(SystemExit):
        main(["run", "p.ltlc", "a.mcap", "--cut", "cut", f"--before={text}"])
    assert "is not a duration such as 5s or 500ms" in capsys.readouterr().err
