"""`forall`: properties of several names, written out; against the same file written out by hand."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from hypothesis import assume, given
from language_support import compiled, findings, marked
from strategies import properties

from ltlc import cli
from ltlc.analysis.wording import written
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.semantics.properties import Property
from ltlc.specification.specification import Specification

BATTERIES = "".join(f"decl robot{k}_battery /robot{k}/battery BatteryState.percentage\n" for k in (1, 2, 3))

FORALL = (
    BATTERIES
    + """slow: forall r in {robot1, robot2, robot3}: never r.velocity > 2 and {r}_battery < 0.2
apart: forall a, b in {robot1, robot2}: always a.distance.b > 1
stop: forall r in {robot1, robot2}: forall s in {sign1, sign2}:
    after_until r.distance.s < 1, r.distance.s > 3, eventually r.velocity < 0.01
"""
)

BY_HAND = (
    BATTERIES
    + "".join(f"s{k}: never robot{k}.velocity > 2 and robot{k}_battery < 0.2\n" for k in (1, 2, 3))
    + """a12: always robot1.distance.robot2 > 1
a21: always robot2.distance.robot1 > 1
"""
    + "".join(
        f"t{r}{s}: after_until robot{r}.distance.sign{s} < 1, robot{r}.distance.sign{s} > 3, "
        f"eventually robot{r}.velocity < 0.01\n"
        for r in (1, 2)
        for s in (1, 2)
    )
)


def said(specification: Specification) -> list[object]:
    """All that the properties of a file say, without labels and places."""
    return [
        (p.text, p.property, [(a.name, a.condition) for a in p.atoms], p.alphabet) for p in specification.properties
    ]


def test_a_forall_says_what_its_copies_say_written_out() -> None:
    assert said(compiled(FORALL)) == said(compiled(BY_HAND))


OF_A_ROBOT = ("r.velocity > 1", "{r}_ok", "sign.distance.r < 2", "r.position.x > near_{r}", "r.distance.{r}_dock > 1")
KNOWN = "".join(f"decl {r}_ok /{r}/ok Bool.data decl near_{r} /{r}/near Float64.data\n" for r in ("robot1", "robot2"))


@given(properties(OF_A_ROBOT))
def test_any_property_is_written_out_as_text_would_be(property_: Property) -> None:
    text, variable = written(property_), re.compile(r"\{r\}|\br\b")
    assume(variable.search(text))
    by_hand = "".join(f"{robot}: {variable.sub(robot, text)}\n" for robot in ("robot1", "robot2"))
    expected, problems = load_text(Source("by_hand", KNOWN + by_hand))
    assume(expected is not None)
    found, same_problems = load_text(Source("forall", f"{KNOWN}forall r in {{robot1, robot2}}: {text}"))
    assert found is not None
    assert expected is not None
    assert said(found) == said(expected)
    assert {d.code for d in same_problems} == {d.code for d in problems}


def test_copies_are_labelled_with_their_names_in_the_order_of_the_set() -> None:
    assert [p.label for p in compiled(FORALL).properties] == [
        *("slow[robot1]", "slow[robot2]", "slow[robot3]"),
        *("apart[robot1, robot2]", "apart[robot2, robot1]"),
        *("stop[robot1, sign1]", "stop[robot1, sign2]", "stop[robot2, sign1]", "stop[robot2, sign2]"),
    ]


def test_copies_without_a_label_are_named_after_their_line() -> None:
    found = compiled("\nforall r in {a, b}: never r.velocity > 2\nnever a.velocity > 3").properties
    assert [(p.label, p.line) for p in found] == [("line 2[a]", 2), ("line 2[b]", 2), ("line 3", 3)]


def test_the_parts_of_a_copy_have_their_places_where_the_author_wrote_them() -> None:
    text = "forall r in {a, b}: eventually r.velocity > 2"
    for copy in compiled(text).properties:
        parts = [text[span.start : span.end] for span in copy.spans.values()]
        assert parts == ["eventually r.velocity > 2", "r.velocity > 2"]
        assert text[copy.span.start : copy.span.end] == text


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("forall x in {a, b}: never x.position.x > 1", "never a.position.x > 1"),
        ("forall r in {a, b}: never s.distance.r > 1", "never s.distance.a > 1"),
        ("forall velocity in {a, b}: never velocity.velocity > 1", "never a.velocity > 1"),
        ("decl a /a LaserScan.ranges decl b /b LaserScan.ranges forall r in {a, b}: never r[0] > 1", "never a[0] > 1"),
        ("decl t_a_u /a Bool.data decl t_b_u /b Bool.data forall r in {a, b}: never t_{r}_u", "never t_a_u"),
        ("decl a_b /a Bool.data decl b_a /b Bool.data forall r, s in {a, b}: never {r}_{s}", "never a_b"),
        ("near = a.velocity < 1 far = b.velocity < 1 forall p in {near, far}: eventually p", "eventually near"),
        ("decl a /a Float64.data decl b /b Float64.data forall m in {a, b}: never m =={0.1}2", "never a =={0.1}2"),
        ("forall r in {a, b}: # r, not r\n never r.velocity > 1", "never a.velocity > 1"),
    ],
)
def test_a_variable_stands_for_the_name_of_a_thing_and_for_parts_of_names(text: str, expected: str) -> None:
    assert compiled(text).properties[0].text == expected


def test_braces_after_a_relation_hold_a_margin() -> None:
    (found,) = compiled("decl v /v Float64.data m = 0.5 w = 2 never v =={m}w").properties
    assert [atom.name for atom in found.atoms] == ["v =={0.5} 2"]


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("forall r in {}: never r.velocity > 2", "LTL018", "}"),
        ('forall r in {"a", b}: never r.velocity > 2', "LTL018", '"a"'),
        ("forall r in {1, 2}: never r.velocity > 2", "LTL018", "1"),
        ("forall r in {a,}: never r.velocity > 2", "LTL018", "}"),
        ("forall r in {a b}: never r.velocity > 2", "LTL002", "b"),
        ("forall r in {a, b: never r.velocity > 2", "LTL005", ":"),
        ("forall r in a, b: never r.velocity > 2", "LTL018", "a"),
        ("forall r: never r.velocity > 2", "LTL018", ":"),
        ("forall r in", "LTL018", "n"),
        ("slow forall r in {a}: never r.velocity > 2", "LTL101", "slow"),
        ("forall r in {a, b} never r.velocity > 2", "LTL018", "never"),
        ("forall r in {a}: safe: never r.velocity > 2", "LTL018", ":"),
        ("always forall r in {a, b}: r.velocity > 2", "LTL018", "forall"),
        ("forall r in {a, b}: never {r}.velocity > 2", "LTL018", "{"),
        ("forall a, b in {c}: never a.distance.b > 2", "LTL109", "c"),
        ("forall r in {a, a}: never r.velocity > 2", "LTL109", "a"),
        ("forall r in {a, r}: never r.velocity > 2", "LTL109", "r"),
        ("forall r, r in {a, b}: never r.velocity > 2", "LTL109", "r"),
        ("forall r in {a, b}: forall r in {c, d}: never r.velocity > 2", "LTL109", "r"),
        ("object r at (0, 0, 0) forall r in {a, b}: never r.velocity > 2", "LTL109", "r"),
        ("forall r in {a, b}: never a.velocity > 2", "LTL109", "r"),
        ("never {r}_battery > 2", "LTL109", "{r}_battery"),
        ("forall r in {a}: never {q}_battery > r.velocity", "LTL109", "{q}_battery"),
        ("forall r in {a}: never r.distance.{q}_dock > 1", "LTL109", "{q}_dock"),
        ("decl a_x /a Bool.data forall r in {a, b}: never {r}_x", "LTL101", "{r}_x"),
        ("forall r in {a, b}: never r.velocty > 2", "LTL105", "velocty"),
    ],
)
def test_a_mistake_has_its_code_and_place_and_is_told_once(text: str, code: str, place: str) -> None:
    (found,) = findings(text)
    assert (found.code, marked(found)) == (code, place)


def test_a_mistake_in_one_copy_says_in_which() -> None:
    (found,) = findings("decl a_x /a Bool.data forall r in {a, b}: never {r}_x")
    assert found.message == "nothing called `b_x` is defined (where `r` is `b`)"


def test_there_is_a_limit_to_what_a_forall_stands_for() -> None:
    names = ", ".join(f"robot{k}" for k in range(101))
    assert [f.code for f in findings(f"forall a, b in {{{names}}}: always a.distance.b > 1")] == ["LTL307"]
    assert len(compiled(f"forall a in {{{names}}}: never a.velocity > 1").properties) == 101


def output(folder: Path, text: str, *arguments: str) -> Path:
    """What `build` makes of a file with this text."""
    (folder / "props.txt").write_text(text)
    written = folder / "output"
    assert cli.main(["build", str(folder / "props.txt"), "-o", str(written), *arguments]) == 0
    return written


def documents(folder: Path, text: str) -> list[object]:
    """The monitors of a file as JSON, without labels and lines."""
    data = json.loads(output(folder, text, "--target", "json").read_text())
    return [{k: v for k, v in each.items() if k not in ("label", "line")} for each in data["properties"]]


def test_a_forall_is_built_as_what_is_written_out(tmp_path: Path) -> None:
    assert documents(tmp_path, FORALL) == documents(tmp_path, BY_HAND)


def test_ten_robots_in_ten_lines_build_check_and_run_as_those_written_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robots = [f"robot{k}" for k in range(10)]
    rule = "after_until {0}.distance.stop_sign < 1, {0}.distance.stop_sign > 3, eventually {0}.velocity < 0.01"
    short = f"stop: forall r in {{{', '.join(robots)}}}: {rule.format('r')}\n"
    long = "".join(f"p{k}: {rule.format(robot)}\n" for k, robot in enumerate(robots))
    steps = [(0.0, 4, 1), (0.5, 0.5, 1), (1.0, 0.5, 0), (1.5, 4, 1), (2.0, 0.5, 1), (2.5, 4, 1)]
    rows = [
        {"time": t} | {f"{r}.distance.stop_sign": d for r in robots} | {f"{r}.velocity": v for r in robots}
        for t, d, v in steps
    ]
    rows[1][f"{robots[3]}.distance.stop_sign"] = 2
    (tmp_path / "run.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    said = []
    for text in (short, long):
        (tmp_path / "props.txt").write_text(text)
        assert cli.main(["check", str(tmp_path / "props.txt")]) == 0
        assert cli.main(["run", str(tmp_path / "props.txt"), str(tmp_path / "run.jsonl"), "--format", "json"]) == 1
        captured = capsys.readouterr().out
        said.append(
            re.sub(r'"(p|stop\[robot)(\d)\]?"', r'"\2"', re.sub(r"\b(?:p|stop\[robot)(\d)\]?:", r"\1:", captured))
        )
    lines = [re.sub(r'"(line|sha256)": [^,\s]+', r'"\1": 0', text) for text in said]
    assert lines[0] == lines[1]
    assert '"violated"' in lines[0]


def test_the_names_of_emitted_classes_come_from_the_labels(tmp_path: Path) -> None:
    text = output(tmp_path, FORALL, "--target", "python").read_text()
    found = re.findall(r"^class (\w+):", text, re.MULTILINE)
    assert found[:4] == ["SlowRobot1", "SlowRobot2", "SlowRobot3", "ApartRobot1Robot2"]


def test_what_is_found_of_several_copies_is_told_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "props.txt"
    path.write_text("slow: forall r in {robot1, robot2, robot3}: always r.velocity >= 0\n")
    assert cli.main(["check", str(path), "--format", "concise"]) == 0
    told, _ = capsys.readouterr().err.splitlines()
    assert "LTL503" in told
    assert told.endswith("`robot1.velocity >= 0` always holds (the same for 2 other copies of `forall`)")
