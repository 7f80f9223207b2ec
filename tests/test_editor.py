"""What an editor is told about a place of a specification, and what it is offered there."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ltlc.base.diagnostics import Fix
from ltlc.base.source import Source, Span
from ltlc.frontend.language import load_text
from ltlc.frontend.language.suppression import suppress
from ltlc.frontend.syntax.lexer import KEYWORDS
from ltlc.inputs.messages.definitions import MessageTypes, shipped
from ltlc.interfaces.editor.completion import completions
from ltlc.interfaces.editor.document import Document, document
from ltlc.interfaces.editor.fixes import fixes
from ltlc.interfaces.editor.hover import hover
from ltlc.interfaces.editor.keywords import MEANINGS
from ltlc.interfaces.editor.lens import lenses
from ltlc.interfaces.editor.navigation import RefusedError, definitions, references, rename
from ltlc.interfaces.editor.outline import outline
from ltlc.interfaces.editor.positions import Lines
from ltlc.interfaces.editor.tokens import tokens

ROOT = Path(__file__).parents[1]
FIXTURES = sorted([*(ROOT / "tests/fixtures").glob("*/*.txt"), *(ROOT / "examples").glob("**/*.txt")])

TEXT = """decl scan /scan LaserScan.ranges  # the lidar
decl robot1_battery /robot1/battery BatteryState.percentage
decl robot2_battery /robot2/battery BatteryState.percentage
model robot1: position /odom Odometry.pose.pose.position charge /c BatteryState.charge ;
object stop_sign at (10, 0, 0)
stopped = robot1.velocity =={0.01} 0
limit = 2 s
drift: never robot1.localization_error > 0.5 and robot1.charge < 2
min(scan) > 0.3
after_until robot1.distance.stop_sign < 1, robot1.distance.stop_sign > 3, eventually stopped within limit
low: forall r in {robot1, robot2}: never r.velocity > 3 and {r}_battery < 0.1
"""


@cache
def read(text: str) -> Document:
    return document(Source("props.txt", text), MessageTypes(shipped()))


def marked(text: str) -> tuple[Document, int]:
    """The text without its mark `|`, and where that was."""
    return read(text.replace("|", "", 1)), text.index("|")


def said(text: str) -> str:
    """What the hover at the mark says."""
    read_, offset = marked(text)
    found = hover(read_, offset, read_.diagnostics)
    return found.text if found else ""


def offered(text: str) -> list[str]:
    """The words that are offered at the mark."""
    return [suggestion.text for suggestion in completions(*marked(text)).suggestions]


def lines_of(document_: Document, spans: list[Span]) -> list[tuple[int, str]]:
    """The lines and the texts of `spans`."""
    return [(document_.source.position(s.start).line, document_.text[s.start : s.end]) for s in spans]


def at(word: str) -> str:
    """`TEXT` with a mark in the first place where `word` stands."""
    return TEXT.replace(word, f"{word[0]}|{word[1:]}", 1)


@given(st.text(st.sampled_from("ab\n\r𝒳é€ "), max_size=30), st.sampled_from(["utf-8", "utf-16", "utf-32"]))
def test_positions_count_the_units_of_the_encoding_in_lines_that_editors_know(text: str, encoding: str) -> None:
    lines = Lines(text, encoding)
    size = {"utf-8": 1, "utf-16": 2, "utf-32": 4}[encoding]
    name = encoding if size == 1 else f"{encoding}-le"
    for offset in range(len(text) + 1):
        if text[offset - 1 : offset + 1] == "\r\n":
            continue
        before = re.split(r"\r\n|\n|\r", text[:offset])
        assert lines.position(offset) == (len(before) - 1, len(before[-1].encode(name)) // size)
        assert lines.offset(*lines.position(offset)) == offset


def test_a_position_beyond_a_line_is_its_end_and_beyond_the_text_the_end_of_that() -> None:
    lines = Lines("ab\r\nc")
    assert (lines.offset(0, 9), lines.offset(1, 9), lines.offset(7, 0)) == (2, 5, 5)


def test_a_position_between_the_halves_of_a_character_is_before_it() -> None:
    assert Lines("𝒳a").offset(0, 1) == 0


def test_hovering_over_a_label_says_the_property_in_english() -> None:
    assert "**drift**: There is no step at which the localization error of robot1 is more than 0.5" in said(at("drift"))


def test_hovering_over_a_keyword_says_what_it_means_and_what_the_property_says() -> None:
    text = said(at("after_until"))
    assert "`after_until X, Y, Z`: Z holds on every episode of u." in text
    assert "In each episode that opens when the distance from robot1 to stop_sign is less than 1" in text


def test_hovering_over_the_number_of_a_window_says_how_many_samples_it_has() -> None:
    text = "decl v /v Float64.data\np: never max(@{v, -4|9:}) > 2 and v > @{v, -1}\n"
    assert said(text) == "`@{v, -49:}`: the last 49 samples of `v` and the present one, oldest first: 50 values"
    assert not said(text.replace("|", "").replace("-1}", "-|1}"))


@pytest.mark.parametrize("interval", ["[1| s, 5 s]", "[1 s, 5| s]"])
def test_hovering_over_a_number_of_an_interval_says_from_when_to_when(interval: str) -> None:
    text = f"decl v /v Float64.data\np: eventually v > 2 within {interval}\n"
    assert said(text) == "`[1 s, 5 s]`: from 1 s to 5 s after the first instant, both included"


def test_hovering_over_a_signal_says_its_type_and_its_topic() -> None:
    text = said(TEXT.replace("min(scan)", "min(sc|an)"))
    assert text == "`scan`: an array of numbers\n\nRead from `/scan`: `sensor_msgs/LaserScan.ranges`, float32[]"


def test_hovering_over_messages_without_a_field_says_on_which_topic_they_come() -> None:
    text = said("decl bump /bumper std_msgs/Empty\nnever new bu|mp\n")
    assert text == "`bump`: a message\n\nArrives on `/bumper`: `std_msgs/Empty`, without a value"


def test_hovering_over_the_topic_of_a_declaration_says_what_is_read_from_it() -> None:
    assert said(at("/robot1/battery")).startswith("`robot1_battery`: a number\n\nRead from `/robot1/battery`")
    assert said(at("BatteryState.percentage")).startswith("`robot1_battery`: a number")


def test_hovering_over_a_primitive_says_its_unit() -> None:
    assert "the speed of robot1, a number, in m/s" in said(TEXT.replace("robot1.velocity", "robot1.vel|ocity"))
    assert "in rad/s" in said("never robot.velocity.angular.|x > 1\n")


def test_hovering_over_an_object_says_where_its_ground_truth_is() -> None:
    assert said(at("stop_sign")) == "`stop_sign`: an object at (10, 0, 0), m"
    text = said(at("robot1:"))
    assert "its ground truth is on `/model/robot1/odometry`" in text
    assert "- believes `charge`: Read from `/c`: `sensor_msgs/BatteryState.charge`, float32" in text


def test_hovering_over_an_attribute_of_a_model_says_where_it_is_read_wherever_it_stands() -> None:
    for text in (at("charge /c"), TEXT.replace("robot1.charge", "robot1.cha|rge")):
        assert said(text).startswith("`robot1.charge`: a number\n\nRead from `/c`")


def test_hovering_over_an_association_says_what_it_stands_for() -> None:
    assert said(TEXT.replace("eventually stopped", "eventually st|opped")).startswith(
        "`stopped` is `robot1.velocity =={0.01} 0`"
    )
    assert "a duration, 2 s" in said(at("limit"))


def test_under_a_forall_each_name_is_told() -> None:
    other = "both: forall r in {robot2}: {r}_battery > 0.5\n"
    for of in (f"{other}{TEXT}", f"{TEXT}{other}"):
        assert said(of.replace("never r.", "never |r.")).startswith("`r` stands for `robot1`, `robot2`\n")
    text = said(TEXT.replace("{r}_battery", "{r}_bat|tery"))
    assert "`/robot1/battery`" in text
    assert "`/robot2/battery`" in text


def test_hovering_over_the_code_in_a_comment_shows_its_page() -> None:
    assert said("never robot.velocity > 2 # ltlc: ignore LTL5|12\n").startswith("# LTL512: encodings-differ")


def test_hovering_over_a_fault_shows_the_page_of_its_code() -> None:
    assert "# LTL101: unknown-name" in said("never spee|d > 2\n")


def test_hovering_over_a_comment_or_a_string_says_nothing_of_keywords_in_it() -> None:
    assert said("never robot.velocity > 2 # nev|er\n") == ""
    assert "P holds" not in said('decl mode /mode String.data never mode == "al|ways"\n')


def test_the_meanings_of_words_are_those_of_the_language_reference() -> None:
    page = " ".join((ROOT / "docs/language.md").read_text(encoding="utf-8").split())
    own = {"age", "min", "max", "abs", "sqrt", "decl", "new", "_rate_", "_simulator_"}
    for word, meaning in MEANINGS.items():
        parts = re.split(r"; (?=at some|p has)|\. ", meaning.says)
        assert word in own or all(part in page for part in parts), word


def test_every_keyword_that_says_something_has_a_meaning() -> None:
    assert set(MEANINGS) >= KEYWORDS - {"true", "false", "at"}


@pytest.mark.parametrize(
    ("head", "words"),
    [
        ("a: each |", {"new"}),
        ("each n|", {"new"}),
        ("each g |", {"of"}),
        ("each new |", {"scan", "robot1_battery", "robot1"}),
        ("each new ro|", {"scan", "robot1_battery", "robot1"}),
        ("never once new scan 3 |", {"times"}),
        ("never once robot1_battery < 1 3 ti|", {"times"}),
    ],
)
def test_the_words_of_each_and_of_counts_are_offered_where_they_stand(head: str, words: set[str]) -> None:
    found = set(offered(TEXT + head))
    assert words <= found
    assert len(words) == 1 or not found & {"of", "and"}


def test_attributes_of_an_object_are_offered_those_of_its_model_too() -> None:
    found = offered(TEXT + "never robot1.vel|")
    assert {"velocity", "localization_error", "distance", "charge"} <= set(found)


def test_after_a_distance_the_other_objects_are_offered() -> None:
    assert set(offered(TEXT + "never robot1.distance.|")) == {"stop_sign", "robot2"}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("never robot.velocity.|", {"x", "y", "z", "linear", "angular"}),
        ("never robot.orientation.|", {"roll", "pitch", "yaw"}),
        ("decl p /p Odometry.pose.pose.position\nnever p.|", {"x", "y", "z"}),
        ("decl g /g GoalStatus.|", {"goal_info", "status"}),
        ("decl g /g Odometry.pose.|", {"pose", "covariance"}),
        ("decl g /g action_msgs/GoalStatusArray.status_list[].|", {"goal_info", "status"}),
        ("_simulator_ = |", {"odometry", "tf", "model_states"}),
        ("decl a /one Bool.data decl b /|", {"/one"}),
        ("object o /t |", {"Odometry", "PoseStamped", "Pose", "TFMessage", "ModelStates"}),
        ("never robot.velocity > 1 a|", {"and", "or", "implies", "since", "in", "within", "for"}),
        ("model robot: p|", {"position", "velocity", "orientation"}),
        ("decl |", set()),
        ("never # rob|", set()),
        ('decl m /m String.data never m == "|', set()),
    ],
)
def test_what_is_offered_is_what_can_stand_there(text: str, expected: set[str]) -> None:
    if "GoalStatus.|" in text:
        text = text.replace("GoalStatus", "action_msgs/GoalStatus")
    assert set(offered(text)) == expected


def test_a_command_may_follow_that_on_the_simulator() -> None:
    assert {"object", "model", "never"} <= set(offered("_simulator_ = tf\nobj|"))


@pytest.mark.parametrize("text", ["x" * 300_000, "forall " + " " * 20_000])
def test_what_nobody_writes_holds_nothing_up(text: str) -> None:
    assert offered(text + "|") is not None


def test_messages_with_constants_are_offered_where_a_value_is_compared() -> None:
    assert "GoalStatus" in offered("decl s /s Int8.data\nnever s == Goal|")
    assert "GoalStatus" not in offered("decl s /s Int8.data\nnever s < Goal|")


def test_constants_of_a_message_are_offered() -> None:
    assert "STATUS_ABORTED" in offered("never x == action_msgs/GoalStatus.|")
    assert "STATUS_ABORTED" in offered("never x == GoalStatus.ST|")


def test_the_opening_is_offered_where_history_is_asked_for() -> None:
    assert "opening" in offered(TEXT + "never @{scan, |")
    assert "opening" not in offered(TEXT + "never min(scan, |")


def test_a_variable_is_offered_with_what_its_first_name_has() -> None:
    assert "r" in offered("forall r in {robot1, robot2}: never |")
    assert "distance" in offered("forall r in {robot1, robot2}: never r.|")


def test_words_are_offered_where_the_text_around_is_broken() -> None:
    text = "decl decl ) =\nnever ((robot1.|\nafter after\n" + TEXT
    assert {"velocity", "charge"} <= set(offered(text))


def test_every_message_type_that_is_offered_is_one() -> None:
    types = MessageTypes(shipped())
    for text in ("decl x /x |", "decl x /x nav_msgs/|"):
        assert {len(types.find(name)) for name in offered(text)} == {1}


def test_a_name_leads_to_its_definition() -> None:
    read_, offset = marked(TEXT.replace("eventually stopped", "eventually st|opped"))
    assert lines_of(read_, definitions(read_, offset)) == [(6, "stopped")]


def test_a_name_that_a_forall_composes_leads_to_all_that_it_stands_for() -> None:
    read_, offset = marked(TEXT.replace("{r}_battery", "{r}_bat|tery"))
    assert lines_of(read_, definitions(read_, offset)) == [(2, "robot1_battery"), (3, "robot2_battery")]


def test_the_uses_of_a_name_are_found_where_a_forall_composes_it_too() -> None:
    read_, offset = marked(at("robot1_battery"))
    assert lines_of(read_, references(read_, offset)) == [(2, "robot1_battery"), (11, "{r}_battery")]
    assert lines_of(read_, references(read_, offset, with_definitions=False)) == [(11, "{r}_battery")]


def renamed(text: str, name: str) -> str:
    """The text when what stands at the mark has another name."""
    read_, offset = marked(text)
    return read_.source.replaced(Span(0, len(read_.text)), dict(rename(read_, offset, name)))


@pytest.mark.parametrize(
    ("old", "new"),
    [("stopped", "halted"), ("stop_sign", "sign"), ("limit", "most"), ("drift", "lost"), ("scan ", "laser ")],
)
def test_a_name_is_changed_wherever_it_stands_and_nowhere_else(old: str, new: str) -> None:
    expected = re.sub(rf"(?<![/\w]){old.strip()}\b", new.strip(), TEXT)
    assert renamed(at(old), new.strip()) == expected


def test_a_variable_is_changed_in_composed_names_too() -> None:
    assert "low: forall q in {robot1, robot2}: never q.velocity > 3 and {q}_battery" in renamed(at("r in {"), "q")


def test_an_attribute_of_a_model_is_changed_with_its_uses() -> None:
    changed = renamed(at("charge /c"), "level")
    assert "level /c BatteryState.charge" in changed
    assert "robot1.level < 2" in changed


@pytest.mark.parametrize(
    ("place", "name", "reason"),
    [
        ("stopped", "always", "`always` is a keyword"),
        ("stopped", "scan", "`scan` has another meaning in this file"),
        ("stopped", "my name", "with this name"),
        ("drift", "low", "`low` has another meaning"),
        ("robot1_battery", "b", "`{r}_battery` generates this name"),
        ("robot1:", "rover", "`robot1` is its name in the simulation"),
        ("# the", "x", "this file defines no name"),
    ],
)
def test_a_name_that_cannot_be_given_is_refused_with_the_reason(place: str, name: str, reason: str) -> None:
    with pytest.raises(RefusedError, match=re.escape(reason)):
        renamed(at(place), name)


@pytest.mark.parametrize("path", FIXTURES[::12], ids=lambda path: path.stem)
def test_a_new_name_changes_nothing_else_and_can_be_taken_back(path: Path) -> None:
    read_ = read(path.read_text(encoding="utf-8"))
    for word in [word for word in read_.words if word.defines][:3]:
        try:
            edits = rename(read_, word.span.start, "a_new_name")
        except RefusedError:
            continue
        changed = read_.source.replaced(Span(0, len(read_.text)), dict(edits))
        after = read(changed)
        assert [d.code for d in after.diagnostics] == [d.code for d in read_.diagnostics]
        back = rename(after, changed.index("a_new_name"), word.text)
        assert after.source.replaced(Span(0, len(changed)), dict(back)) == read_.text


def test_coloured_tokens_are_in_order_and_within_lines() -> None:
    for path in FIXTURES[::3]:
        read_, end = read(path.read_text(encoding="utf-8")), 0
        for token in tokens(read_):
            assert end <= token.span.start < token.span.end
            assert "\n" not in read_.text[token.span.start : token.span.end]
            end = token.span.end


def test_words_are_coloured_by_what_they_stand_for() -> None:
    kinds = {TEXT[token.span.start : token.span.end]: token.kind for token in tokens(read(TEXT))}
    expected = {
        "decl": "keyword",
        "scan": "variable",
        "/scan": "namespace",
        "LaserScan.ranges": "type",
        "# the lidar": "comment",
        "robot1": "class",
        "charge": "property",
        "stopped": "macro",
        "2 s": "number",
        "drift": "event",
        "min": "function",
        "r": "parameter",
        "0.3": "number",
        "==": "operator",
    }
    assert {word: kinds[word] for word in expected} == expected


def test_the_outline_has_each_command_with_its_text() -> None:
    entries = list(outline(read(TEXT)))
    assert [entry.name for entry in entries[:5]] == ["scan", "robot1_battery", "robot2_battery", "robot1", "stop_sign"]
    assert [child.name for child in entries[3].children] == ["position", "charge"]
    assert entries[-1].name == "low"
    assert entries[-2].name == "line 10"
    assert entries[-3].detail == "min(scan) > 0.3"


def test_there_is_a_lens_for_each_property_with_what_its_monitor_can_do() -> None:
    found = list(lenses(read(TEXT), {"min(scan) > 0.3": "2 states, can fail"}))
    assert [lens.title for lens in found[:2]] == ["show the automaton", "2 states, can fail"]
    assert found[-1].title == "show the automaton (low[robot1], and 1 more of `forall`)"


@pytest.mark.parametrize(
    "text",
    [
        "decl x /x Bool.data\nnever eventually x and eventually x\n",
        "decl x /x Bool.data\nnever eventually x and eventually x  # twice\n",
        "decl x /x Bool.data\nfirst: never eventually x\n   and eventually x # twice\n",
        "decl x /x Bool.data\r\nnever eventually x and eventually x  # twice\r\n",
    ],
)
def test_a_finding_that_is_suppressed_where_it_stands_is_gone(text: str) -> None:
    specification, found = load_text(Source("props.txt", text))
    assert specification is not None
    assert found
    for each in found:
        *_, fix = fixes(each)
        changed = each.source.replaced(Span(0, len(text)), dict(fix.edits))
        again, left = load_text(Source("props.txt", changed))
        assert again is not None
        assert suppress(again, left) == []
        assert set(re.findall(r"(?<!\r)\n", changed)) == set(re.findall(r"(?<!\r)\n", text))


def test_an_error_of_form_cannot_be_suppressed() -> None:
    (found,) = read("never speed > 2\n").diagnostics
    assert [fix.title for fix in fixes(found) if "suppress" in fix.title] == []


def test_a_mend_that_is_certain_is_the_preferred_one_and_is_written_where_it_belongs() -> None:
    messages = pytest.importorskip("ltlc.interfaces.editor.messages", reason="needs the extra `editor`")
    read_ = read("never speed > 2\n")
    fix = Fix("write `spede`", ((Span(6, 11), "spede"),), is_certain=True)
    found = replace(read_.diagnostics[0], fixes=(fix,))
    action = messages.action(messages.View("file:///props.txt", read_, "utf-16"), found, next(fixes(found)))
    (edit,) = action.edit.changes["file:///props.txt"]
    assert (action.title, action.is_preferred, edit.new_text) == ("write `spede`", True, "spede")
    assert (edit.range.start.character, edit.range.end.character) == (6, 11)
