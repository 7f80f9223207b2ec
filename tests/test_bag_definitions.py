"""Who defines the messages of a bag: the bag itself, the distribution it was recorded with, a message path."""

from __future__ import annotations

import json
import re
import sqlite3
import struct
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from bag_support import FORMS, LEVEL, ODOMETRY, OLD_STORE, STORE, Sent, made, mcap, odometry, ros1, rosbag2
from mcap.writer import Writer
from rosbags.rosbag1 import Writer as Rosbag1  # noqa: TID251
from rosbags.typesys import Stores, get_typestore  # noqa: TID251
from stepping import from_text

import ltlc
from ltlc.base.limits import Budget
from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.compiler import Compiled
from ltlc.inputs.messages.distributions import from_rosbags
from ltlc.inputs.messages.texts import defined
from ltlc.inputs.recordings import open_recording
from ltlc.inputs.recordings.bags.known import message_types
from ltlc.interfaces.api.prepare import prepare
from ltlc.monitoring.judging.run import RunReport, run
from ltlc.runtime.times import SECOND
from ltlc.semantics.encodings import EPISODE
from ltlc.specification.specification import Specification

SPEED = "decl v /odom nav_msgs/Odometry.twist.twist.linear.x\nslow: never v > 2\n"
LOW = "decl level /level own_msgs/Level.level\nlow: never level > 2\n"
FULL = "decl state /level Level.state\nnot_full: never state == Level.FULL\n"
RANGE = "sensor_msgs/msg/Range"
NEAR = "decl range /range Range.range\nnear: never range < 0.5\n"

Spec = Callable[[str], str]


@pytest.fixture
def spec(tmp_path: Path) -> Spec:
    """Writes a specification, and gives its path."""

    def write(text: str) -> str:
        path = tmp_path / "props.txt"
        path.write_text(text)
        return str(path)

    return write


def levels(count: int = 4) -> list[Sent]:
    """Messages of a type of one's own, the last one too high and full."""
    found = []
    for n in range(count):
        is_last = n == count - 1
        message = made(LEVEL, level=3.0 if is_last else 1.0, state=3 if is_last else 1)
        found.append(Sent("/level", LEVEL, SECOND + n * SECOND // 10, message))
    return found


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("text", [LOW, FULL])
def test_messages_that_only_the_recording_defines_are_judged(tmp_path: Path, spec: Spec, form: str, text: str) -> None:
    path = FORMS[form](tmp_path, levels())
    assert main(["run", spec(text), str(path)]) == 1


@pytest.mark.parametrize("form", FORMS)
def test_nothing_is_said_of_definitions_where_the_recording_has_all(
    tmp_path: Path, spec: Spec, form: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = FORMS[form](tmp_path, [odometry(SECOND + n) for n in range(3)])
    assert main(["run", spec(SPEED), str(path), "--format", "json"]) == 0
    said = capsys.readouterr()
    assert (json.loads(said.out)["definitions"], "LTL818" in said.err) == ({"/odom": "the recording"}, False)


@pytest.mark.parametrize("form", ["sqlite3", "mcap", "ros1"])
def test_every_command_on_recordings_knows_what_they_define(tmp_path: Path, spec: Spec, form: str) -> None:
    path = str(FORMS[form](tmp_path, levels()))
    page, table = tmp_path / "page.html", tmp_path / "results.parquet"
    assert main(["run", spec(LOW), path, "--report", str(page)]) == 1
    assert main(["run", spec(LOW), path, "--results", str(table), "--jobs", "1"]) == 1
    assert main(["mine", spec(LOW.replace("> 2", "> ?")), path]) == 0
    assert main(["check", spec(LOW), "--recording", path]) == 0
    assert main(["check", spec(LOW), "--msg-path", path]) == 0
    assert main(["build", spec(LOW), "--msg-path", path, "--target", "python", "-o", str(tmp_path / "m.py")]) == 0
    assert ltlc.run(LOW, path).violations
    assert [len(found.violations) for found in ltlc.run_each(LOW, (Path(path) for _ in range(2)))] == [1, 1]
    assert main(["check", spec(LOW)]) == 1


@pytest.mark.parametrize("form", ["sqlite3", "mcap", "ros1"])
def test_what_is_made_of_a_bag_with_its_own_definitions_judges_it(tmp_path: Path, form: str) -> None:
    path, props = str(FORMS[form](tmp_path, levels())), str(tmp_path / "started.txt")
    assert main(["new", path, "-o", props]) == 0
    text = " ".join(Path(props).read_text().split("\n# "))
    assert "Level.level" in text
    assert f"`--msg-path {Path(path).name}` gives them to `ltlc check`" in text
    assert main(["check", props, "--recording", path, "--strict"]) == 0
    assert main(["run", props, path]) == 0


def test_a_bag_without_definitions_is_read_by_those_of_another(tmp_path: Path, spec: Spec) -> None:
    path, other = rosbag2(tmp_path / "bag", levels()), mcap(tmp_path / "other.mcap", levels(1))
    undefined(path)
    assert main(["run", spec(LOW), str(path)]) == 2  # nobody knows the type
    report = run(*known(LOW, other), path)
    assert (report.exit_code, report.definitions) == (3, {})
    assert main(["run", spec(LOW), str(path), "--msg-path", str(other)]) == 1
    assert ltlc.run(LOW, path, message_paths=[other]).violations


def known(text: str, *paths: Path) -> tuple[Sequence[Compiled], Specification]:
    """What `text` says where bags define messages."""
    prepared = prepare(Source("props.txt", text), paths, EPISODE, Budget())
    return prepared.compiled, prepared.specification


def test_a_type_of_an_unknown_package_is_not_taken_for_another_misspelt(
    spec: Spec, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", spec("decl log /log own_msgs/Log.level\nnever log > 2\n")]) == 1
    assert "`--msg-path` adds the messages of a package or a bag" in capsys.readouterr().err
    assert main(["check", spec("decl log /log rcl_interface/Log.level\nnever log > 2\n")]) == 1
    assert "did you mean `rcl_interfaces/msg/Log`?" in capsys.readouterr().err


def test_a_type_of_a_bag_that_is_nearly_one_of_ros_is_also_answered_with_how_to_add_it(
    spec: Spec, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", spec('decl text /text Strings.string_value\nnever text == ""\n')]) == 1
    assert "did you mean `String`? Otherwise, `--msg-path` adds the messages of" in capsys.readouterr().err


def test_a_second_recording_may_be_the_one_that_defines_a_type(tmp_path: Path, spec: Spec) -> None:
    first = mcap(tmp_path / "a.mcap", [odometry(SECOND + n) for n in range(3)])
    second = mcap(tmp_path / "b.mcap", levels())
    assert main(["run", spec(LOW), str(first), str(second), "--jobs", "1"]) == 1
    assert main(["run", spec(LOW), str(tmp_path / "*.mcap"), "--jobs", "1"]) == 1


def test_a_topic_of_an_unknown_type_harms_nothing_that_does_not_read_it(
    tmp_path: Path, spec: Spec, capsys: pytest.CaptureFixture[str]
) -> None:
    path = rosbag2(tmp_path / "bag", sorted([*levels(), odometry(SECOND)], key=lambda each: each.time))
    undefined(path, LEVEL)
    text = "decl v /odom nav_msgs/Odometry.twist.twist.linear.x\nslow: never v > 2\n"
    assert main(["run", spec(text), str(path)]) == 0
    assert capsys.readouterr().err == ""
    assert main(["new", str(path)]) == 0
    assert "/level [own_msgs/msg/Level]: the type is unknown" in capsys.readouterr().out


def undefined(folder: Path, type_: str = "%") -> None:
    """Take the definitions of types out of a bag in a database."""
    (file,) = folder.glob("*.db3")
    with closing(sqlite3.connect(file)) as database, database:
        database.execute("delete from message_definitions where topic_type like ?", (type_,))


def distributed(folder: Path, distribution: str) -> None:
    """Say in the metadata and the database of a bag which distribution it was recorded with; empty: neither says it."""
    (file,) = folder.glob("*.db3")
    with closing(sqlite3.connect(file)) as database, database:
        database.execute("update schema set ros_distro = ?", (distribution,))
    metadata = folder / "metadata.yaml"
    metadata.write_text(re.sub("ros_distro: .*", f"ros_distro: '{distribution}'", metadata.read_text()))


def ranges_of(distribution: str, folder: Path) -> Path:
    """A bag of ranges as a distribution has them, without definitions, which does not say which that is."""
    store = get_typestore(Stores[f"ROS2_{distribution.upper()}"])
    fields = dict.fromkeys(("field_of_view", "min_range", "max_range", "range", "variance"), 0.25)
    members = [name for name, _ in store.get_msgdef(RANGE).fields]
    header = store.types["std_msgs/msg/Header"](store.types["builtin_interfaces/msg/Time"](1, 0), "base")
    values: dict[str, Any] = {name: fields[name] for name in members if name in fields} | {
        "header": header,
        "radiation_type": 1,
    }
    data = bytes(store.serialize_cdr(store.types[RANGE](**values), RANGE))
    sent = [Sent("/range", RANGE, SECOND + n * SECOND, made(RANGE)) for n in range(3)]
    path = rosbag2(folder, sent)
    undefined(path)
    distributed(path, "")
    (file,) = path.glob("*.db3")
    with closing(sqlite3.connect(file)) as database, database:
        database.execute("update messages set data = ?", (data,))
    return path


def judged(text: str, path: Path) -> RunReport:
    return run(*from_text(text), path)


@pytest.mark.parametrize("place", ["metadata", "database", "both"])
def test_messages_without_a_definition_are_those_of_the_distribution(tmp_path: Path, place: str) -> None:
    path = ranges_of("humble", tmp_path / "bag")
    metadata = (path / "metadata.yaml").read_text()
    distributed(path, "humble")
    if place == "database":
        (path / "metadata.yaml").write_text(metadata)
    elif place == "metadata":
        said = (path / "metadata.yaml").read_text()
        distributed(path, "")
        (path / "metadata.yaml").write_text(said)
    report = judged(NEAR, path)
    assert (report.exit_code, report.document()["definitions"]) == (1, {"/range": "ROS 2 Humble"})
    (told,) = report.diagnostics
    assert (told.code, "on `/range`: ROS 2 Humble does; the recording is from ROS 2 Humble" in told.message) == (
        "LTL818",
        True,
    )


def test_which_definitions_are_taken_is_said_where_the_recording_says_nothing(tmp_path: Path) -> None:
    path = ranges_of("jazzy", tmp_path / "bag")
    report = judged(NEAR, path)
    assert (report.exit_code, report.definitions) == (1, {"/range": "ROS 2 Jazzy"})
    (told,) = report.diagnostics
    assert "ROS 2 Jazzy does; the recording does not name its ROS distribution" in told.message
    assert "--msg-path" in told.help
    distributed(path, "rolling")
    (told,) = judged(NEAR, path).diagnostics
    assert "ROS 2 Jazzy does; the recording is from ROS 2 Rolling" in told.message
    own = mcap(tmp_path / "own.mcap", [Sent("/range", RANGE, SECOND, made(RANGE))])
    assert (judged(NEAR, own).definitions, judged(NEAR, own).diagnostics) == ({"/range": "the recording"}, ())


@pytest.mark.parametrize(
    ("recorded", "said", "words"),
    [
        ("humble", "", "is 4 bytes shorter than `sensor_msgs/msg/Range` as ROS 2 Jazzy defines it"),
        ("jazzy", "humble", "is 4 bytes longer than `sensor_msgs/msg/Range` as ROS 2 Humble defines it"),
    ],
)
def test_a_message_whose_length_does_not_fit_its_definition_is_refused(
    tmp_path: Path, spec: Spec, recorded: str, said: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = ranges_of(recorded, tmp_path / "bag")
    distributed(path, said)
    assert main(["run", spec(NEAR), str(path), "--format", "json"]) == 2
    document = json.loads(capsys.readouterr().out)
    told = document["diagnostics"][-1]
    assert (told["code"], words in told["message"], "--msg-path" in told["help"]) == ("LTL811", True, True)
    assert "the message on `/range` at 1 s, the first on this topic" in told["message"]


def test_the_first_message_that_does_not_fit_is_placed(tmp_path: Path) -> None:
    path = mcap(tmp_path / "a.mcap", levels(5))
    text, _ = STORE.generate_msgdef(LEVEL, ros_version=2)
    with (tmp_path / "odd.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        channel = writer.register_channel("/level", "cdr", writer.register_schema(LEVEL, "ros2msg", text.encode()))
        for number, each in enumerate(levels(5)):
            data = each.cdr + bytes(8 if number == 3 else 0)
            writer.add_message(channel, each.time, data, each.time)
        writer.finish()
    report = run(*known(LOW, path), tmp_path / "odd.mcap")
    where = "the message on `/level` at 1.3 s, after 3 on this topic, is 8 bytes longer than"
    assert (report.exit_code, where in report.diagnostics[-1].message) == (2, True)
    assert "the definition in the recording does not match its messages" in report.diagnostics[-1].help
    assert report.session is not None
    assert report.session.tracks[0].steps == 3


def test_a_message_of_ros_1_that_does_not_fit_is_placed(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    with Rosbag1(path) as writer:
        connection = writer.add_connection("/level", LEVEL, typestore=OLD_STORE)
        for number, each in enumerate(levels(3)):
            raw = bytes(STORE.cdr_to_ros1(each.cdr, LEVEL)) + bytes(number == 1)
            writer.write(connection, each.time, raw)
    report = run(*known(LOW, path), path)
    where = "the message on `/level` at 1.1 s, after 1 on this topic, is not `own_msgs/msg/Level`"
    assert (report.exit_code, where in report.diagnostics[-1].message) == (2, True)


def test_the_sequence_number_of_a_header_of_ros_1_can_be_read(tmp_path: Path, spec: Spec) -> None:
    path = tmp_path / "a.bag"
    with Rosbag1(path) as writer:
        connection = writer.add_connection("/level", LEVEL, typestore=OLD_STORE)
        header = writer.add_connection("/header", "std_msgs/msg/Header", typestore=OLD_STORE)
        for seq in (7, 8, 10):
            of_header = struct.pack("<IIII", seq, 1, 5, 3) + b"map"
            writer.write(connection, SECOND + seq, of_header + struct.pack("<BfI", 1, seq / 2, 0))
            writer.write(header, SECOND + seq, of_header)
    text = (
        "decl seq /level own_msgs/Level.header.seq\ndecl level /level own_msgs/Level.level\n"
        "decl frame /header Header.frame_id\ndecl alone /header Header.seq\n"
        'in_order: never seq - @{seq, -1} > 1\nright: always seq == 2 * level\nmap: always frame == "map"\n'
        "alone: always alone in {7, 8, 10}\n"
    )
    found = ltlc.run(text, path)
    assert {label: verdict.name for label, verdict in found.verdicts.items()} == {
        "in_order": "VIOLATED",
        **dict.fromkeys(("right", "map", "alone"), "PRESUMABLY_SATISFIED"),
    }
    assert main(["check", spec(text)]) == 1


def with_definition(path: Path, change: Callable[[str], str]) -> Path:
    """A bag of odometry that defines it otherwise, its messages being what they were."""
    text, _ = STORE.generate_msgdef(ODOMETRY, ros_version=2)
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        schema = writer.register_schema(ODOMETRY, "ros2msg", change(text).encode())
        channel = writer.register_channel("/odom", "cdr", schema)
        for n in range(3):
            writer.add_message(channel, SECOND + n, odometry(SECOND + n).cdr, SECOND + n)
        writer.finish()
    return path


def test_a_field_that_the_recording_defines_otherwise_is_read_so_and_that_is_said(
    tmp_path: Path, spec: Spec, capsys: pytest.CaptureFixture[str]
) -> None:
    # eight bytes in each, so that the messages fit both
    path = with_definition(tmp_path / "a.mcap", lambda text: text.replace("float64 x", "int64 x"))
    assert main(["run", spec(SPEED), str(path)]) == 0
    said = capsys.readouterr().err
    assert "note[LTL818]: `v` is read as the recording defines it; elsewhere `nav_msgs/msg/Odometry` has" in said
    assert f"`--msg-path {path}`" in said
    assert main(["run", spec(SPEED), str(path), "--msg-path", str(path)]) == 0
    assert "LTL818" not in capsys.readouterr().err


def test_a_specification_that_was_checked_with_another_definition_is_told_so(tmp_path: Path) -> None:
    path = with_definition(tmp_path / "a.mcap", lambda text: text.replace("float64 x", "int64 x"))
    (told,) = judged(SPEED, path).diagnostics
    assert (told.code, "other numbers than the specification was checked with" in told.message) == ("LTL806", True)


def test_check_finds_what_a_recording_lacks(tmp_path: Path, spec: Spec, capsys: pytest.CaptureFixture[str]) -> None:
    path = mcap(tmp_path / "a.mcap", levels())
    text = f"{LOW}decl v /odom nav_msgs/Odometry.twist.twist.linear.x\nslow: never v > 2\n"
    assert main(["check", spec(text), "--recording", str(path)]) == 0
    assert "the recording has no topic `/odom`, so `slow` cannot start" in capsys.readouterr().err
    assert main(["check", spec(text), "--recording", str(path), "--strict"]) == 1
    assert main(["check", spec(text), "--recording", str(tmp_path / "none.mcap"), "--msg-path", str(path)]) == 2


@pytest.mark.parametrize("text", [LOW, "never robot.velocity > 2\n"])
@pytest.mark.parametrize(("name", "code"), [("none.mcap", "LTL901"), ("broken.mcap", "LTL811"), ("a.txt", "LTL807")])
def test_a_recording_that_check_cannot_read_is_reported(
    tmp_path: Path, spec: Spec, text: str, name: str, code: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "broken.mcap").write_bytes(b"no bag")
    (tmp_path / "a.txt").write_text("no bag")
    assert main(["check", spec(text), "--recording", str(tmp_path / name)]) == 2
    assert capsys.readouterr().err.count(code) == 1


def test_constants_that_a_recording_leaves_out_stay_known(tmp_path: Path, spec: Spec) -> None:
    log = "rcl_interfaces/msg/Log"
    text, _ = STORE.generate_msgdef(log, ros_version=2)
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        without = "\n".join(line for line in text.splitlines() if "=" not in line or line.startswith("=="))
        channel = writer.register_channel("/log", "cdr", writer.register_schema(log, "ros2msg", without.encode()))
        writer.add_message(channel, SECOND, Sent("/log", log, SECOND, made(log, level=40)).cdr, SECOND)
        writer.finish()
    assert main(["run", spec("decl level /log Log.level\nquiet: never level >= Log.ERROR\n"), str(path)]) == 1


@pytest.mark.parametrize("name", ["none.mcap", "broken.mcap", "drive.csv", "empty.mcap"])
def test_a_message_path_that_is_no_bag_with_definitions_is_reported(
    tmp_path: Path, spec: Spec, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "broken.mcap").write_bytes(b"no bag")
    (tmp_path / "drive.csv").write_text("time,x\n0,1\n")
    with (tmp_path / "empty.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        writer.finish()
    assert main(["check", spec("never robot.velocity > 2"), "--msg-path", str(tmp_path / name)]) == 2
    assert capsys.readouterr().err.count("LTL906") == 1


def test_a_recording_whose_types_contain_themselves_defines_none_of_them(tmp_path: Path) -> None:
    path = with_definition(
        tmp_path / "a.mcap",
        lambda text: (
            f"{text}\n{'=' * 80}\nMSG: a/B\nC c\n{'=' * 80}\nMSG: a/C\nB[] b\n{'=' * 80}\nMSG: a/D\nC c\n"
            f"{'=' * 80}\nMSG: a/E\nfloat64 x\n"
        ),
    )
    types, problems = message_types([str(path)])
    assert (problems, [name for name in types.messages if name.startswith("a/")]) == ([], ["a/msg/E"])


@pytest.mark.parametrize("store", [Stores.ROS2_JAZZY, Stores.ROS2_HUMBLE, Stores.ROS1_NOETIC])
def test_definitions_as_recordings_have_them_say_what_rosbags_says(store: Stores) -> None:
    known = get_typestore(store)
    form = 1 if store is Stores.ROS1_NOETIC else 2
    for name, definition in known.fielddefs.items():
        text, _ = known.generate_msgdef(name, ros_version=form)
        if not text.strip():
            continue  # what has no field is taken for what is not defined
        found = defined(name, f"ros{form}msg", text)
        assert found[name] == from_rosbags(definition), name


def test_constants_that_are_strings_keep_what_is_written() -> None:
    text = 'string A="x # y"\nstring B=un quoted  # kept in ROS 1\nuint8 C=0x1F # hex\nbool D=true\nfloat32 E=-1.5\n'
    message = defined("a/msg/B", "ros1msg", f"{text}uint8 F=many\nint8 x\n")["a/msg/B"]
    assert message.constants == {"A": "x # y", "B": "un quoted  # kept in ROS 1", "C": 31.0, "D": True, "E": -1.5}
    assert list(message.fields) == ["x"]


def test_an_empty_message_fits_its_definition(tmp_path: Path) -> None:
    """One byte, which middleware pads to four."""
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        channel = writer.register_channel("/e", "cdr", writer.register_schema("own/msg/E", "ros2msg", b"# nothing\n"))
        for n, data in enumerate((bytes(1), bytes(4))):
            writer.add_message(channel, SECOND + n, b"\0\1\0\0" + data, SECOND + n)
        writer.finish()
    text = "decl e /e own/E.structure_needs_at_least_one_member\nquiet: never new e and e > 0\n"
    compiled = known(text, path)
    assert run(*compiled, path).exit_code == 0
    assert open_recording(path, {}).columns == ()


Write = Callable[[Path, Sequence[Sent]], Path]


@pytest.mark.parametrize("write", [mcap, ros1])
def test_a_recording_that_cannot_be_read_is_told_once(
    tmp_path: Path, spec: Spec, write: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / ("a.mcap" if write is mcap else "a.bag"), levels())
    path.write_bytes(path.read_bytes()[:5])
    assert main(["run", spec("decl v /odom Odometry.twist.twist.linear.x\nnever v > 2\n"), str(path)]) == 2
    assert capsys.readouterr().err.count("LTL") == 1
