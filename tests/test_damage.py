"""Damaged files: whatever is in one, it is reported as damaged with exit code 2, and never looks like a violation."""

from __future__ import annotations

import gzip
import json
import sqlite3
import struct
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
import zstandard
from bag_support import Sent, made, mcap, odometry, rosbag2
from damaging import damaged, problem_with
from fuzzing import Case
from mcap.writer import CompressionType, Writer

from ltlc.cli import main
from ltlc.inputs.recordings.blocks import MOST_ELEMENTS
from ltlc.runtime.times import SECOND

START = 1_700_000_000 * SECOND
X = "decl x /odom Odometry.pose.pose.position.x\nnever x > 5\n"
SENT = [odometry(START + k * SECOND // 10) for k in range(40)]

Capture = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the test, with a specification about an odometer."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "props.txt").write_text(X)
    return tmp_path


def said(capsys: Capture, path: Path | str, *arguments: str) -> tuple[int, str]:
    """The exit code of `ltlc run` on a recording, and what it says on stderr."""
    capsys.readouterr()
    code = main(["run", "props.txt", str(path), *arguments])
    return code, capsys.readouterr().err


def raw(path: Path, definition: str, data: bytes, times: list[int], compression: str = "NONE") -> Path:
    """An MCAP file of messages on /t of the type p/msg/T, as they are."""
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType[compression])
        writer.start("ros2")
        schema = writer.register_schema("p/msg/T", "ros2msg", definition.encode())
        channel = writer.register_channel("/t", "cdr", schema)
        for time in times:
            writer.add_message(channel, time, data, time)
        writer.finish()
    return path


def raw_properties(fields: str) -> None:
    """A specification about p/msg/T, whose fields are known to be these, of which `v` is read."""
    folder = Path("messages/p/msg")
    folder.mkdir(parents=True)
    (folder / "T.msg").write_text(fields)
    Path("props.txt").write_text("decl v /t p/msg/T.v\nnever v > 5\n")


@pytest.mark.parametrize("time", [2**63, 2**63 - 1, 2**64 - 1, 1 << 62])
@pytest.mark.parametrize("form", ["index", "no index", "no chunks", "other topic"])
def test_a_time_in_mcap_beyond_those_of_runs_is_damage(capsys: Capture, tmp_path: Path, form: str, time: int) -> None:
    late = odometry(time, stamp=0)
    sent = [*SENT, late]
    options = {"index": {}, "no index": {"is_finished": False}, "no chunks": {"use_chunking": False}}
    if form == "other topic":
        sent = [*SENT, odometry(time, "/other", stamp=0)]
    code, err = said(capsys, mcap(tmp_path / "a.mcap", sent, **options.get(form, {})))  # type: ignore[arg-type]
    if form == "other topic":
        assert "bug" not in err
        assert code in (0, 2)
        return
    assert code == 2
    assert "error[LTL8" in err
    assert "bug" not in err


@pytest.mark.parametrize("time", [2**63 - 1, 1 << 62, -(2**63), 9.3e18, "soon", b"soon", None])
def test_a_time_in_a_database_beyond_those_of_runs_is_damage(capsys: Capture, tmp_path: Path, time: object) -> None:
    (path,) = rosbag2(tmp_path / "bag", SENT).glob("*.db3")
    with closing(sqlite3.connect(path)) as database:
        columns = database.execute("select sql from sqlite_master where name = 'messages'").fetchone()[0]
        database.execute("create table copy as select * from messages")
        database.execute("drop table messages")
        database.execute(columns.replace("NOT NULL", ""))
        database.execute("insert into messages select * from copy")
        database.execute("update messages set timestamp = ? where id = 20", [time])
        database.commit()
    for given in (path, path.parent):
        code, err = said(capsys, given)
        assert code == 2
        assert "error[LTL8" in err
        assert "bug" not in err


def rewritten(path: Path, opcode: int, place: int, size: int) -> None:
    """Write `size` as a u64 at a `place` in the body of the first record of this kind in an MCAP file."""
    data = bytearray(path.read_bytes())
    at = 8
    while data[at] != opcode:
        at += 9 + struct.unpack_from("<Q", data, at + 1)[0]
    struct.pack_into("<Q", data, at + 9 + place, size)
    path.write_bytes(data)


CHUNK, STATISTICS, CHUNK_INDEX = 6, 11, 8


@pytest.mark.parametrize("size", [2**64 - 1, 2**63, 2**40, 2**27 + 1, 0])
@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
@pytest.mark.parametrize(("opcode", "place"), [(CHUNK, 16), (CHUNK_INDEX, 24)], ids=["chunk", "index"])
def test_a_chunk_that_is_not_as_large_as_it_claims_is_damage(
    capsys: Capture, tmp_path: Path, opcode: int, place: int, compression: str, size: int
) -> None:
    path = mcap(tmp_path / "a.mcap", SENT, compression)
    rewritten(path, opcode, place, size)
    code, err = said(capsys, path)
    assert (code, "error[LTL811]" in err) == (2, True) or (opcode, code) == (CHUNK_INDEX, 0), err
    assert "bug" not in err
    assert "ends with" not in err


DEFINITIONS = {
    "an array of twenty digits": "float64[99999999999999999999] a\nfloat64 v\n",
    "an array of messages of twenty digits": "P[99999999999999999999] a\nfloat64 v\n"
    f"{'=' * 80}\nMSG: p/P\nuint8 b\nfloat32 c\n",
    "a type in itself": "T a\nfloat64 v\n",
    "a type in itself, by way of another": f"P a\nfloat64 v\n{'=' * 80}\nMSG: p/P\nT b\n",
    "a type in a list of itself": "T[] a\nfloat64 v\n",
    "types that double": "A0 a\nfloat64 v\n"
    + "".join(f"{'=' * 80}\nMSG: p/A{k}\nA{k + 1} a\nA{k + 1} b\n" for k in range(60))
    + f"{'=' * 80}\nMSG: p/A60\nuint8 b\nfloat32 c\n",
    "types nested deeply": "A0 a\nfloat64 v\n"
    + "".join(f"{'=' * 80}\nMSG: p/A{k}\nA{k + 1} a\n" for k in range(3000))
    + f"{'=' * 80}\nMSG: p/A3000\nuint8 b\nfloat32 c\n",
    "a large array in a small message": "float64[1000000] a\nfloat64 v\n",
    "many messages in a small message": f"P[10000000] a\nfloat64 v\n{'=' * 80}\nMSG: p/P\nuint8 b\nfloat32 c\n",
    "types that double a little": "A0 a\nfloat64 v\n"
    + "".join(f"{'=' * 80}\nMSG: p/A{k}\nA{k + 1} a\nA{k + 1} b\n" for k in range(25))
    + f"{'=' * 80}\nMSG: p/A25\nuint8 b\nfloat32 c\n",
}


@pytest.mark.parametrize("definition", DEFINITIONS)
def test_a_definition_that_no_message_can_have_is_damage(capsys: Capture, tmp_path: Path, definition: str) -> None:
    raw_properties("float64 v\n")
    path = raw(tmp_path / "a.mcap", DEFINITIONS[definition], bytes([0, 1, 0, 0, *bytes(16)]), [START, START + SECOND])
    code, err = said(capsys, path, "--msg-path", "messages")
    assert (code, "error[LTL811]" in err) == (2, True), err
    assert "ends with" not in err


@pytest.mark.parametrize(
    "header",
    [
        "uint32 nothing",
        "builtin_interfaces/Time stamp",
        "builtin_interfaces/Time[] stamp",
        "float64 stamp",
        "Header stamp",
    ],
)
def test_a_header_without_a_stamp_has_the_time_of_recording(capsys: Capture, tmp_path: Path, header: str) -> None:
    raw_properties("std_msgs/Header header\nfloat64 v\n")
    text = f"std_msgs/Header header\nfloat64 v\n{'=' * 80}\nMSG: std_msgs/Header\n{header}\n"
    text += f"{'=' * 80}\nMSG: builtin_interfaces/Time\nstring sec\nuint32 nanosec\n"
    path = raw(tmp_path / "a.mcap", text, bytes([0, 1, 0, 0, *bytes(40)]), [START, START + SECOND])
    code, err = said(capsys, path, "--msg-path", "messages", "--stamp", "header")
    if header == "Header stamp":
        assert (code, "error[LTL811]" in err) == (2, True), err
    else:
        assert "have no header" in err
    assert "ends with" not in err


def test_parquet_with_text_that_is_not_utf8_or_a_bad_dictionary_is_damage(capsys: Capture, tmp_path: Path) -> None:
    pa = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    Path("props.txt").write_text('decl m /m String.data\nnever m == "go"\n')
    path = tmp_path / "a.parquet"
    table = pa.table({"time": [k / 10 for k in range(100)], "m": ["abcd", "efgh", "x", "y", "z"] * 20})
    for has_dictionary in (False, True):
        parquet.write_table(table, path, compression="none", use_dictionary=["m"] if has_dictionary else False)
        content = path.read_bytes()
        path.write_bytes(content.replace(b"efgh", b"\xff\xfe\xfd\xfc"))
        code, err = said(capsys, path)
        assert (code, "column `m` has text that is not UTF-8" in err) == (2, True)
    column = parquet.ParquetFile(pa.BufferReader(content)).metadata.row_group(0).column(1)
    end = column.dictionary_page_offset + column.total_compressed_size
    path.write_bytes(content[: end - 20] + b"\xff" * 20 + content[end:])
    code, err = said(capsys, path)
    assert (code, "error[LTL820]" in err) == (2, True)


def zeros(path: Path, begin: bytes, megabytes: int) -> None:
    """A file of so many megabytes of zeros after `begin`, compressed by gzip."""
    path.write_bytes(gzip.compress(begin) + megabytes * gzip.compress(bytes(1 << 20), 1))


MEASURED = """
import os, subprocess, sys
process = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
_, status, usage = os.wait4(process.pid, 0)
print(os.waitstatus_to_exitcode(status), usage.ru_maxrss // 1000)
"""
"""Started between: a process counts the memory of the one that started it, and this one is large."""


def peak(path: Path) -> tuple[int, int]:
    """The exit code of `ltlc run` in a process of its own, and the most memory that it had, in MB."""
    command = [sys.executable, "-c", MEASURED, sys.executable, "-m", "ltlc", "run", "props.txt", str(path)]
    code, most = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    return int(code), int(most)


@pytest.mark.parametrize("form", ["csv.gz", "jsonl.gz", "mcap zstd", "mcap lz4", "mcap killed", "parquet", "db3"])
def test_what_decompresses_to_gigabytes_is_damage_and_takes_less_than_one(tmp_path: Path, form: str) -> None:
    path = tmp_path / f"bomb.{form.partition(' ')[0]}"
    match form:
        case "csv.gz":
            zeros(path, b"time,x\n0,", 1200)
        case "jsonl.gz":
            zeros(path, b'{"time": 0, "x": [', 1200)
        case "parquet":
            pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
            Path("props.txt").write_text('decl m /m String.data\nnever m == "go"\n')
            named = pa.DictionaryArray.from_arrays(pa.array([0] * 20_000, "int32"), pa.array(["a" * 1_000_000]))
            parquet.write_table(pa.table({"time": range(20_000), "m": named}), path, store_schema=False)
        case "db3":
            with closing(sqlite3.connect(path)) as database:
                database.execute("create table topics (id, name, type, serialization_format)")
                database.execute("insert into topics values (1, '/odom', 'nav_msgs/msg/Odometry', 'cdr')")
                database.execute(
                    "create view messages as with n(id) as (select 1 union all select id + 1 from n) "
                    "select id, 1 as topic_id, id as timestamp, zeroblob(100000000) as data from n"
                )
                database.commit()
        case _:
            name = form.partition(" ")[2].replace("killed", "zstd")
            packed = zstandard.compress(bytes(3 << 29)) if name == "zstd" else lz4.frame.compress(bytes(3 << 29))
            head = struct.pack("<QQQII", START, START, 1 << 20, 0, len(name)) + name.encode()
            body = head + struct.pack("<Q", len(packed)) + packed
            body = body[: len(body) - 10] if form == "mcap killed" else body
            length = len(body) + 10 * (form == "mcap killed")
            path.write_bytes(mcap(tmp_path / "a.mcap", [], is_finished=False).read_bytes()[:8])
            path.write_bytes(b"\x89MCAP0\r\n" + struct.pack("<BQ", 6, length) + body)
    code, most = peak(path)
    assert code == 2
    assert most < 1000


def many_bytes(path: Path, lengths: list[int], times: list[int], mode: str = "NONE") -> Path:
    """Arrays of so many bytes each, one after the other, which nearly vanish when they are compressed."""
    Path("props.txt").write_text("decl r /t std_msgs/UInt8MultiArray.data\nnever any(r > 5)\n")
    name = "std_msgs/msg/UInt8MultiArray"
    messages = (made(name, data=np.ones(length, np.uint8)) for length in lengths)
    sent = [Sent("/t", name, time, each) for time, each in zip(times, messages, strict=True)]
    return rosbag2(path, sent, mode=mode) if mode != "NONE" else mcap(path, sent, "ZSTD", chunk_size=1 << 26)


@pytest.mark.parametrize("form", ["large messages", "too large a message", "one time", "keys"])
def test_what_is_held_of_a_recording_at_once_takes_less_than_a_gigabyte(tmp_path: Path, form: str) -> None:
    path = tmp_path / "a.mcap"
    match form:
        case "large messages":
            path = many_bytes(tmp_path / "bag", [MOST_ELEMENTS] * 12, [START] * 12, "MESSAGE")
        case "too large a message":
            path = many_bytes(tmp_path / "bag", [1 << 26] * 8, [START] * 8, "MESSAGE")
        case "one time":
            many_bytes(path, [1 << 20] * 150, [START] * 150)
        case _:
            path = tmp_path / "a.jsonl"
            keys = ([f"k{10 * line + key}" for key in range(10)] for line in range(25_000))
            path.write_text(
                "".join(json.dumps({"time": n, **dict.fromkeys(of, 1)}) + "\n" for n, of in enumerate(keys))
            )
    code, most = peak(path)
    assert code == (0 if form in ("large messages", "one time") else 2)
    assert most < 1000


def test_an_array_with_more_elements_than_can_be_held_is_reported_with_its_place(
    capsys: Capture, tmp_path: Path
) -> None:
    path = many_bytes(tmp_path / "a.mcap", [1, MOST_ELEMENTS + 1], [START, START + SECOND])
    code, err = said(capsys, path)
    assert code == 2
    assert "error[LTL811]: the message on `/t` at 1700000001 s, after 1 on this topic, has an array of" in err
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    path = tmp_path / "a.parquet"
    parquet.write_table(pa.table({"time": [0.0, 1.0], "r": [[1.0], np.ones(MOST_ELEMENTS + 1)]}), path)
    code, err = said(capsys, path)
    assert (code, "error[LTL803]: at 1 s `r` has 4194305 elements" in err) == (2, True)


@pytest.mark.parametrize("seed", range(6))
def test_no_damage_of_a_recording_breaks_a_run(seed: int) -> None:
    """A few; `benchmarks/damage.py` goes on as long as it is let."""
    assert problem_with(damaged(seed)) is None


WRONG = {
    "exit code 1 without a violation": ("print('{}')\nreturn 1", "says otherwise"),
    "a violation without exit code 1": ("""print('"verdict": "violated"')\nreturn 0""", "says otherwise"),
    "exit code 2 without a word": ("return 2", "without a word"),
    "a bug": ("1 // 0", "ZeroDivisionError"),
    "a gigabyte": ("len(bytearray(10**9))\nreturn 0", " MB"),
}


@pytest.mark.parametrize(("body", "said"), WRONG.values(), ids=WRONG)
def test_what_a_run_may_not_do_is_noticed(body: str, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    made_up: dict[str, object] = {}
    exec("def run(options):\n    " + body.replace("\n", "\n    "), made_up)
    monkeypatch.setattr("ltlc.interfaces.commands.run.run", made_up["run"])
    assert said in str(problem_with(Case(("run", "props.txt", "a.csv"))))
