"""Guards in a specification: what they are read as, what their words are elsewhere, what fallbacks do to conditions."""

from __future__ import annotations

from pathlib import Path

import pytest

from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.frontend.language import load_text
from ltlc.frontend.syntax.parse import parse
from ltlc.specification.evaluation import truth
from ltlc.specification.expressions import Boolean, Current, Number, String
from ltlc.specification.fallbacks import condition_after
from ltlc.specification.specification import Specification
from ltlc.specification.text import text

SPEED = "decl speed /cmd_vel Twist.linear.x\n"
SCAN = "decl scan /scan LaserScan.ranges\n"
GUARD = "guard /cmd_vel_raw to /cmd_vel else stop\nmessage stop {}\n"


def read(written: str) -> Specification:
    specification, diagnostics = load_text(Source("props.txt", written))
    assert specification is not None, diagnostics
    return specification


def found(written: str) -> list[tuple[str, str]]:
    """The codes of what is found in a text, with the texts of their places."""
    _, diagnostics = load_text(Source("props.txt", written))
    places = [(d.code, d.primary.span) for d in diagnostics if d.primary is not None]
    return [(code, written[span.start : span.end]) for code, span in places]


def test_a_guard_has_the_type_of_what_is_declared_on_what_it_sends_and_its_fallbacks_in_order() -> None:
    specification = read(
        "guard cmd_vel_raw to /cmd_vel else crawl, stop\nmessage stop {}\n"
        f"message crawl {{linear.x: 0.1, angular.z: -1}}\n_lead_ = 20 ms\n{SPEED}never speed > 1"
    )
    (guard,) = specification.guards
    assert (guard.raw, guard.out, guard.message) == ("/cmd_vel_raw", "/cmd_vel", "geometry_msgs/msg/Twist")
    assert [each.name for each in guard.fallbacks] == ["crawl", "stop"]
    assert guard.fallbacks[0].values == {("linear", "x"): Number(0.1), ("angular", "z"): Number(-1.0)}
    assert specification.lead == 20_000_000


def test_the_values_of_a_message_are_of_the_types_of_its_fields() -> None:
    specification = read(
        "half = 0.5\nguard /raw to /b else m\ndecl b /b BatteryState.percentage\nnever b > 2\n"
        'message m {voltage: 1 / 3, present: true, location: "left", percentage: half,'
        " power_supply_status: BatteryState.POWER_SUPPLY_STATUS_FULL}"
    )
    values = specification.guards[0].fallbacks[0].values
    assert values["voltage",] == Number(0.3333333432674408)  # in binary32
    assert (values["present",], values["location",]) == (Boolean(True), String("left"))
    assert (values["power_supply_status",], values["percentage",]) == (Number(4.0), Number(0.5))


def test_a_guard_keeps_the_properties_that_read_what_it_sends_and_are_not_assumed() -> None:
    specification = read(
        f"{GUARD}{SPEED}{SCAN}a: never speed > 1\nb: never min(scan) > 1\n"
        "assume c: never speed > min(scan)\nd: always new speed"
    )
    assert [each.label for each in specification.kept_by(specification.guards[0])] == ["a", "d"]
    assert [each.label for each in specification.properties if each.is_assumed] == ["c"]


def test_an_assumption_may_state_a_requirement() -> None:
    (assumed, _) = read(f'{GUARD}{SPEED}[id "A-1"]\nassume never speed > 9\nnever speed > 1').properties
    assert assumed.requirement is not None
    assert (assumed.requirement.id, assumed.is_assumed, assumed.text) == ("A-1", True, "never speed > 9")


def test_a_name_declared_on_what_a_guard_takes_in_counts_as_used_if_its_field_is_read_of_what_it_sends() -> None:
    raw = "decl raw /cmd_vel_raw Twist.linear.x\n"
    assert found(f"{GUARD}{SPEED}{raw}never speed > 1") == []
    assert found(f"{GUARD}{SPEED}{raw.replace('.x', '.y')}never speed > 1") == [("LTL104", "raw")]


@pytest.mark.parametrize(
    ("written", "code", "place"),
    [
        (f"{GUARD}{SPEED}assume never speed > 1", "LTL115", GUARD.partition("\n")[0]),
        (
            f"{GUARD}{SPEED}assume each new speed: never speed > 1\nnever speed > 2",
            "LTL114",
            "assume each new speed: never speed > 1",
        ),
        (f"{SPEED}_lead_ = 5 ms\nnever speed > 1", "LTL104", "_lead_"),
        (
            f"{SPEED}{SPEED.replace('speed', 'd')}never d > 1 and speed > 1\nguard /a to /cmd_vell",
            "LTL114",
            "/cmd_vell",
        ),
        (f"{GUARD.replace('{}', '{linear.x = 0}')}{SPEED}never speed > 1", "LTL001", "="),
        (f"{GUARD.replace('{}', '')}{SPEED}never speed > 1", "LTL101", "message"),
        (f"{SPEED}never speed > 1\nguard /cmd_vel", "LTL101", "guard"),
        (f"{GUARD.replace('{}', '{header.frame_id[0]: 1}')}{SPEED}never speed > 1", "LTL203", "header"),
        (f"{GUARD.replace('{}', '{linear.x[0]: 1}')}{SPEED}never speed > 1", "LTL241", "0"),
    ],
)
def test_what_does_not_fit_is_reported_where_it_stands(written: str, code: str, place: str) -> None:
    assert (code, place) in found(written)


@pytest.mark.parametrize(
    "line",
    [
        "guard > to",
        "never guard - 1 > 2",
        "assume and true",
        "assume: never to > 1",
        "message: never message > 1",
        "guard: assume",
    ],
)
def test_the_words_are_names_where_their_form_does_not_need_them(line: str) -> None:
    names = "".join(f"decl {name} /{name} Float64.data\n" for name in ("guard", "to", "message"))
    _, diagnostics = parse(Source("props.txt", f"{names}decl assume /assume Bool.data\nalways guard > 1\n{line}\n"))
    assert diagnostics == []


@pytest.mark.parametrize(
    ("predicate", "after"),
    [
        ("speed <= 0.2", True),
        ("speed > 0.2", False),
        ("speed <= min(scan) / 2", "0.1 <= min(scan) / 2"),
        ("abs(speed - @{speed, -1}) <= 0.25", "abs(0.1 - speed) <= 0.25"),
        ("speed > @{speed, -3}", "0.1 > @{speed, -2}"),
        ("min(scan) < 0.5", "min(scan) < 0.5"),
        ("turn == 0", True),
        ("turn / speed > 1", False),
        ("speed / turn > 1", True),
        ("turn / turn > 1", None),
        ("max(@{speed, -2:}) > 1", None),
        ("max(@{min(scan), -2:}) > 1", "max(@{min(scan), -2:}) > 1"),
    ],
)
def test_after_a_fallback_a_condition_speaks_of_what_was_held(predicate: str, after: str | bool | None) -> None:
    specification = read(
        f"guard /cmd_vel_raw to /cmd_vel else m\nmessage m {{linear.x: 0.1}}\n{SPEED}{SCAN}"
        f"decl turn /cmd_vel Twist.angular.z\nkept: never turn > 9 and speed > 9\nnever {predicate}"
    )
    (atom,) = specification.properties[1].atoms
    (fallback,) = specification.guards[0].fallbacks
    condition = condition_after(atom.condition, "/cmd_vel", fallback)
    if isinstance(after, str):
        (other,) = read(f"{SPEED}{SCAN}never {after}").properties[0].atoms
        assert condition == other.condition
    else:
        assert condition is after


def test_a_condition_after_a_fallback_is_what_it_is_once_that_has_been_sent() -> None:
    """With the values that are held before, it holds where the condition itself does with those after."""
    specification = read(
        f"guard /r to /cmd_vel else m\nmessage m {{linear.x: 2}}\n{SPEED}decl x /x Float64.data\n"
        "never speed * x + @{speed, -1} > x - @{x, -1}"
    )
    (atom,) = specification.properties[0].atoms
    (fallback,) = specification.guards[0].fallbacks
    condition = condition_after(atom.condition, "/cmd_vel", fallback)
    assert condition is not None
    assert not isinstance(condition, bool)
    inputs = {text(part): part for part in specification.properties[0].inputs()}
    for speed in (-1.0, 0.5, 3.0):
        for x, before in ((1.0, 2.0), (-4.0, 0.0), (7.0, -1.0)):
            held = {inputs["x"]: x, inputs["@{x, -1}"]: before}
            now = {**held, Current(inputs["speed"].signal): speed}
            then = {**held, inputs["speed"]: 2.0, inputs["@{speed, -1}"]: speed}
            assert truth(condition, now) == truth(atom.condition, then)


def test_a_file_with_a_guard_is_not_built_for_a_target_without_and_nothing_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.txt").write_text(f"{GUARD}{SPEED}never speed > 1", encoding="utf-8")
    assert main(["build", "p.txt", "-t", "python"]) == 2
    assert "the target `python` has no guards" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["p.txt"]


def test_explain_begins_with_what_a_guard_does(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "p.txt"
    path.write_text(f"{GUARD}{SPEED}{SCAN}assume a: never min(scan) < 0\np: never speed > min(scan)", encoding="utf-8")
    assert main(["explain", str(path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[:2] == ["guard of /cmd_vel", "  guard /cmd_vel_raw to /cmd_vel else stop"]
    assert "  keeps    p" in lines
    assert "  assumes  a" in lines
    assert "  sends    stop: all fields zero, false or empty" in lines
    assert "  begins   once a message has come on /scan; until then nothing leaves it" in lines
    assert "  assume never min(scan) < 0" in lines
