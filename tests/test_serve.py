"""The server of `ltlc serve`: what it answers, and whom and what it refuses."""

from __future__ import annotations

import errno
import http.client
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from base64 import b64encode
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest
from bag_support import LEVEL, Sent, made, mcap, odometry, ros1, rosbag2
from hypothesis import given, settings
from hypothesis import strategies as st

from ltlc.base.limits import Budget
from ltlc.cli import main
from ltlc.interfaces.serve import server as serving
from ltlc.interfaces.serve.answers import ANSWERS
from ltlc.interfaces.serve.questions import MOST_STEPS
from ltlc.interfaces.serve.server import MOST_BYTES, MOST_OF_A_FILE, Server
from ltlc.interfaces.serve.start import Start

pytestmark = pytest.mark.live

TEXT = """decl v /v Float64.data
decl near /near Bool.data
slow: never v > 2
stop: after_until near, not near, eventually v =={0.1} 0
answer: always (near implies eventually v < 1 within 1500 ms)
"""


@contextmanager
def served(start: Start | None = None) -> Iterator[Server]:
    with Server("127.0.0.1", 0, start or Start()) as server:
        thread = threading.Thread(target=partial(server.serve_forever, poll_interval=0.01))
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with served(Start("props.txt", TEXT)) as server:
        yield server


Answer = tuple[int, dict[str, str], bytes]


def ask(server: Server, method: str, path: str, body: bytes | None = None, **headers: str) -> Answer:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=60)
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
    given = {"Host": f"127.0.0.1:{server.server_address[1]}", "Content-Type": "application/json"}
    if body is not None:
        given["Content-Length"] = str(len(body))
    for name, value in (given | named).items():
        connection.putheader(name, value)
    connection.endheaders(body)
    response = connection.getresponse()
    found = response.status, dict(response.getheaders()), response.read()
    connection.close()
    return found


def post(server: Server, what: str, question: object) -> tuple[int, Any]:
    status, _, body = ask(server, "POST", f"{server.base}{what}", json.dumps(question).encode())
    return status, json.loads(body)


def answer(server: Server, what: str, **question: object) -> Any:
    status, found = post(server, what, question)
    assert status == 200, found
    return found


PLACES = [("GET", "/"), ("GET", "/start.json"), ("GET", "/main.js"), ("GET", "/codes/LTL101"), ("GET", "/nothing")]
PLACES += [("POST", f"/{what}") for what in ANSWERS]


@pytest.mark.parametrize(("method", "path"), PLACES)
def test_a_request_that_names_another_host_is_refused(server: Server, method: str, path: str) -> None:
    for host in (
        "evil.example",
        "evil.example:80",
        "127.0.0.1.evil.example",
        "localhost.evil.example",
        "",
        "[",
        "10.0.0.1",
    ):
        assert ask(server, method, path, b"{}", Host=host)[0] == 403, host


@pytest.mark.parametrize(("method", "path"), PLACES)
def test_a_request_from_the_page_of_another_origin_is_refused(server: Server, method: str, path: str) -> None:
    port = server.server_address[1]
    for origin in ("http://evil.example", "null", f"https://127.0.0.1:{port}", f"http://127.0.0.1:{port + 1}", ""):
        assert ask(server, method, path, b"{}", Origin=origin)[0] == 403, origin


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "LOCALHOST", "[::1]"])
def test_the_page_itself_may_ask_whatever_name_of_this_machine_it_was_opened_by(server: Server, host: str) -> None:
    here = f"{host}:{server.server_address[1]}"
    body = json.dumps({"text": TEXT}).encode()
    assert ask(server, "POST", "/check", body, Host=here, Origin=f"http://{here}")[0] == 200


def test_two_hosts_are_one_too_many(server: Server) -> None:
    with socket.create_connection(("127.0.0.1", server.server_address[1])) as connection:
        connection.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n")
        assert connection.recv(100).startswith(b"HTTP/1.1 403 ")


@pytest.mark.parametrize(("method", "path"), [*PLACES, ("PUT", "/check"), ("POST", "/nothing")])
def test_every_answer_lets_a_browser_run_and_fetch_only_what_is_from_here(
    server: Server, method: str, path: str
) -> None:
    _, headers, _ = ask(server, method, path, b"{}")
    policy = dict(part.strip().split(" ", 1) for part in headers["Content-Security-Policy"].split(";"))
    assert policy["default-src"] == policy["frame-ancestors"] == policy["base-uri"] == "'none'"
    assert policy["script-src"] == policy["style-src"] == policy["connect-src"] == "'self'"
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Referrer-Policy"] == "no-referrer"


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data", ""])
def test_what_a_form_can_send_is_no_question(server: Server, kind: str) -> None:
    assert ask(server, "POST", "/check", b"{}", Content_Type=kind)[0] == 415


def test_what_is_no_question_gets_no_answer(server: Server) -> None:
    assert ask(server, "POST", "/nothing", b"{}", Content_Type="application/json")[0] == 404


@pytest.mark.parametrize(
    "path",
    ["/../ltlc/cli.py", "/../../etc/passwd", "/%2e%2e/cli.py", "/codes/../__init__.py", "/codes/LTL999", "/x.txt"],
)
def test_no_file_but_those_of_the_page_is_sent(server: Server, path: str) -> None:
    assert ask(server, "GET", path)[0] == 404


@pytest.mark.parametrize(
    ("length", "status"), [(str(MOST_BYTES + 1), 413), ("9" * 30, 413), ("-1", 411), ("ten", 411), ("", 411)]
)
def test_a_question_that_is_too_long_or_of_no_length_is_not_read(server: Server, length: str, status: int) -> None:
    assert ask(server, "POST", "/check", b"", Content_Length=length)[0] == status


def test_the_longest_question_is_read(server: Server) -> None:
    status, _, body = ask(server, "POST", "/check", b" " * MOST_BYTES)
    assert status == 400
    assert "not JSON" in json.loads(body)["error"]


@pytest.mark.parametrize(
    ("question", "said"),
    [
        ([], "a question is an object"),
        ({"text": 1}, "`text` is not a string"),
        ({"text": TEXT, "encoding": "dwyr"}, "there is no encoding `dwyr`"),
        ({"text": TEXT, "steps": {}}, "`steps` is not an array"),
        ({"text": TEXT, "steps": [1]}, "`steps` are objects"),
        ({"text": TEXT, "steps": [{}] * (MOST_STEPS + 1)}, f"at most {MOST_STEPS} steps"),
        ({"text": TEXT, "property": 3}, "there is no property 3: there are 3"),
        ({"text": TEXT, "property": True}, "`property` is not a whole number"),
    ],
)
def test_a_question_that_makes_no_sense_is_refused_with_the_reason(server: Server, question: object, said: str) -> None:
    status, found = post(server, "judge", question)
    assert status == 400
    assert said in found["error"]


def test_what_is_not_json_is_refused(server: Server) -> None:
    for body in (b"", b"{", b"\xff", b'{"text": NaN'):
        assert ask(server, "POST", "/check", body)[0] == 400


def test_json_that_is_nested_too_deeply_ends_nothing(server: Server) -> None:
    _, _, body = ask(server, "POST", "/check", b"[" * 1_000_000)
    assert "nested too deeply" in json.loads(body)["limit"]
    assert answer(server, "check", text=TEXT)["properties"]


def test_findings_are_those_of_the_command(server: Server, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = TEXT + "quick: eventually never v > 2\nagain: never v > 2\n"
    path = tmp_path / "specification"
    path.write_text(text)
    main(["check", str(path), "--format", "json"])
    wanted = json.loads(capsys.readouterr().out.replace(str(path), "specification"))["diagnostics"]
    assert {each["code"] for each in wanted} >= {"LTL603"}
    assert answer(server, "check", text=text, analyses=True)["diagnostics"] == wanted


def test_what_the_front_end_says_comes_without_the_analyses(server: Server) -> None:
    found = answer(server, "check", text="never robot.velocty > 2 # ltlc: ignore LTL503\n")
    assert [each["code"] for each in found["diagnostics"]] == ["LTL105"]
    assert found["properties"] is None


def test_the_columns_of_a_run_are_the_signals_with_what_they_are_compared_with(server: Server) -> None:
    v, near = answer(server, "check", text=TEXT)["signals"]
    assert (v["name"], v["type"], [limit["value"] for limit in v["limits"]]) == ("v", "number", [2, 0, 1])
    assert (near["name"], near["type"]) == ("near", "boolean")


steps = st.lists(
    st.fixed_dictionaries(
        {"v": st.none() | st.sampled_from([0, 0.05, 1.5, 2.5, "nan"]), "near": st.none() | st.booleans()}
    ),
    min_size=1,
    max_size=12,
)


@settings(max_examples=8)
@given(steps=steps, gaps=st.lists(st.sampled_from(["0.1", "1", "2"]), min_size=12, max_size=12))
def test_verdicts_are_those_of_ltlc_run_on_the_same_rows(
    tmp_path_factory: pytest.TempPathFactory, steps: list[dict[str, Any]], gaps: list[str]
) -> None:
    from decimal import Decimal

    time_, rows = Decimal(0), []
    for step, gap in zip(steps, gaps, strict=False):
        rows.append({"time": str(time_), **step})
        time_ += Decimal(gap)
    folder = tmp_path_factory.mktemp("rows")
    (folder / "specification").write_text(TEXT)
    (folder / "run.jsonl").write_text("".join(json.dumps(r | {"time": float(r["time"])}) + "\n" for r in rows))
    wanted = _command(folder)
    found = json.loads(ANSWERS["judge"](json.dumps({"text": TEXT, "steps": rows}).encode(), ()))
    assert [each["verdict"] for each in found["properties"]] == [each["verdict"] for each in wanted]
    for of_page, of_command in zip(found["properties"], wanted, strict=True):
        decided = of_command["decided_at"]
        last = of_page["changes"][-1] if of_page["verdict"] in ("violated", "satisfied") else None
        assert (last and last["time_ns"]) == (decided and decided["time_ns"])
        at = dict(zip(of_command["times_ns"], of_command["verdicts"], strict=True))
        shown = dict(zip([int(Decimal(row["time"]) * 10**9) for row in rows], of_page["rows"], strict=True))
        assert all(shown[when] == verdict for when, verdict in at.items() if when in shown)


def _command(folder: Path, recording: Path | None = None) -> list[dict[str, Any]]:
    """The properties in the document of `ltlc run`."""
    from contextlib import redirect_stderr, redirect_stdout
    from io import StringIO

    out = StringIO()
    with redirect_stdout(out), redirect_stderr(StringIO()):
        run = str(recording or folder / "run.jsonl")
        main(["run", str(folder / "specification"), run, "--format", "json", "--verdicts"])
    found: list[dict[str, Any]] = json.loads(out.getvalue())["properties"]
    return found


def row(time: float, v: object, near: object = False) -> dict[str, object]:
    return {"time": time, "v": v, "near": near}


DRIVE = """decl odom /odom Odometry.twist.twist.linear.x
decl level /level Level.state
object robot /odom Odometry
fast: never robot.velocity > 1.5
fresh: always age(odom) < 400 ms
rising: after_until level == 3, level == 1, always odom - @{odom, -1} < 0.3
late: always age(level) < 2 s
named: eventually level in {Level.FULL}
"""


def sent() -> list[Sent]:
    """A drive whose topics begin and end at different times."""
    odometries = [
        odometry(10**9 + 10**8 * number, twist__twist__linear__x=number / 20, twist__twist__linear__y=0.1)
        for number in range(40)
    ]
    levels = [Sent("/level", LEVEL, 3 * 10**8 * number, made(LEVEL, state=1 + number % 3)) for number in range(1, 9)]
    more = [Sent("/go", "std_msgs/msg/Bool", time, made("std_msgs/msg/Bool")) for time in (0, 9 * 10**9)]
    return sorted([*odometries, *levels, *more], key=lambda each: each.time)


def in_base64(path: Path) -> dict[str, str]:
    return {"file": path.name, "content": b64encode(path.read_bytes()).decode()}


BAGS: dict[str, Callable[[Path], Path]] = {
    "drive.mcap": lambda folder: mcap(folder / "drive.mcap", sent()),
    "drive.bag": lambda folder: ros1(folder / "drive.bag", sent()),
    "drive.db3": lambda folder: next(rosbag2(folder / "drive", sent()).glob("*.db3")),
}


@pytest.mark.parametrize("name", BAGS)
def test_a_bag_that_is_dropped_is_judged_as_ltlc_run_judges_it(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = BAGS[name](tmp_path)
    (tmp_path / "left").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "left"))
    (tmp_path / "specification").write_text(DRIVE)
    with served(Start("props.txt", DRIVE, (str(bag),))) as server:
        opened = answer(server, "open", text=DRIVE, **in_base64(bag))
        assert (opened["diagnostics"], opened["remark"]) == ([], "")
        steps = [
            {"time": row["time"]} | {of: json.loads(cell) for of, cell in row["cells"].items()}
            for row in opened["rows"]
        ]
        assert (steps[0]["time"], steps[-1]["time"]) == ("0", "9")
        judged = answer(server, "judge", text=DRIVE, steps=steps)["properties"]
    wanted = _command(tmp_path, bag)
    assert [each["verdict"] for each in judged] == [each["verdict"] for each in wanted]
    assert {each["verdict"] for each in wanted} > {"violated", "satisfied"}
    for of_page, of_command in zip(judged, wanted, strict=True):
        decided = of_command["decided_at"]
        assert decided is None or of_page["changes"][-1]["time_ns"] == decided["time_ns"]
    assert list((tmp_path / "left").iterdir()) == []


def test_of_a_long_recording_the_first_rows_are_opened_and_the_page_says_so(server: Server, tmp_path: Path) -> None:
    long = tmp_path / "long.jsonl"
    long.write_text("".join(f'{{"time": {5 + number}, "v": {number}}}\n' for number in range(MOST_STEPS + 1)))
    opened = answer(server, "open", text=TEXT, **in_base64(long))
    assert len(opened["rows"]) == MOST_STEPS - 1
    assert opened["rows"][1] == {"time": "1", "cells": {"v": "1"}}
    assert opened["remark"].startswith(f"only the first {MOST_STEPS - 1} rows of long.jsonl are here")


@pytest.mark.parametrize(
    ("file", "content", "status", "said"),
    [
        ("run.mcap", "AAAA", 200, "run.mcap"),
        ("../run.jsonl", "AAAA", 200, "run.jsonl"),
        ("run.jsonl", "?", 400, "`content` is not base64"),
        ("..", "AAAA", 400, "`file` is not the name of a file"),
        ("", "AAAA", 400, "`file` is not the name of a file"),
        ("a\0.bag", "AAAA", 400, "`file` is not the name of a file"),
        ("run.exe", "AAAA", 200, "`run.exe` is not a recording"),
    ],
)
def test_a_file_that_is_no_recording_is_reported_and_not_kept(
    server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, file: str, content: str, status: int, said: str
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    found = post(server, "open", {"text": TEXT, "file": file, "content": content})
    assert found[0] == status
    assert said in json.dumps(found[1])
    assert str(tmp_path) not in json.dumps(found[1])
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_too_large_is_not_read(server: Server) -> None:
    status, _, body = ask(server, "POST", "/open", b"", Content_Length=str(2 * MOST_OF_A_FILE))
    assert (status, "at most" in body.decode()) == (413, True)


def test_a_value_that_fits_no_signal_is_told_with_its_row_and_those_before_are_judged(server: Server) -> None:
    found = answer(server, "judge", text=TEXT, steps=[row(0, 1), row(1, "fast"), row(2, 1)])
    (said,) = found["diagnostics"]
    assert (said["code"], "row 2" in said["message"]) == ("LTL803", True)
    assert found["properties"][0]["rows"] == ["presumably_satisfied", None, None]


def test_a_violation_comes_with_its_failing_state(server: Server) -> None:
    found = answer(server, "judge", text=TEXT, steps=[row(0, 1), row(1, 3)])["properties"][0]
    assert found["rows"] == ["presumably_satisfied", "violated"]
    assert "Failing state:\n  v: 3.0\n" in found["figure"]


def test_a_deadline_that_passes_between_two_steps_shows_at_the_second(server: Server) -> None:
    found = answer(server, "judge", text=TEXT, steps=[row(0, 2, True), row(1, 2, True), row(2, 2, True)])
    changes = found["properties"][2]["changes"]
    assert (changes[-1]["verdict"], changes[-1]["time_ns"]) == ("violated", 1_500_000_001)
    assert found["properties"][2]["rows"] == ["presumably_violated", "presumably_violated", "violated"]


def test_the_monitor_is_shown_as_it_is_after_the_step_that_is_looked_at(server: Server) -> None:
    steps = [row(0, 1), row(1, 3)]
    before, after = (answer(server, "judge", text=TEXT, steps=steps, at=at)["picture"] for at in (0, 1))
    assert "ended in state 0" in before["described"]
    assert "state violated passed" in after["svg"]
    assert "state violated passed" not in before["svg"]


def test_a_run_without_steps_shows_a_monitor_that_has_not_moved(server: Server) -> None:
    found = answer(server, "judge", text=TEXT, steps=[])
    assert [each["rows"] for each in found["properties"]] == [[], [], []]
    assert found["picture"]["svg"].startswith("<svg")


def test_the_map_of_a_zone_is_shown_as_it_is_after_the_step_that_is_looked_at(server: Server) -> None:
    text = "decl x /x Float64.data\nzone dock = [(0, 0), (1, 0), (1, 1)]\nnever inside(x, 0, dock)"
    steps = [{"time": "0", "x": 2}, {"time": "1", "x": 1}]
    before, after = (answer(server, "judge", text=text, steps=steps, at=at)["maps"] for at in (0, 1))
    assert before[0]["described"] == "The path stays outside dock."
    assert after[0]["described"] == "The path starts outside dock. At +1 s it enters dock."
    assert "violated at +1 s" in after[0]["svg"]


def test_a_specification_with_errors_has_nothing_to_judge(server: Server) -> None:
    assert post(server, "judge", {"text": "never v >"}) == (200, {"error": "the specification has errors"})


def test_an_explanation_has_a_run_for_each_verdict(server: Server) -> None:
    found = answer(server, "explain", text=TEXT, property=1)
    last = {example["steps"][-1]["remark"] for example in found["examples"]}
    assert last == {"violated", "presumably violated", "presumably satisfied"}


@pytest.mark.parametrize("what", ["check", "judge", "explain", "compare"])
def test_infinite_values_are_strings_in_json(server: Server, what: str) -> None:
    text = "never robot.position.x == 1e999\n"
    steps = [{"time": 0, "robot.position.x": "inf"}]
    answer(server, what, text=text, steps=steps, analyses=True)  # json.dumps refuses what is not JSON


def test_encodings_that_differ_have_a_run_that_tells_them_apart(server: Server) -> None:
    found = answer(server, "compare", text="after_until a.velocity > 1, a.velocity < 1, eventually b.velocity == 0\n")
    pairs = {(each["left"], each["right"]): each["finite"] for each in found["comparisons"]}
    run = pairs["episode", "pointwise-strong"]["left_only"]
    verdicts = {
        name: answer(
            server,
            "judge",
            text=found["text"],
            encoding=name,
            steps=[{"time": n, **step["values"]} for n, step in enumerate(run["steps"])],
        )["properties"][0]["verdict"]
        for name in ("episode", "pointwise-strong")
    }
    assert "violated" not in verdicts["episode"]
    assert "violated" in verdicts["pointwise-strong"]


def test_names_and_strings_with_markup_are_text_in_what_is_sent(server: Server) -> None:
    text = 'decl m /m String.data\nmad: never m == "</svg><script>alert(1)</script>"\n'
    found = answer(server, "judge", text=text, steps=[{"time": 0, "m": "</svg><script>alert(1)</script>"}])
    assert found["properties"][0]["verdict"] == "violated"
    assert "<script" not in found["picture"]["svg"]


def test_the_page_begins_with_the_file_of_the_command_line_and_each_example_can_be_judged(server: Server) -> None:
    start = json.loads(ask(server, "GET", "/start.json")[2])
    assert (start["name"], start["text"]) == ("props.txt", TEXT)
    for example in start["examples"]:
        found = answer(server, "check", text=example["text"], analyses=True)
        assert found["diagnostics"] == []
        assert {signal["name"] for signal in found["signals"]} == set(example["run"].split("\n")[0].split(",")[1:])


def wait_until(holds: Callable[[], bool]) -> None:
    end = time.monotonic() + 300
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.01)


def is_gone(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


def test_who_takes_too_long_is_told_the_limit(server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(serving, "OF_AN_ANSWER", Budget(0.2))
    monkeypatch.setitem(ANSWERS, "check", lambda *_: threading.Event().wait())
    assert answer(server, "check") == {"limit": "this takes longer than 0.2 s"}


@pytest.mark.parametrize("more", [b"", b"GET / HTTP/1.1\r\n\r\n"])
def test_the_work_for_who_has_gone_is_ended(
    more: bytes, server: Server, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    note = tmp_path / "pid"

    def work(*_: object) -> None:
        (tmp_path / "half").write_text(str(os.getpid()))
        (tmp_path / "half").rename(note)
        threading.Event().wait()

    monkeypatch.setitem(ANSWERS, "check", work)
    connection = http.client.HTTPConnection("127.0.0.1", server.server_address[1])
    connection.request("POST", "/check", b"{}", {"Content-Type": "application/json"})
    wait_until(note.exists)
    assert connection.sock is not None
    connection.sock.sendall(more)
    connection.sock.shutdown(
        socket.SHUT_RDWR
    )  # the child has a copy of this end, too, as the server is in this process
    connection.close()
    wait_until(lambda: is_gone(int(note.read_text())))


def test_who_waits_too_long_for_a_turn_is_told_so(server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(serving, "LONGEST_WAIT", 0.0)
    for _ in range(serving.MOST_AT_ONCE):
        server.turns.acquire()
    try:
        assert post(server, "check", {}) == (503, {"error": "too many requests at once"})
    finally:
        server.turns.release(serving.MOST_AT_ONCE)


def test_a_page_that_others_can_reach_is_below_a_path_that_nobody_guesses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(serving, "is_local", lambda host: False)
    with served() as server:
        assert len(server.base) > 20
        assert ask(server, "GET", "/")[0] == 404
        assert ask(server, "POST", "/check", b"{}")[0] == 404
        assert ask(server, "GET", server.base, Host="192.168.7.3:80")[0] == 200
        assert ask(server, "GET", server.base, Host="evil.example")[0] == 403


def test_two_servers_have_different_paths(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(serving, "is_local", lambda host: False)
    with served() as one, served() as other:
        assert one.base != other.base


def test_the_command_prints_the_address_and_ends_on_an_interrupt(tmp_path: Path) -> None:
    (tmp_path / "props.txt").write_text(TEXT)
    command = [sys.executable, "-c", HEEDING, "serve", str(tmp_path / "props.txt"), "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("ltlc: open http://127.0.0.1:")
        process.send_signal(signal.SIGINT)
        _, complaints = process.communicate(timeout=60)
    assert (process.returncode, complaints) == (0, "ltlc: ended\n")


HEEDING = """
import signal, sys
from ltlc.cli import main

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell lets what it runs in the background ignore it
sys.exit(main(sys.argv[1:]))
"""


def test_a_file_that_is_not_there_is_unusable(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", str(tmp_path / "none.txt")]) == 2
    assert "LTL901" in capsys.readouterr().err


def test_a_port_that_is_taken_is_unusable(server: Server, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--port", str(server.server_address[1])]) == 2
    port = server.server_address[1]
    assert f"another program uses port {port} of 127.0.0.1: `ltlc serve --port 0` takes" in capsys.readouterr().err


def test_an_address_of_another_machine_is_unusable(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--host", "192.0.2.1", "--port", "0"]) == 2
    assert "`--host` must be an address of this machine" in capsys.readouterr().err


def test_a_port_for_administrators_is_unusable(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(Server, "__init__", Mock(side_effect=PermissionError(errno.EACCES, "Permission denied")))
    assert main(["serve", "--port", "80"]) == 2
    assert "choose one from 1024 on, or `--port 0` for a free one" in capsys.readouterr().err


def test_a_number_that_is_no_port_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["serve", "--port", "70000"])
    assert "is not a port" in capsys.readouterr().err
