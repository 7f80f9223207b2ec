"""The parser: what binds how, where it goes on after an error, and that no text can upset it."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from language_support import codes_of, compiled, findings, marked, only_property

from ltlc.base.diagnostics import Severity
from ltlc.base.render import concise, full, sarif
from ltlc.base.render.json import documents
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.frontend.syntax import generate
from ltlc.frontend.syntax.parse import MAX_DEPTH
from ltlc.semantics.properties import Property

FIXTURES = [path.read_text(encoding="utf-8") for path in (Path(__file__).parent / "fixtures" / "check").glob("*.txt")]
FRAGMENTS = [
    "decl", "model", "object", "at", "always", "never", "eventually", "after", "until", "after_until", "implies",
    "or", "and", "not", "true", "false", "(", ")", "{", "}", "[", "]", ",", ";", ":", ".", "@", "=", "==", "!=", "<",
    "<=", ">", ">=", "+", "-", "*", "/", "x", "robot", "stop_sign", ".velocity", ".position", ".distance.stop_sign",
    "1", "2.5", "-1", "1e3", '"s"', "'q'", '"', "#", "/odom", "Odometry.pose.pose.position", "_rate_", "_margin_",
    "_foo_", "min(", "abs(", "foo(", "within", "GoalStatus.STATUS_ABORTED", "&&", "||", "!", "->", "≤", "“", "\0",
    "for", "2 s", "500ms", "once", "since", "historically", "previously", "initially", "new", "age(",
    "é", "日本", "{0.1}", "@{x,-1}", "@{robot.velocity,-2}", "p:", "x=",
]  # fmt: skip


"""Pieces of text that mean something to the parser, some of them wrong."""


def property_of(text: str) -> Property:
    return only_property(text).property


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("always v > 1 or w > 1 and flag", "always (v > 1 or (w > 1 and flag))"),
        ("always not flag and v > 1", "always ((not flag) and v > 1)"),
        ("always v > 1 implies w > 1 implies flag", "always (v > 1 implies (w > 1 implies flag))"),
        ("(always flag) and eventually v > 1 or w > 1", "(always flag) and (eventually (v > 1 or w > 1))"),
        ("not always flag and v > 1", "not (always (flag and v > 1))"),
        ("after flag, always v > 1 and w > 1", "after flag, (always (v > 1 and w > 1))"),
        ("always v - 1 - 2 > 1 + w * 2", "always ((v - 1) - 2) > (1 + (w * 2))"),
        ("always -v * 2 > 1", "always ((-v) * 2) > 1"),
        ("always - -v > 1", "always (-(-v)) > 1"),
        ("after_until flag, not flag, until v > 1, flag", "after_until flag, (not flag), (until v > 1, (flag))"),
    ],
)
def test_operators_bind_as_the_language_says(text: str, same: str) -> None:
    assert property_of(text) == property_of(same)


def test_line_breaks_are_white_space_and_comments_are_none_of_the_text() -> None:
    found = only_property("never # always\n\tv\r\n > 2 # end")
    assert found.text == "never v > 2"


def test_a_comment_sign_in_a_string_is_a_part_of_it() -> None:
    assert only_property('never mode == "#1" # a comment').text == 'never mode == "#1"'


def test_commands_may_share_a_line_and_each_property_has_a_label() -> None:
    text = "never a.velocity > 1 fast: never a.velocity > 2 never_ = 3\n\nnever a.velocity > never_"
    found = compiled(text)
    assert [p.label for p in found.properties] == ["line 1", "fast", "line 3"]
    assert [p.line for p in found.properties] == [1, 1, 3]


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("after a.velocity > 1 b.velocity > 1", "LTL002", "b"),
        ("until a.velocity > 1", "LTL006", "1"),
        ("eventually a.velocity = 0", "LTL003", "="),
        ("never (a.velocity > 1", "LTL005", "1"),
        ("never a.velocity =={0.1 1", "LTL005", "1"),
        ("never min(a.velocity, 2 > 1", "LTL005", ">"),
        ("never a.velocity && true", "LTL004", "&&"),
        ("never a.velocity > 1 AND true", "LTL004", "AND"),
        ("never !true", "LTL004", "!"),
        ("always true -> true", "LTL004", "->"),
        ("never 1 < a.velocity < 2", "LTL013", "<"),
        ("model m: position /odom Odometry.pose.pose.position", "LTL007", "n"),
        ("model m: position /odom Odometry.pose.pose.position\nnear = 1\nnever near > 1", "LTL007", "near"),
        ("model m: position /odom Odometry.pose.pose.position\np: never true", "LTL007", "p"),
        ("model m: position = /odom Odometry.pose.pose.position ;", "LTL006", "="),
        ("decl scan = /scan LaserScan.ranges", "LTL006", "="),
        ("never a.6 > 1", "LTL001", "6"),
        ("decl never /x Float64.data", "LTL008", "never"),
        ("decl x never a.velocity > 1", "LTL006", "never"),
        ("after a.velocity > 1 within 5, true", "LTL016", "within 5"),
        ("next = 5", "LTL009", "next"),
        ("never a.localization error > 1", "LTL010", "localization error"),
        ("after until true, true, true", "LTL010", "after until"),
        ("never a.velocity > 1)", "LTL001", ")"),
        ("p: q: true", "LTL021", "p: q: true"),
        ("never", "LTL006", "r"),
        ("_rate_ 30", "LTL006", "30"),
        ("object s at (1, 2)", "LTL006", ")"),
        ("@{a.velocity -1} > 1", "LTL002", "}"),
    ],
)
def test_a_mistake_is_explained_where_it_is(text: str, code: str, place: str) -> None:
    found = next(d for d in findings(text) if d.code.startswith("LTL0"))
    assert (found.code, marked(found)) == (code, place)
    assert "unexpected" not in found.message


def test_several_mistakes_are_found_and_what_is_right_between_them() -> None:
    text = "never (a.velocity > 1\nok: never a.velocity > 2\nafter x y\nalso: never a.velocity = 3\nnever spede > 1"
    assert codes_of(text) == ["LTL005", "LTL002", "LTL003", "LTL101"]


def test_a_name_defined_in_a_broken_command_is_not_called_unknown() -> None:
    assert codes_of("limit = (2\nnever a.velocity > limit") == ["LTL005"]


def test_a_chain_up_to_the_limit_of_depth_is_compiled() -> None:
    assert codes_of("never " + " and ".join(["a.velocity > 1"] * (MAX_DEPTH - 5))) == []


@given(st.text(max_size=60))
def test_any_text_gives_diagnostics_and_never_an_exception(text: str) -> None:
    check(text)


@given(st.lists(st.sampled_from(FRAGMENTS), max_size=25), st.sampled_from(["", " ", "\n"]))
def test_any_tokens_give_diagnostics_and_never_an_exception(tokens: list[str], between: str) -> None:
    check(between.join(tokens))


@given(st.sampled_from(FIXTURES), st.integers(0, 2**32), st.integers(1, 4))
def test_any_change_of_a_specification_gives_diagnostics_and_never_an_exception(text: str, seed: int, n: int) -> None:
    check(changed(text, random.Random(seed), n))


def changed(text: str, chance: random.Random, changes: int) -> str:
    """`text` with some characters deleted, doubled, replaced by fragments, or moved."""
    for _ in range(changes):
        start = chance.randrange(len(text) + 1)
        end = min(len(text), start + chance.randrange(12))
        text = text[:start] + chance.choice(["", text[start:end] * 2, chance.choice(FRAGMENTS), "\n"]) + text[end:]
    return text


def check(text: str) -> None:
    specification, diagnostics = load_text(Source("props.txt", text))
    assert (specification is None) == any(d.severity is Severity.ERROR for d in diagnostics)
    for rendered in (full.render(diagnostics, colour=True), concise.render(diagnostics)):
        rendered.encode()
    json.dumps([documents(diagnostics), sarif.document(diagnostics)])


def test_the_tables_are_those_of_the_grammar() -> None:
    stored = json.loads((Path(generate.__file__).parent / "tables.json").read_text())
    assert stored == generate.tables(), "run `python -m ltlc.frontend.syntax.generate`"


def test_the_tables_do_not_depend_on_hashes() -> None:
    code = "import ltlc.base.files as f, ltlc.frontend.syntax.generate as g; print(f.compact_json(g.tables()))"
    outputs = {
        subprocess.run(
            [sys.executable, "-c", code], env={"PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in ("1", "2")
    }
    assert len(outputs) == 1
