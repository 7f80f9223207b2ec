"""`ltlc falsify` as a command: what a simulation gets and leaves, what fails, and what is kept."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import sys
import time
from collections.abc import Callable
from errno import ENOSPC
from pathlib import Path

import pytest
from bag_support import FORMS, odometry

from ltlc.cli import main
from ltlc.falsification.command import Command, command_of
from ltlc.falsification.domains import PORTS, free_domains
from ltlc.falsification.keeping import keep
from ltlc.falsification.parameters import space_of
from ltlc.falsification.process import uninterrupted

PROPS = """
decl v /odom nav_msgs/Odometry.twist.twist.linear.x
slow: never v > 2
"""
SIMULATOR = """
import json, sys
given = json.load(open(sys.argv[1]))
with open(sys.argv[2], "w") as file:
    file.write("time,v\\n" + "".join(f"{k / 10},{given['gain'] * k / 10}\\n" for k in range(11)))
print("simulated", given["gain"])
"""
SIMULATE = f"{sys.executable} sim.py {{parameters}} {{recording}}.csv"

Falsify = Callable[..., int]


@pytest.fixture
def falsify(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Falsify:
    """Runs the command in a folder with a specification and a simulator."""
    monkeypatch.chdir(tmp_path)
    Path("props.txt").write_text(PROPS)
    Path("sim.py").write_text(SIMULATOR)

    def run(*arguments: str, simulate: str = SIMULATE, parameter: str = "gain=0..1..4", simulations: int = 12) -> int:
        options = ["--simulate", simulate, "--parameter", parameter, "--simulations", str(simulations)]
        try:
            return main(["falsify", "props.txt", *options, *arguments])
        except SystemExit as error:
            return int(error.code or 0)

    return run


Said = pytest.CaptureFixture[str]


def test_what_is_found_is_kept_and_violates_the_property_in_ltlc_run(falsify: Falsify, capsys: Said) -> None:
    assert falsify() == 1
    told = capsys.readouterr()
    assert "slow is violated in simulation " in told.out
    assert "Error at line 3 of props.txt (slow):" in told.out
    assert sorted(os.listdir("falsified")) == ["falsified.json", "output.txt", "parameters.json", "recording.csv"]
    assert main(["run", "props.txt", "falsified/recording.csv"]) == 1
    gain = json.loads(Path("falsified/parameters.json").read_text())["gain"]
    assert f"gain  {gain:g}  (default 1)" in told.out
    assert Path("falsified/output.txt").read_text() == f"simulated {gain}\n"
    assert 2 < gain <= 3


def test_it_is_one_document_in_json_which_is_kept_too(falsify: Falsify, capsys: Said) -> None:
    assert falsify("--format", "json") == 1
    told = capsys.readouterr()
    document = json.loads(told.out)
    assert json.loads(Path("falsified/falsified.json").read_text()) == document
    assert document["smallest"]["assignment"] == json.loads(Path("falsified/parameters.json").read_text())
    assert document["smallest"]["property"] == "slow"
    assert [each["name"] for each in document["provenance"]["recordings"]]
    assert not re.search(r"^\d+:", told.err, re.MULTILINE)


def test_each_simulation_has_a_line_unless_it_is_to_be_quiet(falsify: Falsify, capsys: Said) -> None:
    assert falsify(parameter="gain=0..1..2", simulations=4) == 0
    assert re.findall(r"^(\d+): gain=", capsys.readouterr().err, re.MULTILINE) == ["1", "2", "3", "4"]
    assert falsify("--quiet", parameter="gain=0..1..2", simulations=4) == 0
    assert capsys.readouterr().err == ""


def test_a_command_gets_values_one_by_one(falsify: Falsify, capsys: Said) -> None:
    script = (
        "printf 'time,v\\n0,%s\\n1,%s\\n' {gain} {n} > {recording}.csv; test {floor} = 'very wet' && test {{ = '{{'"
    )
    quoted = f'''sh -c "{script.replace("{floor}", "'{floor}'")}"'''
    assert falsify(
        *("--parameter", "n:int=0..1..3", "--parameter", "floor=very wet,dry"), simulate=quoted, simulations=1
    ) in (0, 1), capsys.readouterr().err


def test_any_form_of_recordings_will_do(falsify: Falsify, tmp_path: Path) -> None:
    bag = FORMS["sqlite3"](tmp_path, [odometry(k, twist__twist__linear__x=3.0) for k in range(3)])
    assert falsify(simulate=f"sh -c 'cp -r {bag} {{recording}}' {{gain}}") == 1
    assert main(["run", "props.txt", "falsified/recording"]) == 1


def test_a_folder_of_an_earlier_search_is_replaced_and_no_other(falsify: Falsify, capsys: Said) -> None:
    assert falsify() == 1
    Path("falsified/notes.txt").write_text("from the first search")
    assert falsify("--seed", "4") == 1
    assert not Path("falsified/notes.txt").exists()
    Path("mine").mkdir()
    Path("mine/notes.txt").write_text("kept")
    capsys.readouterr()
    assert falsify("--keep", "mine") == 2
    assert "mine cannot be written: it contains something other than what ltlc falsify keeps" in capsys.readouterr().err
    assert falsify("--keep", "no/such/folder") == 2
    assert sorted(os.listdir()) == ["falsified", "mine", "props.txt", "sim.py"]


def test_what_was_kept_before_stays_if_its_place_cannot_be_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, folder = tmp_path / "made", tmp_path / "kept"
    made.mkdir()
    keep(made, folder, "first")
    rename = os.rename

    def full(source: Path, target: Path) -> None:
        if source.name == "made":
            raise OSError(ENOSPC, "no space left")
        rename(source, target)

    monkeypatch.setattr(os, "rename", full)
    with pytest.raises(OSError, match="no space left"):
        keep(made, folder, "second")
    assert (folder / "falsified.json").read_text() == "first"
    assert sorted(os.listdir(tmp_path)) == ["kept", "made"]


def test_where_nothing_is_found_nothing_is_kept(falsify: Falsify, capsys: Said) -> None:
    assert falsify(parameter="gain=0..1..2") == 0
    assert "which proves nothing" in capsys.readouterr().out
    assert sorted(os.listdir()) == ["props.txt", "sim.py"]


@pytest.mark.parametrize(
    ("simulate", "reason"),
    [
        ("", "the command is empty"),
        ("sim '{gain} {recording}", "the command cannot be read: no closing quotation"),
        ("sim {gain}", "the command does not get {recording}"),
        ("sim {recording}", "the command does not get `gain`: add {gain} or {parameters}"),
        ("sim {gian} {recording}", "there is no parameter for `{gian}` (a brace is written {{): did you mean `gain`?"),
        ("sim {gain} {seconds} {recording}", "there is no parameter for `{seconds}`"),
    ],
)
def test_a_command_that_lacks_something_is_refused(falsify: Falsify, capsys: Said, simulate: str, reason: str) -> None:
    assert falsify(simulate=simulate) == 2
    assert reason in capsys.readouterr().err


def test_inputs_and_seconds_have_to_reach_the_command() -> None:
    space = space_of([], ["push=0..1@3"], 5.0)
    for text, reason in (
        ("sim {push} {recording}", "`{push}` is an input, whose values over time are in the file {parameters}"),
        ("sim {seconds} {recording}", "the command does not get `push`: add {parameters}, a JSON file"),
    ):
        with pytest.raises(ValueError, match=re.escape(reason)):
            command_of(text, space, 10**9)
    assert command_of("sim {parameters} {recording}", space, 10**9).arguments[0] == "sim"


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        ("echo it broke >&2; exit 3", "it ended with exit code 3: it broke"),
        ("kill -9 $$", "it was ended by SIGKILL"),
        ("true", "it wrote no {recording}"),
        ("touch {recording}_1.csv", "it wrote no {recording}, but recording_1.csv"),
        ("touch {recording}.csv {recording}.jsonl", "it wrote several recordings: recording.csv, recording.jsonl"),
        ("touch {recording}.log", "recording.log` is not a recording; a bag is a folder"),
        ("printf 'time,v\\\\n0,1\\\\n1' > {recording}.csv", "line 3: 1 cells, but the header has 2"),
        ("printf 'time,v\\\\n1,1\\\\n0,0\\\\n' > {recording}.csv", "its recording cannot be judged: "),
        ("printf '\\\\211MCAP0\\\\r\\\\nxx' > {recording}.mcap", "its recording cannot be judged: "),
    ],
)
def test_a_simulation_that_fails_at_once_ends_the_search(
    falsify: Falsify, capsys: Said, script: str, reason: str
) -> None:
    assert falsify(simulate=f'sh -c "{script}" {{gain}} {{recording}}') == 2
    told = capsys.readouterr()
    assert "ltlc: the first simulation, with all defaults, failed: " in told.err
    assert reason in told.err
    assert "Traceback" not in told.err
    assert (told.out, sorted(os.listdir())) == ("", ["props.txt", "sim.py"])


def test_a_program_that_is_not_there_is_named(falsify: Falsify, capsys: Said) -> None:
    assert falsify(simulate="no_such_simulator {gain} {recording}") == 2
    assert "`no_such_simulator` cannot be started: No such file or directory" in capsys.readouterr().err


def test_simulations_that_fail_later_are_counted_and_nothing_found_is_no_success(
    falsify: Falsify, capsys: Said
) -> None:
    Path("sim.py").write_text(f"{SIMULATOR}assert given['gain'] < 1.5, 'too fast'\n")
    assert falsify(parameter="gain=0..1..2", simulations=12) == 2
    told = capsys.readouterr()
    failed = re.search(
        r"^(\d+) simulations failed, the first of them (\d+): it ended with exit code 1: (.*)$", told.out, re.M
    )
    assert failed is not None
    assert failed[3] == "AssertionError: too fast"
    assert len(re.findall("AssertionError: too fast", told.err)) == int(failed[1])


def test_a_simulation_that_takes_too_long_is_ended(tmp_path: Path) -> None:
    space = space_of(["gain=0..1"], [], None)
    command = command_of("sleep 1000 {gain} {recording}", space, 10**7)
    command = Command(["sleep", "1000"], command.time_limit)
    [left] = command.simulate([space.defaults()], tmp_path)
    assert str(left.recording) == "it took more than 10 ms"


def test_nothing_that_a_simulation_starts_is_left_running(tmp_path: Path) -> None:
    space = space_of(["gain=0..1"], [], None)
    script = f"sleep 1000 & echo $! > {tmp_path}/pid; touch {{recording}}.csv"
    command = command_of(f"sh -c '{script}' {{gain}}", space, 60 * 10**9)
    assert len(list(command.simulate([space.defaults()], tmp_path))) == 1
    wait_for_end(int((tmp_path / "pid").read_text()))


def wait_for_end(pid: int) -> None:
    """Return when there is no such process, or nothing of it but its exit code."""
    while (state := Path(f"/proc/{pid}/stat")).exists() and state.read_text().rsplit(")", 1)[1].split()[0] != "Z":
        time.sleep(0.01)


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_an_interrupted_search_says_how_far_it_came_and_leaves_nothing_running(
    falsify: Falsify, capsys: Said, name: str
) -> None:
    Path("sim.py").write_text(SIMULATOR + INTERRUPT.format(when="given['gain'] != 1", name=name))
    assert falsify("--jobs", "2", parameter="gain=0..1..2") == 3
    told = capsys.readouterr().out
    assert "Interrupted" in told
    assert "No property is violated in 1 simulation (seed 0), which proves nothing." in told
    assert "  slow: 1 at least, in simulation 1: gain=1" in told
    for path in Path().glob("pid.*"):
        wait_for_end(int(path.suffix[1:]))


INTERRUPT = """
import os, pathlib, signal, time
if {when}:
    pathlib.Path(f"pid.{{os.getpid()}}").touch()
    try:
        open("one", "x")
    except FileExistsError:
        pass
    else:
        os.kill(os.getppid(), signal.{name})
    time.sleep(1000)
"""


def test_ctrl_c_while_a_simulation_is_started_comes_once_it_can_be_ended() -> None:
    begun = []
    with pytest.raises(KeyboardInterrupt):  # noqa: PT012
        with uninterrupted():
            signal.raise_signal(signal.SIGINT)
            begun.append("simulation")
        pytest.fail("it was lost")
    assert begun


def test_what_was_found_before_shrinking_was_interrupted_is_kept(falsify: Falsify, capsys: Said) -> None:
    assert falsify() == 1
    capsys.readouterr()
    found = json.loads(Path("falsified/falsified.json").read_text())["found"]
    for more, said in ((1, "It was not simulated again"), (2, "Shrunk in 1 more simulation:")):
        Path("count").write_text("")
        Path("one").unlink(missing_ok=True)
        again = f"open('count', 'a').write('x'); again = len(open('count').read()) == {found['simulation'] + more}\n"
        Path("sim.py").write_text(SIMULATOR + again + INTERRUPT.format(when="again", name="SIGINT"))
        assert falsify() == 1
        told = capsys.readouterr().out
        assert said in told
        assert "Interrupted" in told
        assert json.loads(Path("falsified/parameters.json").read_text()) == found["assignment"]
        assert json.loads(Path("falsified/falsified.json").read_text())["interrupted"]


WAITS = """
import os, pathlib, time
if given["floor"] != "dry":
    pathlib.Path(given["floor"]).touch()
    while not pathlib.Path({"wet": "ice", "ice": "wet"}[given["floor"]]).exists():
        time.sleep(0.01)
if given["floor"] == "wet":
    while not pathlib.Path("ice.done").exists():
        time.sleep(0.01)
pathlib.Path(given["floor"] + ".done").write_text(f"{os.environ['ROS_DOMAIN_ID']} {sys.argv[3]}")
"""


def test_jobs_run_side_by_side_in_ros_domains_of_their_own_and_are_reported_in_order(
    falsify: Falsify, capsys: Said, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "0")
    Path("sim.py").write_text(SIMULATOR.replace("json.load", "{'gain': 1} | json.load") + WAITS)
    code = falsify("--jobs", "2", simulate=f"{SIMULATE} {{job}}", parameter="floor=dry,wet,ice", simulations=3)
    told = capsys.readouterr()
    assert code == 0, told
    assert re.findall(r"^\d+: floor=(\w+)", told.err, re.MULTILINE) == ["dry", "wet", "ice"]
    domains, jobs = zip(*(Path(f"{floor}.done").read_text().split() for floor in ("wet", "ice")), strict=True)
    assert len({*domains, "0"}) == 3
    assert jobs == ("0", "1")


def test_what_is_found_does_not_depend_on_jobs(falsify: Falsify, capsys: Said) -> None:
    found = []
    for jobs in ("1", "2", "5"):
        assert falsify("--jobs", jobs, "--parameter", "noise=0..1", parameter="gain=0..1..2.2", simulations=40) == 1
        told = capsys.readouterr()
        document = json.loads(Path("falsified/falsified.json").read_text())
        del document["provenance"]
        found.append((told.out, told.err, document, Path("falsified/recording.csv").read_text()))
    assert found[0] == found[1] == found[2]
    assert found[0][2]["simulations"] > 9, "the search is to be guided"


def test_of_the_recordings_of_a_search_no_more_than_two_stay_beside_that_which_is_made(falsify: Falsify) -> None:
    Path("sim.py").write_text(
        f"{SIMULATOR}import pathlib\nprint(*pathlib.Path(sys.argv[2]).parents[1].iterdir(), file=open('seen', 'a'))\n"
    )
    assert falsify() == 1
    counts = [len(line.split()) for line in Path("seen").read_text().splitlines()]
    assert (counts[0], max(counts)) == (1, 3)
    document = json.loads(Path("falsified/falsified.json").read_text())
    assert len(counts) == document["simulations"] + document["shrinking"], "no more are simulated than are looked at"


TWO = f"{PROPS}fast: always v < 1\n"


def test_only_the_properties_that_are_chosen_are_searched(falsify: Falsify, capsys: Said) -> None:
    Path("props.txt").write_text(TWO)
    assert falsify(parameter="gain=0..0.5..2") == 1
    assert "fast is violated" in capsys.readouterr().out
    assert falsify("--property", "slow", parameter="gain=0..0.5..2") == 0
    assert "  fast: not searched" in capsys.readouterr().out
    assert falsify("--property", "slow", "--format", "json", parameter="gain=0..0.5..2") == 0
    document = json.loads(capsys.readouterr().out)
    assert [each["label"] for each in document["properties"]] == ["slow"]
    assert document["not_searched"] == ["fast"]
    assert falsify("--property", "fast", "--property", "slow", parameter="gain=0..0.5..2") == 1


def test_a_property_that_is_not_there_is_refused(falsify: Falsify, capsys: Said) -> None:
    assert falsify("--property", "slw") == 2
    assert "there is no property `slw`: did you mean `slow`?" in capsys.readouterr().err


@pytest.mark.parametrize(
    "option", [("--seed", "-1"), ("--seed", "x"), ("--simulations", "0"), ("--time-limit", "soon")]
)
def test_options_that_cannot_be_are_refused(falsify: Falsify, option: tuple[str, str]) -> None:
    assert falsify(*option) == 2


def test_an_error_in_the_specification_is_reported_before_anything_is_simulated(falsify: Falsify, capsys: Said) -> None:
    Path("props.txt").write_text(PROPS.replace("v > 2", "w > 2"))
    assert falsify(simulate="touch {recording}.csv simulated {gain}") == 2
    assert "error[LTL101]" in capsys.readouterr().err
    assert not Path("simulated").exists()


def test_more_jobs_than_there_are_free_domains_are_refused(
    falsify: Falsify, capsys: Said, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ltlc.falsification.domains.DOMAINS", range(0))
    assert falsify("--jobs", "2") == 2
    assert "--jobs 2: only 0 ROS domains are free on this machine" in capsys.readouterr().err


def test_a_domain_is_given_to_one_at_a_time() -> None:
    with free_domains(1) as first, free_domains(2) as others:
        assert first
        assert not set(first) & set(others)


def test_a_domain_in_which_something_listens_is_not_given(monkeypatch: pytest.MonkeyPatch) -> None:
    while True:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as node:
            node.bind(("", 0))
            domain, offset = divmod(node.getsockname()[1] - 7400, 250)
            if offset < PORTS:
                monkeypatch.setattr("ltlc.falsification.domains.DOMAINS", [domain])
                with free_domains(1) as found:
                    assert found == []
                return
