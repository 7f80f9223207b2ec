"""The canonical layout: the same commands, comments and suppressions, whatever the layout was before."""

from __future__ import annotations

import random
import re
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from written import respaced, specification

from ltlc.base.source import Source, Span
from ltlc.frontend.language import load_text
from ltlc.frontend.language.suppression import suppressions
from ltlc.frontend.layout import layout
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.parse import parse, parse_with_tokens

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("**/*.txt"))
FIXTURES = {
    path.relative_to(ROOT / "tests"): path.read_bytes().decode()
    for path in sorted((ROOT / "tests" / "fixtures").glob("*/*.txt"))
}


def laid_out(text: str) -> str:
    result = layout(Source("props.txt", text))
    assert isinstance(result, str), result
    return result


def bare(part: Any) -> Any:
    """A syntax tree without its places."""
    if isinstance(part, syntax.Node | syntax.SyntaxTree):
        return type(part), [bare(getattr(part, field.name)) for field in fields(part) if field.name != "span"]
    return [bare(each) for each in part] if isinstance(part, tuple) else part


def comments(text: str) -> list[str]:
    found = re.findall(r'"(?:[^"\\\n]|\\.)*"|(#[^\n]*)', text)
    return [comment.rstrip() for comment in found if comment]


def suppressed(source: Source, tree: syntax.SyntaxTree) -> list[tuple[str, set[int] | None]]:
    """The code of each suppression, with the numbers of the commands it is about; None for the whole file."""

    def lines(span: Span) -> set[int]:
        return set(range(source.position(span.start).line, source.position(span.end).line + 1))

    properties = [command.span for command in tree.commands if isinstance(command, syntax.PropertyCommand)]

    def commands(about: range | None) -> set[int] | None:
        return None if about is None else {n for n, c in enumerate(tree.commands) if lines(c.span) & set(about)}

    return [(each.code, commands(each.lines)) for each in suppressions(source, properties)]


def assert_the_same(text: str) -> None:
    """`text` says the same in the canonical layout, with the same comments, and has that layout then."""
    before, after = Source("props.txt", text), Source("props.txt", laid_out(text))
    (tree, problems), (new_tree, new_problems) = parse(before), parse(after)
    assert (problems, new_problems) == ([], [])
    assert bare(new_tree) == bare(tree)
    assert comments(after.text) == comments(text)
    assert suppressed(after, new_tree) == suppressed(before, tree)
    assert laid_out(after.text) == after.text


def parses(text: str) -> bool:
    return not parse(Source("props.txt", text))[1]


def test_the_page_shows_what_becomes_of_its_example() -> None:
    page = (ROOT / "docs" / "new.md").read_text(encoding="utf-8").partition("\n## Layout\n")[2]
    before, after = re.findall(r"^```\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    assert laid_out(before) == after


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_examples_have_the_canonical_layout(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert laid_out(text) == text


def test_the_fixtures_say_the_same_in_the_canonical_layout() -> None:
    texts = [text for text in FIXTURES.values() if parses(text)]
    assert len(texts) > 150
    for text in texts:
        assert_the_same(text)


@settings(max_examples=120)
@given(st.integers(0, 2**32).map(random.Random))
def test_a_text_of_the_grammar_says_the_same_in_the_canonical_layout(chance: random.Random) -> None:
    text = specification(chance)
    if parses(text):
        assert_the_same(text)


@settings(max_examples=50)
@given(st.sampled_from(sorted(FIXTURES)), st.integers(0, 2**32).map(random.Random))
def test_a_fixture_says_the_same_whatever_stands_between_its_tokens(path: Path, chance: random.Random) -> None:
    source = Source("props.txt", FIXTURES[path])
    _, tokens, problems = parse_with_tokens(source)
    text = respaced(chance, [source.text[token.span.start : token.span.end] for token in tokens])
    if not problems and parses(text):
        assert_the_same(text)


def meaning(text: str) -> Any:
    """What a specification states, without its places."""
    specification, _ = load_text(Source("props.txt", text))
    if specification is None:
        return None
    stated = [(p.property, [a.condition for a in p.atoms], p.names) for p in specification.properties]
    return stated, specification.rate, specification.timeout


def test_the_fixtures_mean_the_same_in_the_canonical_layout() -> None:
    meanings = {text: meaning(text) for text in FIXTURES.values()}
    understood = {text: found for text, found in meanings.items() if found is not None}
    assert len(understood) > 100
    for text, found in understood.items():
        assert meaning(laid_out(text)) == found


def test_blanks_and_line_breaks_are_in_one_way() -> None:
    text = """

decl a /a Float64.data


decl speed  /odom   Odometry.twist.twist.linear.x
_rate_=10
slow :never abs( speed )>2.0 and a=={ 0.1 }-1 near = @ { a , - 1 }-a*- 2<( a )
x: min(a,2)>1   
y: rate (a)>=2 Hz over 1 s
"""  # noqa: W291
    assert (
        laid_out(text)
        == """decl a /a Float64.data

decl speed /odom Odometry.twist.twist.linear.x
_rate_ = 10
slow: never abs(speed) > 2.0 and a =={0.1} -1
near = @{a, -1} - a * -2 < (a)
x: min(a, 2) > 1
y: rate(a) >= 2 Hz over 1 s
"""
    )


def test_what_follows_one_another_and_is_of_a_kind_stands_in_columns() -> None:
    text = """decl a /a Float64.data
decl speed /odom Odometry.twist.twist.linear.x
object x at (1, 2, 3)
object gate_1 /gate Odometry

a1 = a > 1
b = speed > 1
p: never a1
quick: never b
never a1 and b
"""
    assert (
        laid_out(text)
        == """decl a     /a    Float64.data
decl speed /odom Odometry.twist.twist.linear.x
object x      at (1, 2, 3)
object gate_1 /gate Odometry

a1 = a > 1
b  = speed > 1
p:     never a1
quick: never b
never a1 and b
"""
    )


def test_a_model_has_a_line_for_each_of_several_attributes() -> None:
    text = "model m: position /odom Odometry.pose.pose.position # where\n velocity /o Odometry.twist.twist ;"
    assert (
        laid_out(text)
        == """model m:
    position /odom Odometry.pose.pose.position  # where
    velocity /o    Odometry.twist.twist
    ;
"""
    )


def test_a_model_of_one_attribute_stands_on_one_line() -> None:
    assert laid_out("model m:\n  position\n/odom X.y;") == "model m: position /odom X.y ;\n"


def test_a_line_that_is_too_long_is_broken_at_the_outermost_place() -> None:
    parts = [f"robot_number_{n}.distance.some_stop_sign < {n}" for n in range(4)]
    text = f"stop: after_until {parts[0]}, {parts[1]} or {parts[2]} and {parts[0]} and {parts[1]}, always {parts[3]}"
    assert (
        laid_out(text)
        == f"""stop: after_until {parts[0]},
    {parts[1]}
        or {parts[2]}
            and {parts[0]}
            and {parts[1]},
    always {parts[3]}
"""
    )


def test_a_long_forall_is_broken_before_its_property() -> None:
    property_ = "always " + " and ".join(["r.velocity < 1"] * 5)
    text = f"forall r in {{a, b}}: forall s in {{c, d}}: {property_}"
    assert laid_out(text) == f"forall r in {{a, b}}: forall s in {{c, d}}:\n    {property_}\n"


def test_a_property_on_several_lines_is_joined_where_it_fits() -> None:
    assert laid_out("never\n  a > 1\n\n  and b") == "never a > 1 and b\n"


def test_a_comment_inside_a_property_keeps_its_place() -> None:
    text = "p: after_until near,# opens\n far,\n   # and then\nstopped # done\n"
    assert (
        laid_out(text)
        == """p: after_until near,  # opens
    far,
    # and then
    stopped  # done
"""
    )


def test_the_comments_behind_consecutive_lines_stand_in_a_column() -> None:
    assert laid_out("a = 1 # one\nbc = 23 # two\n\nd = 4 # four") == "a  = 1   # one\nbc = 23  # two\n\nd = 4  # four\n"


def test_what_is_an_error_only_on_its_line_stays_there() -> None:
    text = "always armed until landed, never fault\n"
    assert laid_out(text) == text


def test_commands_stay_on_a_line_of_which_a_finding_is_suppressed() -> None:
    text = "decl a /a Bool.data decl b /b Bool.data  # ltlc: ignore LTL104\n"
    assert laid_out(text) == text


def test_an_association_of_which_a_finding_is_suppressed_stays_on_its_line() -> None:
    text = f"a = {' and '.join(['robot.velocity == 0'] * 9)}  # ltlc: ignore LTL520\n"
    assert laid_out(text) == text


@pytest.mark.parametrize("line_break", ["\n", "\r\n"])
def test_line_breaks_stay_those_of_the_file(line_break: str) -> None:
    text = line_break.join(["# c", "never  a", "p: never b", ""])
    assert laid_out(text) == line_break.join(["# c", "never a", "p: never b", ""])


@pytest.mark.parametrize("text", ["", "\n \n", "\ufeff"[1:]])
def test_of_nothing_nothing_is_left(text: str) -> None:
    assert laid_out(text) == ""


def test_comments_alone_are_kept() -> None:
    assert laid_out("\n\n#a\n\n\n  # b") == "#a\n\n# b\n"


def test_what_is_wrong_with_the_syntax_is_returned() -> None:
    result = layout(Source("props.txt", "decl a /a Bool.data\nnever a &&"))
    assert isinstance(result, Sequence)
    assert not isinstance(result, str)
    assert [each.code for each in result] == ["LTL004", "LTL006"]
