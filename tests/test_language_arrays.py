"""Arrays, their elements and sets, in the language: what they become, and what is said of what they cannot."""

from __future__ import annotations

import pytest
from language_support import SIGNALS, codes_of, findings, marked, only_property

from ltlc.specification.expressions import Comparison, Count, Each, Field, Relation, ValueType

ARRAYS = SIGNALS + (
    "decl scan /scan LaserScan.ranges\n"
    "decl joints /joints JointState.name\n"
    "decl buttons /panel Joy.buttons\n"
    "decl ids /nav/_action/status action_msgs/GoalStatusArray.status_list[].goal_info.stamp.sec\n"
    "decl states /nav/_action/status action_msgs/GoalStatusArray.status_list[].status\n"
    "decl state /goal action_msgs/GoalStatus.status\n"
)


def names(text: str) -> list[str]:
    """The names of the atoms of the one property."""
    return [atom.name for atom in only_property(ARRAYS.removeprefix(SIGNALS) + text).atoms]


def count_of(text: str) -> Count:
    """What the one atom of the one property counts."""
    (atom,) = only_property(ARRAYS.removeprefix(SIGNALS) + text).atoms
    assert isinstance(atom.condition, Comparison)
    assert isinstance(atom.condition.left, Count)
    return atom.condition.left


def help_of(text: str) -> tuple[str, str]:
    """The only finding: its message and its help."""
    (found,) = findings(ARRAYS + text)
    return found.message, found.help


@pytest.mark.parametrize(
    ("path", "type_", "expected"),
    [
        ("DiagnosticArray.status[].name", ValueType.STRINGS, ("status", Each(), "name")),
        ("DiagnosticArray.status[].level", ValueType.NUMBERS, ("status", Each(), "level")),
        ("DiagnosticArray.status[2].values[].key", ValueType.STRINGS, ("status", 2, "values", Each(), "key")),
        ("PoseArray.poses[].position.x", ValueType.NUMBERS, ("poses", Each(), "position", "x")),
        ("JointState.name", ValueType.STRINGS, ("name",)),
        ("LaserScan.ranges[]", ValueType.NUMBERS, ("ranges",)),
    ],
)
def test_a_path_through_an_array_of_messages_is_an_array(
    path: str, type_: ValueType, expected: tuple[object, ...]
) -> None:
    (wanted,) = only_property(f"decl a /a {path}\nnever len(a) > 3").inputs()
    assert wanted.signal.type is type_
    assert isinstance(wanted.signal.definition, Field)
    assert wanted.signal.definition.path == expected


@pytest.mark.parametrize(
    ("path", "code"),
    [
        ("DiagnosticArray.status[].values[].key", "LTL204"),
        ("DiagnosticArray.status[].values", "LTL204"),
        ("DiagnosticArray.status", "LTL204"),
        ("PoseArray.poses[].position", "LTL204"),
        ("PoseArray.poses.position.x", "LTL203"),
        ("LaserScan.ranges[2:3]", "LTL212"),
        ("Odometry[].pose", "LTL212"),
    ],
)
def test_a_path_to_arrays_in_arrays_or_to_no_value_is_an_error(path: str, code: str) -> None:
    assert codes_of(f"decl a /a {path}\nnever len(a) > 3") == [code]


def test_an_element_of_the_fields_of_messages_is_that_field_of_one_of_them() -> None:
    (wanted,) = only_property(ARRAYS.removeprefix(SIGNALS) + "never states[1] == 4").inputs()
    assert wanted.signal.name == "states[1]"
    assert isinstance(wanted.signal.definition, Field)
    assert wanted.signal.definition.path == ("status_list", 1, "status")


@pytest.mark.parametrize(
    ("said", "name"),
    [
        ("any(scan < 0.3)", "any(scan < 0.3)"),
        ("any(not scan >= 0.3)", "any(scan < 0.3)"),
        ("all(scan > 0.3 implies scan > 0.5)", "all(scan <= 0.3 or scan > 0.5)"),
        ("count (scan[80:100] < w) >= 5", "count(scan[80:100] < w) >= 5"),
        ("min(scan[-10:]) > 1", "min(scan[-10:]) > 1"),
        ("max(scan[:]) > 1", "max(scan[:]) > 1"),
        ("sum(scan) / len(scan) > 2", "sum(scan) / len(scan) > 2"),
        ("any(abs(scan - @{scan, -1}) > 0.5)", "any(abs(scan - @{scan, -1}) > 0.5)"),
        ("any(scan < min(scan) + v)", "any(scan < min(scan) + v)"),
        ('any(joints in {"a", "b"})', 'any(joints == "a" or joints == "b")'),
        ("any(ids == 3 and flag)", "any(ids == 3 and flag)"),
        ("any(scan <{0.5} 2)", "any(scan < 1.5)"),
        ("not any(scan <{0.5} 2)", "any(scan < 2.5)"),
        ("not all(scan <{0.5} 2)", "all(scan < 2.5)"),
    ],
)
def test_what_is_said_of_elements_has_one_name_however_it_is_written(said: str, name: str) -> None:
    assert names(f"never {said}") == [name]


def test_all_is_the_negation_of_any_of_the_opposite() -> None:
    assert count_of("never all(scan >= 0.3)") == count_of("never any(scan < 0.3)")
    (atom,) = only_property(ARRAYS.removeprefix(SIGNALS) + "never all(scan >= 0.3)").atoms
    assert isinstance(atom.condition, Comparison)
    assert atom.condition.relation is Relation.LESS


def test_names_of_arrays_and_of_parts_of_them_are_put_in() -> None:
    assert names("front = scan[80:100]\nfew = count(front < 0.3) < 3\nalways few") == ["count(scan[80:100] < 0.3) < 3"]


@pytest.mark.parametrize("name", ["any", "all", "count", "sum", "median", "len"])
def test_functions_of_arrays_are_names_where_nothing_is_called(name: str) -> None:
    assert codes_of(f"decl {name} /x Float64.data\nnever {name} > 3") == []


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("never any(v < 3)", "v < 3"),
        ("never any(scan < 3 and ids == 3)", "scan < 3 and ids == 3"),
        ("never any(scan < 3 and count(scan < 2) > 3)", "any(scan < 3 and count(scan < 2) > 3)"),
        ("never any(once scan < 3)", "any(once scan < 3)"),
        ("never any(scan < 3 and new v)", "any(scan < 3 and new v)"),
        ("never count(scan > 1 since scan < 3) > 2", "count(scan > 1 since scan < 3)"),
    ],
)
def test_what_is_no_condition_of_elements_that_belong_together_is_an_error(text: str, place: str) -> None:
    (found,) = findings(ARRAYS + text)
    assert found.code == "LTL230"
    assert marked(found) == place


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("never any(always scan < 3)", "LTL206"),
        ("never any(scan < 3) > 3", "LTL206"),
        ("never count(scan < 3)", "LTL206"),
        ("never count(scan <{0.1} 3) > 2", "LTL304"),
        ("never sum(joints) > 2", "LTL207"),
        ("never sum(v) > 2", "LTL207"),
        ("never len(v, w) > 2", "LTL207"),
        ("never abs(scan) > 2", "LTL207"),
        ("never min(joints) > 2", "LTL207"),
        ("never scan[-1] > 2", "LTL212"),
        ("never scan[1:3][0] > 2", "LTL212"),
        ("never scan[1.5:] == 2", "LTL212"),
        ("never v[1:2] > 2", "LTL212"),
        ("never scan[1 2] > 2", "LTL001"),
        ("never any(joints < 2)", "LTL205"),
        ("never scan * 2 > 1", "LTL205"),
        ("never mode in {}", "LTL006"),
        ("never v in {1, mode}", "LTL205"),
        ("never scan in {1}", "LTL205"),
        ("never v in {1 2}", "LTL005"),
        ("never v in 3", "LTL001"),
    ],
)
def test_what_cannot_be_said_of_arrays_and_sets_is_an_error(text: str, code: str) -> None:
    assert codes_of(ARRAYS + text) == [code]


def test_not_in_is_told_where_not_stands() -> None:
    found = next(d for d in findings(ARRAYS + "never flag not in {true}") if d.code == "LTL001")
    assert found.message == "`not` comes before the value, not before `in`"
    assert found.help == "write `not x in {1, 2}`"


@pytest.mark.parametrize(
    ("said", "help"),
    [
        (
            "scan < 0.3",
            "say which elements: `any(scan < 0.3)` or `all(scan < 0.3)`; the first is `min(scan) < 0.3`",
        ),
        (
            "scan >= v + 1",
            "say which elements: `any(scan >= v + 1)` or `all(scan >= v + 1)`; the first is `max(scan) >= v + 1`",
        ),
        ("0.3 > scan", "say which elements: `any(0.3 > scan)` or `all(0.3 > scan)`"),
        ("scan == 0.3", "say which elements: `any(scan == 0.3)` or `all(scan == 0.3)`"),
        ('joints != "arm"', 'say which elements: `any(joints != "arm")` or `all(joints != "arm")`'),
    ],
)
def test_an_array_that_is_compared_gets_the_ways_to_say_it(said: str, help: str) -> None:
    assert help_of(f"never {said}")[1] == help


@pytest.mark.parametrize(
    ("said", "help"),
    [
        ("mode == IDLE", 'a string is written `"IDLE"`'),
        ("IDLE != mode", 'a string is written `"IDLE"`'),
        ('mode in {"AUTO", IDLE}', 'a string is written `"IDLE"`'),
        ("any(joints == ARM)", 'a string is written `"ARM"`'),
        ("state == STATUS_ABORTED", "write `action_msgs/msg/GoalStatus.STATUS_ABORTED` for the constant"),
        ("state in {ABORTED}", "write `action_msgs/msg/GoalStatus.STATUS_ABORTED` for the constant"),
        ("any(states == ABORTED)", "write `action_msgs/msg/GoalStatus.STATUS_ABORTED` for the constant"),
        ("state == NOTHING", "`decl NOTHING TOPIC TYPE.FIELD` declares a signal of that name"),
    ],
)
def test_a_word_that_is_nothing_is_taken_for_a_value_of_what_it_is_compared_with(said: str, help: str) -> None:
    message, given = help_of(f"never {said}")
    assert message.startswith("nothing called `")
    assert given == help


def test_membership_is_equality_with_one_of_the_items_by_the_margin_of_the_file() -> None:
    assert names("never v in {1, w, 2 + 3}") == ["v == 1", "v == w", "v == 5"]
    assert names("_margin_ = 0.5\nnever v in {1, 2}") == ["v =={0.5} 1", "v =={0.5} 2"]
    assert names('never mode in {"a", "b"}') == ['mode == "a"', 'mode == "b"']
    assert names("never flag in {false}") == ["flag"]
    assert names("never not v in {1} and w in {2}") == ["v == 1", "w == 2"]
