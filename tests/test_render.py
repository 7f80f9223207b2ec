"""The forms in which diagnostics are shown."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import pytest

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Label
from ltlc.base.render import concise, full, json, sarif
from ltlc.base.source import Source, Span


def at(text: str, part: str, *secondary: str, label: str = "", help: str = "") -> Diagnostic:
    """A diagnostic about `part` of `text`."""
    labels = tuple(Label(span_of(text, other), "see") for other in secondary)
    place = span_of(text, part)
    return diagnostic("LTL101", Source("p.txt", text), place, "who?", label=label, secondary=labels, help=help)


def span_of(text: str, part: str) -> Span:
    return Span(text.index(part), text.index(part) + len(part))


def shown(found: Diagnostic) -> str:
    return full.render([found])


def test_the_full_form_marks_the_place_and_says_how_to_mend_it() -> None:
    found = at("always x\nnever spede > 2\n", "spede", label="this", help="did you mean `speed`?")
    assert shown(found) == (
        "error[LTL101]: who?\n"
        " --> p.txt:2:7\n"
        "  |\n"
        "2 | never spede > 2\n"
        "  |       ^^^^^ this\n"
        "  = help: did you mean `speed`?\n\n"
    )


def test_secondary_places_are_marked_with_dots_between_distant_lines() -> None:
    text = "a = 1\nb = 2\n" + "\n" * 8 + "a = 3\n"
    assert shown(at(text, "a = 3", "a = 1")) == (
        "error[LTL101]: who?\n  --> p.txt:11:1\n   |\n 1 | a = 1\n   | ----- see\n...\n11 | a = 3\n   | ^^^^^\n\n"
    )


def test_two_places_in_one_line_are_marked_below_one_another() -> None:
    lines = shown(at("never x > y", "y", "x")).splitlines()
    assert lines[3:6] == ["1 | never x > y", "  |           ^", "  |       - see"]


def test_a_place_of_several_lines_is_marked_in_the_first_and_the_last() -> None:
    lines = shown(at("never (x\n  or y\n  or z)\n", "(x\n  or y\n  or z)", label="all")).splitlines()
    assert lines[3:] == ["1 | never (x", "  |       ^^ …", "...", "3 |   or z)", "  |   ^^^^^ all", ""]


@pytest.mark.parametrize(
    ("line", "part", "mark"),
    [
        ("\tnever x", "x", "          ^"),
        ("ab\tx", "x", "    ^"),
        ("日本 x", "x", "     ^"),
        ("x 日本", "日本", "  ^^^^"),
        ("e\u0301 x", "x", "  ^"),
        ("x", "", "^"),
    ],
)
def test_marks_stand_below_what_a_terminal_shows(line: str, part: str, mark: str) -> None:
    assert shown(at(line, part)).splitlines()[4] == f"  | {mark}"


def test_a_place_at_the_very_end_of_a_text_is_marked() -> None:
    source = Source("p.txt", "never x\n")
    found = diagnostic("LTL006", source, Span(8, 8), "more")
    assert shown(found).splitlines()[1:5] == [" --> p.txt:2:1", "  |", "2 |", "  | ^"]


def test_a_long_line_is_cut_around_the_place() -> None:
    lines = shown(at("x " * 5_000 + "here" + " y" * 5_000, "here")).splitlines()
    start = lines[4].index("^")
    assert len(lines[3]) < 200
    assert lines[3][start : start + 4] == "here"


def test_control_characters_cannot_command_the_terminal() -> None:
    text = "never \x1b[31m\x00 x"
    found = diagnostic("LTL101", Source("a\x1bb", text), span_of(text, "x"), "a\x1b[0m", help="\x07")
    for rendered in (shown(found), concise.render([found])):
        assert not {c for c in rendered if ord(c) < 32} - {"\n"}


def test_colour_is_given_only_when_asked_for() -> None:
    found = at("never x", "x")
    assert "\x1b[" not in full.render([found])
    coloured = full.render([found], colour=True)
    assert "\x1b[1;31merror[LTL101]\x1b[0m" in coloured


def test_colour_changes_nothing_but_the_colour() -> None:
    found = at("never x\n\n\nnever y", "y", "x", label="this", help="mend")
    coloured = full.render([found], colour=True)
    assert re.sub("\x1b\\[[0-9;]*m", "", coloured) == full.render([found])
    assert "\x1b[1;31m^ this\x1b[0m" in coloured


def test_a_diagnostic_without_a_place_names_the_file() -> None:
    found = diagnostic("LTL901", Source("none.txt", ""), None, "there is no file none.txt")
    assert shown(found) == "error[LTL901]: there is no file none.txt\n --> none.txt\n\n"
    assert concise.render([found]) == "none.txt: error[LTL901] there is no file none.txt\n"


def test_the_concise_form_has_one_line_each() -> None:
    assert concise.render([at("a\nnever x", "x"), at("y", "y")]) == (
        "p.txt:2:7: error[LTL101] who?\np.txt:1:1: error[LTL101] who?\n"
    )


def test_json_has_the_fields_of_the_design_counting_from_one() -> None:
    assert json.documents([at("a\nnever xy > z", "xy", "z", help="mend")]) == [
        {
            "code": "LTL101",
            "name": "unknown-name",
            "severity": "error",
            "message": "who?",
            "span": {"file": "p.txt", "start": {"line": 2, "column": 7}, "end": {"line": 2, "column": 9}},
            "related": [
                {
                    "span": {"file": "p.txt", "start": {"line": 2, "column": 12}, "end": {"line": 2, "column": 13}},
                    "message": "see",
                }
            ],
            "help": "mend",
            "example": None,
            "fixes": [],
        }
    ]


def test_json_has_the_infinite_numbers_of_an_example_as_strings() -> None:
    steps = [{"values": {"v": math.inf, "scan": [1, -math.inf]}, "remark": ""}]
    found = replace(at("never v > 1", "v"), example={"caption": "", "steps": steps, "loop": None})
    assert json.document(found)["example"]["steps"][0]["values"] == {"v": "inf", "scan": [1, "-inf"]}


def test_sarif_locates_results_and_describes_their_rules() -> None:
    log = sarif.document([at("never x > y", "x", "y")])
    (run,) = log["runs"]
    (result,) = run["results"]
    assert log["version"] == "2.1.0"
    assert run["tool"]["driver"]["rules"][result["ruleIndex"]]["id"] == result["ruleId"] == "LTL101"
    assert result["locations"][0]["physicalLocation"]["region"] == {
        "startLine": 1,
        "startColumn": 7,
        "endLine": 1,
        "endColumn": 8,
    }
    assert result["relatedLocations"][0]["message"] == {"text": "see"}


@pytest.mark.parametrize(
    ("name", "uri"),
    [("my props.txt", "my%20props.txt"), ("a/ü.txt", "a/%C3%BC.txt"), ("/x y.txt", "file:///x%20y.txt")],
)
def test_sarif_names_files_by_uri(name: str, uri: str) -> None:
    found = diagnostic("LTL101", Source(name, "x"), Span(0, 1), "who?")
    (result,) = sarif.document([found])["runs"][0]["results"]
    assert result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == uri
