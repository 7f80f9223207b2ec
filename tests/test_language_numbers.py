"""Numbers as they are on the wire: literals beside binary32, integers with their range, constants of messages."""

from __future__ import annotations

from pathlib import Path

import pytest
from language_support import codes_of, compiled, findings
from stepping import from_text

from ltlc.analysis.analyse import analyse
from ltlc.automata import Budget
from ltlc.monitoring.judging.run import run
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.evaluation import letter
from ltlc.specification.expressions import Comparison, Number
from ltlc.specification.specification import PropertySpecification

SINGLE = 0.30000001192092896
"""The binary32 nearest to 0.3."""

DECLARATIONS = """
decl s /s Float32.data
decl d /d Float64.data
decl scan /scan LaserScan.ranges
decl point /point Point32
decl byte /byte UInt8.data
decl small /small Int16.data
decl id /id UInt64.data
decl other /other Int64.data
decl ids /ids UInt64MultiArray.data
decl status /nav/_action/status action_msgs/GoalStatusArray.status_list[0].status
decl old /old actionlib_msgs/GoalStatus.status
"""


def only(text: str) -> PropertySpecification:
    (found,) = compiled(DECLARATIONS + text).properties
    return found


def constant(text: str) -> float:
    """What the one comparison of `never TEXT` compares with."""
    (atom,) = only(f"never {text}").atoms
    assert isinstance(atom.condition, Comparison)
    assert isinstance(atom.condition.right, Number)
    return atom.condition.right.value


def valuations(text: str) -> set[frozenset[str]]:
    return set(only(text).alphabet.letters())


@pytest.mark.parametrize(
    "compared",
    [
        "s <= 0.3",
        "0.3 >= s",
        "s == 0.3",
        "-s < 0.3",
        "abs(s) < 0.3",
        "@{s, -1} < 0.3",
        "scan[3] < 0.3",
        "min(scan) < 0.3",
        "max(scan) < 0.3",
        "min(s, 0.5) < 0.3",
        "min(s, scan[0]) < 0.3",
        "point.y < 0.3",
    ],
)
def test_a_literal_beside_binary32_is_the_nearest_of_them(compared: str) -> None:
    assert constant(compared) == SINGLE


def test_with_a_margin_a_literal_is_a_binary32_first_and_what_it_is_moved_to_a_double() -> None:
    assert constant("s >{0.1} 0.3") == SINGLE + 0.1
    assert constant("s =={0.1} 0.3") == SINGLE
    (atom,) = only("never 0.3 <{0.1} s").atoms
    assert isinstance(atom.condition, Comparison)
    assert atom.condition.left == Number(SINGLE, single=True)


@pytest.mark.parametrize("compared", ["s + 0 < 0.3", "s * 1 < 0.3", "sqrt(s) < 0.3", "max(s, d) < 0.3", "d < 0.3"])
def test_where_doubles_are_computed_a_literal_is_a_double(compared: str) -> None:
    assert constant(compared) == 0.3


def test_an_atom_is_named_as_it_was_written() -> None:
    assert [atom.name for atom in only("never s <= 0.3 or max(s, 0.1) > 16777217").atoms] == [
        "s <= 0.3",
        "max(s, 0.1) > 16777216",
    ]


def test_literals_that_are_the_same_binary32_make_the_same_atom() -> None:
    (atom,) = only("never s <= 0.3 or s <= 0.300000001 or s <= 0.30000001192092896").atoms
    assert atom.name == "s <= 0.3"


def test_between_two_neighbours_among_the_binary32_there_is_none() -> None:
    assert valuations("never s <= 0.3 or s >= 0.3000001") == {
        frozenset({"s <= 0.3"}),
        frozenset({"s >= 0.3000001"}),
        frozenset(),
    }
    assert valuations("never s <= 0.3 or s >= 0.30000004") == {frozenset({"s <= 0.3"}), frozenset({"s >= 0.30000004"})}


@pytest.mark.parametrize(
    "impossible",
    [
        "byte > 255",
        "byte < 0",
        "byte == 0.5",
        "byte == 256",
        "abs(small) > 32768",
        "-byte > 0",
        "-byte < -255",
        "min(byte, small) > 255",
        "max(byte, 7) < 7",
        "id < 0",
        "id > 18446744073709551615",
        "other < -9223372036854775808",
        "other == 0.5",
        "max(ids) > 18446744073709551615",
        "byte + small + 1 < -1e999",
    ],
)
def test_what_no_value_of_the_type_gives_never_holds(impossible: str) -> None:
    assert valuations(f"never {impossible}") <= {frozenset()} or "+" in impossible


@pytest.mark.parametrize(
    "possible",
    [
        "byte >= 255",
        "byte > 254.5",
        "abs(small) > 32767",
        "id > 18446744073709551614",
        "other <= -9223372036854775808",
        "max(ids) == 18446744073709551615",
        "s > 3.4028234e38",
    ],
)
def test_the_ends_of_a_type_are_reached(possible: str) -> None:
    (name,) = (atom.name for atom in only(f"never {possible}").atoms)
    assert valuations(f"never {possible}") == {frozenset(), frozenset({name})}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("always byte < 256", "`byte < 256` always holds: `byte` is a whole number from 0 to 255"),
        ("never other == 0.5", "`other == 0.5` never holds: `other` is a whole number from -9223372036854775808 to "),
    ],
)
def test_check_says_what_the_type_of_a_field_decides(text: str, said: str) -> None:
    specification = compiled(f"{DECLARATIONS} {text}")
    found = [d for d in analyse(specification, EPISODE, Budget(60.0, 1024)).diagnostics if d.code == "LTL503"]
    assert [label.text for d in found for label in d.secondary if label.text.startswith(said)]


def test_integers_have_the_letters_that_whole_numbers_give() -> None:
    assert valuations("never byte < 2 or byte > 2") == {
        frozenset({"byte < 2"}),
        frozenset({"byte > 2"}),
        frozenset(),
    }
    assert valuations("never byte < 2 or byte > 1") == {frozenset({"byte < 2"}), frozenset({"byte > 1"})}


def test_identifiers_beyond_the_doubles_compare_exactly() -> None:
    found = only("never id == 9007199254740993 or id == other or id + 1 == 9007199254740992 or id =={0.5} other")
    names = [atom.name for atom in found.atoms]
    one, other = found.inputs()

    def truths(value: int, second: int) -> list[bool]:
        seen = letter(found.atoms, {one: value, other: second})
        assert seen is not None
        assert found.alphabet.allows(seen)
        return [name in seen for name in names]

    assert truths(2**53 + 1, 2**53 + 1) == [True, True, True, True]
    assert truths(2**53, 2**53 + 1) == [False, False, True, True]
    assert truths(2**53 + 3, 2**53 + 4) == [False, False, False, True]


GOAL_STATUS = "action_msgs/msg/GoalStatus"


@pytest.mark.parametrize(
    ("compared", "value"),
    [
        ("status == GoalStatus.STATUS_ABORTED", 6),
        ("GoalStatus.STATUS_ABORTED == status", 6),
        ("old == GoalStatus.ABORTED", 4),
        ("@{old, -1} == GoalStatus.ABORTED", 4),
        ("status == action_msgs/GoalStatus.STATUS_SUCCEEDED", 4),
        ("status == action_msgs/msg/GoalStatus.STATUS_SUCCEEDED", 4),
        ("byte == lifecycle_msgs/State.PRIMARY_STATE_ACTIVE", 3),
        ("byte == State.PRIMARY_STATE_ACTIVE", 3),
        ("byte == ServiceEventInfo.RESPONSE_SENT", 2),
        ("byte == action_msgs/CancelGoal_Response.ERROR_REJECTED", 1),
    ],
)
def test_a_constant_is_that_of_the_message_of_the_compared_field(compared: str, value: int) -> None:
    assert constant(compared) == value


def test_a_constant_that_the_message_of_the_field_lacks_is_not_taken_from_another() -> None:
    (found,) = findings(DECLARATIONS + "never status == GoalStatus.ABORTED")
    assert found.code == "LTL214"
    assert f"`{GOAL_STATUS}` has no constant `ABORTED`" in found.message
    assert "STATUS_ABORTED" in found.help


@pytest.mark.parametrize(
    "use", ["never byte == GoalStatus.ABORTED", "aborted = GoalStatus.ABORTED never byte == aborted"]
)
def test_elsewhere_a_constant_of_several_messages_has_to_say_of_which(use: str) -> None:
    (found,) = findings(DECLARATIONS + use)
    assert found.code == "LTL202"
    assert "actionlib_msgs/GoalStatus.ABORTED" in found.help


def test_a_blank_around_the_slash_makes_a_division() -> None:
    assert codes_of(DECLARATIONS + "model R: LIMIT /limit Float64.data; never d / R.LIMIT > 2") == []
    assert codes_of(DECLARATIONS + "model R: LIMIT /limit Float64.data; never d/R.LIMIT > 2") == ["LTL201"]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("run.csv", "time,s\n0,0.3\n1,0.30000001192092896\n"),
        ("run.jsonl", '{"time": 0, "s": 0.3}\n{"time": 1, "s": 0.30000001192092896}\n'),
    ],
)
def test_a_cell_is_converted_as_the_type_of_its_field(tmp_path: Path, name: str, content: str) -> None:
    path = tmp_path / name
    path.write_text(content)
    report = run(*from_text("decl s /s Float32.data\nalways s <= 0.3\nalways s >= 0.3\nnever s == 0.3"), path)
    assert report.session is not None
    assert [track.verdict for track in report.session.tracks] == [
        Verdict.PRESUMABLY_SATISFIED,
        Verdict.PRESUMABLY_SATISFIED,
        Verdict.VIOLATED,
    ]


@pytest.mark.parametrize(
    ("cell", "said"), [("300", "0 to 255"), ("-1", "0 to 255"), ("0.5", "a whole number"), ("inf", "0"), ("nan", "0")]
)
@pytest.mark.parametrize("form", ["csv", "jsonl"])
def test_a_cell_that_the_type_of_its_field_cannot_have_is_refused(
    tmp_path: Path, cell: str, said: str, form: str
) -> None:
    path = tmp_path / f"run.{form}"
    json = f'"{cell}"' if cell.isalpha() else cell
    path.write_text(f"time,byte\n0,{cell}\n" if form == "csv" else f'{{"time": 0, "byte": {json}}}\n')
    report = run(*from_text("decl byte /byte UInt8.data\nnever byte > 5"), path)
    assert report.exit_code == 2
    assert report.diagnostics[0].code == "LTL803"
    assert said in report.diagnostics[0].message


def test_the_elements_of_a_recorded_array_are_of_its_type(tmp_path: Path) -> None:
    path = tmp_path / "run.jsonl"
    for elements, code in (("[1, 18446744073709551615]", 1), ("[1, NaN]", 2), ("[0.5]", 2), ("[-1]", 2)):
        path.write_text(f'{{"time": 0, "ids": {elements}}}\n')
        report = run(*from_text("decl ids /ids UInt64MultiArray.data never max(ids) > 18446744073709551614"), path)
        assert report.exit_code == code, elements


@pytest.mark.parametrize("cells", ["3.0,9007199254740993.0", "3e0,+9007199254740993", " 3 , 9007199254740993 "])
def test_a_whole_number_may_be_written_in_any_way(tmp_path: Path, cells: str) -> None:
    path = tmp_path / "run.csv"
    path.write_text(f"time,byte,id\n0,{cells}\n")
    text = "decl byte /byte UInt8.data decl id /id UInt64.data\nnever byte == 3\nnever id >= 9007199254740992"
    report = run(*from_text(text), path)
    assert report.exit_code == 1, report.diagnostics
    assert report.session is not None
    assert all(track.verdict is Verdict.VIOLATED for track in report.session.tracks)
