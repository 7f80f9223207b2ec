"""Rule packs: each rule is silent on its passing example and finds its violating one, at the time that this says."""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from bag_support import Sent, filled, mcap
from ulog_support import PRIMITIVES, LogWriter

from ltlc import rules
from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.frontend.language import load_text, types_for
from ltlc.frontend.layout import layout
from ltlc.inputs.messages.definitions import read_by_packs

FIXTURES = Path(__file__).parent / "fixtures" / "rules"
FLIGHTS = Path(__file__).parents[2] / "shared" / "data" / "ulog"
NAMES = [f"{pack}/{rule.name}" for pack in rules.packs() for rule in rules.pack(pack).rules]
Rows = Sequence[tuple[float, float, float, str, dict[str, Any]]]


def example(name: str) -> dict[str, Any]:
    """The examples of a rule: rows from a time to another, every so many seconds, on a topic, with values."""
    found: dict[str, Any] = json.loads((FIXTURES / f"{name}.json").read_text())
    return found


def recording(folder: Path, pack: str, rows: Rows) -> Path:
    """A flight log, or a bag, with these messages; fields without a value are zero, numbers that are null NaN."""
    lines = (FIXTURES / pack / "formats").read_text().splitlines()
    formats = {topic: text for topic, _, text in (line.partition(":" if pack == "px4" else " ") for line in lines)}
    found = [
        (round(begin * 1e6 + k * step * 1e6), topic, values)
        for begin, end, step, topic, values in rows
        for k in range(round((end - begin) / step) + 1)
    ]
    found.sort(key=lambda each: each[0])
    if pack == "px4":
        return _log(folder / "run.ulg", formats, found)
    sent = [Sent(topic, formats[topic], time * 1000, filled(formats[topic], values)) for time, topic, values in found]
    return mcap(folder / "run.mcap", sent)


def _log(path: Path, formats: dict[str, str], found: Sequence[tuple[int, str, dict[str, Any]]]) -> Path:
    writer = LogWriter()
    for topic, text in formats.items():
        writer.format(topic, text)
    topics = list(formats)
    for number, topic in enumerate(topics):
        writer.subscribe(topic, number)
    for time, topic, values in found:
        packed = b"".join(_packed(part, {"timestamp": time, **values}) for part in formats[topic].split(";") if part)
        writer.message(topics.index(topic), packed)
    return writer.save(path)


def _packed(part: str, values: dict[str, Any]) -> bytes:
    kind, _, name = part.partition(" ")
    base, _, count = kind.partition("[")
    numbers = values.get(name, [0] * int(count[:-1]) if count else 0)
    each = [float("nan") if value is None else value for value in (numbers if count else [numbers])]
    return struct.pack(f"<{len(each)}{PRIMITIVES[base]}", *each)


@pytest.mark.parametrize("name", NAMES)
def test_a_rule_passes_what_it_should_and_finds_what_it_should(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    pack, of = name.partition("/")[0], example(name)
    passing = recording(tmp_path, pack, of["passes"])
    assert main(["run", f"@{name}", str(passing)]) == 0, capsys.readouterr()
    violating = recording(tmp_path, pack, of["violates"])
    capsys.readouterr()
    assert main(["run", f"@{name}", str(violating), "--format", "json"]) == 1
    document = json.loads(capsys.readouterr().out)
    first = [each["decided_at"]["time"] for each in document["properties"] if each["verdict"] == "violated"]
    assert of["at"] in first


@pytest.mark.parametrize("name", NAMES)
def test_a_rule_says_in_english_what_it_is_and_where_it_is_from(name: str) -> None:
    [rule] = rules.pack(name).rules
    assert rule.properties.startswith("## ")
    assert rule.properties.count("[id ") == rule.properties.count("##")
    assert rule.properties.count('rationale "') == rule.properties.count("##")
    assert layout(Source(name, rule.text)) == rule.text


@pytest.mark.parametrize("name", rules.packs())
def test_what_several_rules_define_is_the_same_and_every_rule_has_its_place_in_the_docs(name: str) -> None:
    pack = rules.pack(name)
    defined = [line for line in pack.text().splitlines() if line.startswith("decl ") or " = " in line.partition("#")[0]]
    names = [line.split()[1] if line.startswith("decl ") else line.split()[0] for line in defined]
    assert len(names) == len(set(names))
    page = (Path(__file__).parents[1] / "docs" / "rules.md").read_text()
    for rule in pack.rules:
        english = next(line for line in rule.properties.splitlines() if line.startswith("##"))[3:]
        assert f"| `{name}/{rule.name}` | {english}" in page


@pytest.mark.parametrize("name", rules.packs())
def test_a_pack_is_understood_without_a_recording_and_without_definitions_of_messages(name: str) -> None:
    specification, diagnostics = load_text(Source(f"@{name}", rules.pack(name).text()))
    assert specification is not None, diagnostics
    assert len(specification.properties) >= len(rules.pack(name).rules)


def test_what_is_known_for_the_packs_is_what_they_read_and_is_not_taken_for_the_whole_message() -> None:
    texts = [rules.pack(name).text() for name in rules.packs()]
    read = {part for text in texts for part in re.findall(r"\w+", text)}
    assert all(read >= message.fields.keys() - {"header"} for message in read_by_packs().values())
    specification, diagnostics = load_text(Source("p", "decl s /s px4_msgs/VehicleStatus.nav_state\nnever s > 1"))
    assert specification is None
    assert "only the fields that rule packs read are known of it" in str(diagnostics[0].help)


def test_what_is_known_for_the_packs_does_not_replace_the_definitions_of_a_recording(tmp_path: Path) -> None:
    rows: Rows = [(0, 3, 0.5, "vehicle_status", {"arming_state": 2})]
    types, _ = types_for(Source("@px4", rules.pack("px4").text()), (), [recording(tmp_path, "px4", rows)])
    assert "px4_msgs/msg/VehicleStatus" in types.messages
    assert not any(message.is_partial for message in types.messages.values())


def test_a_rule_about_what_is_not_in_the_log_is_reported_as_not_checked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows: Rows = [(0, 3, 0.5, "vehicle_status", {"arming_state": 2}), (0, 3, 0.5, "cpuload", {"load": 0.2})]
    flight = recording(tmp_path, "px4", rows)
    assert main(["run", "@px4", str(flight)]) == 0
    printed = capsys.readouterr()
    assert "px4_cpu: presumably satisfied" in printed.out
    assert "px4_gps_silent" not in printed.out
    assert "rules that were not checked: `battery_cell`, no message on `/fmu/out/battery_status`; " in printed.err
    assert main(["run", "@px4/gps_silent", str(flight)]) == 2
    assert "none of the rules `@px4/gps_silent` is about this" in capsys.readouterr().err


def test_the_rules_of_a_pack_are_written_to_be_changed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    flight = recording(tmp_path, "px4", example("px4/battery_cell")["violates"])
    props = tmp_path / "props.ltlc"
    assert main(["new", "--pack", "px4", str(flight), "-o", str(props)]) == 0
    text = props.read_text()
    assert main(["run", str(props), str(flight)]) == 1
    assert "px4_cell_voltage_least = 3.3" in text
    assert "px4_gps" not in text
    props.write_text(text.replace("px4_cell_voltage_least = 3.3", "px4_cell_voltage_least = 3.1"))
    assert main(["run", str(props), str(flight)]) == 0
    capsys.readouterr()


def test_an_unknown_pack_or_rule_is_answered_with_those_that_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "@px5"]) == 2
    assert "the packs are `autoware`, `diagnostics`, " in capsys.readouterr().err
    assert main(["check", "@px4/gps_acuracy"]) == 2
    assert "did you mean `gps_accuracy`?" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["px4", "px4/gps_accuracy"])
def test_a_pack_without_its_sign_is_answered_with_how_it_is_written(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["check", name]) == 2
    assert f"there is no file {name}" in (shown := capsys.readouterr().err)
    assert f"write `@{name}` for the rule pack" in shown


@pytest.mark.skipif(not FLIGHTS.is_dir(), reason="there are no flight logs of others here")
def test_on_flights_of_others_the_rules_name_the_failure_and_its_time_or_are_silent(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["run", "@px4", str(FLIGHTS / "sample.ulg")]) == 0
    capsys.readouterr()
    assert main(["run", "@px4", str(FLIGHTS / "gps_interference.ulg"), "--format", "json"]) == 1
    document = json.loads(capsys.readouterr().out)
    found = {each["label"]: each for each in document["properties"] if each["verdict"] == "violated"}
    assert found.keys() == {"px4_gps_accuracy", "px4_gps_satellites"}
    assert {each["decided_at"]["time"] for each in found.values()} == {276.594637}
