"""What could silently be read otherwise than it is meant: second properties, nesting, units, foreign words."""

from __future__ import annotations

import pytest
from language_support import codes_of, compiled, findings, marked

from ltlc.base.diagnostics import Severity
from ltlc.base.nearest import slip, words
from ltlc.specification.specification import Specification

SIGNALS = "".join(f"decl {name} /{name} Bool.data\n" for name in ("a", "b", "c", "armed", "landed", "fault"))
SIGNALS += "decl v /v Float64.data\n"


def said_of(text: str) -> tuple[str, str, str]:
    """The code of the only finding, the text that it points at, and its help."""
    (found,) = findings(SIGNALS + text)
    return found.code, marked(found), found.help


@pytest.mark.parametrize(
    ("text", "second", "mended"),
    [
        ("safe: always armed until landed, never fault", "until landed, never fault", "`until landed, always armed`"),
        ("never a b", "b", "`never a and b`"),
        ("always (a implies b) eventually c", "eventually c", "`always (a implies b) and eventually c`"),
        ("never a   never b  never c", "never b", "`never a and never b`"),
        ("forall r in {p, q}: never r.velocity > 1 a", "a", "begin the second on a new line"),
    ],
)
def test_a_property_without_a_label_does_not_begin_where_another_one_ends(text: str, second: str, mended: str) -> None:
    code, place, help = said_of(text)
    assert (code, place) == ("LTL019", second)
    assert mended in help


@pytest.mark.parametrize(
    "text",
    [
        "never a\nnever b",
        "never a last: never b",
        "never a _timeout_ = 3 never b",
        "decl d /d Bool.data never d",
        "limit = 2 never v > limit",
        "never a # first\nnever b",
        "never\n a\nnever b",
        "forall r in {p, q}: never r.velocity > 1\nnever a",
    ],
)
def test_properties_that_stand_apart_are_two(text: str) -> None:
    assert codes_of(SIGNALS + text) == []


def test_nothing_is_said_of_a_second_property_where_the_first_is_wrong() -> None:
    assert codes_of(SIGNALS + "eventualy a") == ["LTL101"]


@pytest.mark.parametrize(
    ("text", "inside", "nested", "apart"),
    [
        ("eventually a and eventually b", "eventually b", "eventually (a and eventually b)", "(eventually a) and"),
        ("always a or always b", "always b", "always (a or always b)", "(always a) or always b"),
        ("never a and never b", "never b", "never (a and never b)", "(never a) and never b"),
        ("always a and eventually b", "eventually b", "always (a and eventually b)", "(always a) and eventually b"),
        ("after c, eventually a and until b, v > 1", "until b, v > 1", "eventually (a and until b, v > 1)", ""),
        ("x = eventually a and eventually b\nnot x", "eventually b", "eventually (a and eventually b)", ""),
    ],
)
def test_what_ends_up_inside_a_keyword_gets_a_note_with_both_readings(
    text: str, inside: str, nested: str, apart: str
) -> None:
    (found,) = findings(SIGNALS + text)
    assert (found.code, found.severity, marked(found)) == ("LTL311", Severity.NOTE, inside)
    assert nested in found.message
    assert apart in found.help


@pytest.mark.parametrize(
    "text",
    [
        "eventually (a and eventually b)",
        "(eventually a) and eventually b",
        "always a implies eventually b",
        "always (a implies eventually b)",
        "after a, b and eventually c",
        "eventually a and b",
    ],
)
def test_no_note_where_it_is_plain_what_is_meant(text: str) -> None:
    assert codes_of(SIGNALS + text) == []


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("always a and always b", "(always a) and always b"),
        ("always a and never b", "(always a) and never b"),
        ("eventually a or eventually b", "(eventually a) or eventually b"),
    ],
)
def test_no_note_where_both_readings_are_one(text: str, same: str) -> None:
    from ltlc.automata.languages import Languages
    from ltlc.semantics.encodings import EPISODE, encode

    assert codes_of(SIGNALS + text) == []
    specification: Specification = compiled(f"{SIGNALS}{text}\n{same}")
    one, two = specification.properties
    space = Languages(one.alphabet)
    assert space.equal(*(space.of(encode(each.property, EPISODE)) for each in (one, two)))


@pytest.mark.parametrize(
    ("text", "place", "help"),
    [
        ("never v > 2 m/s", "2 m/s", "write `2` (m/s)"),
        ("never v > 2m", "2m", "write `2` (m)"),
        ("never v > 2.5 rad/s and a", "2.5 rad/s", "write `2.5` (rad/s)"),
        ("never v > 36 km/h", "36 km/h", "write `10` (m/s)"),
        ("never v > 180 degrees", "180 degrees", "write `3.14159` (rad)"),
        ("never v > 30 %", "30 %", "write `0.3` (as a fraction)"),
    ],
)
def test_a_unit_after_a_number_is_told_about(text: str, place: str, help: str) -> None:
    code, marked_text, told = said_of(text)
    assert (code, marked_text) == ("LTL020", place)
    assert told.startswith(help)


@pytest.mark.parametrize("text", ["never v > 2 m: never a", "never v > 2\nm = 3\nnever v > m", "never age(v) > 2 s"])
def test_what_follows_a_number_may_be_something_else(text: str) -> None:
    assert codes_of(SIGNALS + text) == []


@pytest.mark.parametrize(
    ("text", "written", "here"),
    [
        ("a <-> b", "<->", "=="),
        ("a <=> b", "<=>", "=="),
        ("always (a ⇔ b)", "⇔", "=="),
        ("a iff b", "iff", "=="),
        ("always (a xor b)", "xor", "!="),
        ("always (a => b)", "=>", "implies"),
        ("never v => 3", "=>", ">="),
        ("G a", "G", "always"),
        ("F (a and b)", "F", "eventually"),
        ("F(a)", "F", "eventually"),
        ("a and G b", "G", "always"),
        ("globally a", "globally", "always"),
        ("finally (a)", "finally", "eventually"),
    ],
)
def test_a_word_of_another_language_gets_that_of_this_one(text: str, written: str, here: str) -> None:
    code, place, help = said_of(text)
    assert (code, place) == ("LTL004", written)
    assert f"`{here}`" in help


@pytest.mark.parametrize(
    "text", ["decl G /g Bool.data\nnever G", "F = v > 1\nalways F and a", "G: never a", "iff = 2\nnever v > iff"]
)
def test_words_of_other_languages_can_be_names(text: str) -> None:
    assert codes_of(SIGNALS + text) == []


@pytest.mark.parametrize(
    ("text", "place", "meant"),
    [
        ("never robot.distance.sign < 1\nnever robto.velocity > 1", "robto", "robot"),
        ("never robot.distance.sign < 1\nnever robot.distance.sing < 1", "sing", "sign"),
        (
            "object robot at (0, 0, 0)\nnever robott.velocity > 1\nnever robott.velocity > robot.velocity",
            "robott",
            "robot",
        ),
        ("never Robot.velocity > 1\nnever robot.velocity > 1 and robot.position.x > 1", "Robot", "robot"),
        ("forall r in {truck1, turck2, truck3}: never r.velocity > 1", "turck2", "truck2"),
        ("never stop_sign1.velocity > 1\nnever stop_sing2.velocity > 1", "stop_sing2", "stop_sign2"),
    ],
)
def test_an_undeclared_object_that_is_called_almost_as_another_is_asked_about(
    text: str, place: str, meant: str
) -> None:
    found = next(f for f in findings(text) if f.code == "LTL110")
    assert (marked(found), found.severity) == (place, Severity.WARNING)
    assert f"did you mean `{meant}`?" in found.message


@pytest.mark.parametrize(
    "text",
    [
        "never robot1.distance.robot2 < 1",
        "never door_a.distance.door_b < 1",
        "never cat.distance.car < 1",
        "object robto at (1, 0, 0) object robot at (0, 0, 0)\nnever robot.distance.robto < 0",
        "never left_door.distance.right_door < 1",
        "model robot: battery /b Float64.data ;\nnever robot.battery < 1 or robot.velocity > 1",
    ],
)
def test_objects_of_a_kind_and_declared_ones_are_not_asked_about(text: str) -> None:
    assert "LTL110" not in codes_of(text)


@pytest.mark.parametrize(
    ("name", "other", "expected"),
    [
        ("robto", "robot", ("robto", "robot")),
        ("robt7", "robot12", ("robt", "robot")),
        ("roboot", "robot", ("roboot", "robot")),
        ("ROBOT", "robot", ("ROBOT", "robot")),
        ("robits", "robot", None),
        ("robot", "robot", None),
        ("robot_arm", "robot", None),
        ("map", "mop", None),
    ],
)
def test_a_slip_is_one_letter_in_one_longer_word(name: str, other: str, expected: tuple[str, str] | None) -> None:
    assert slip(words(name), words(other)) == expected
