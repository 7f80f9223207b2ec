"""A line in the words of others is answered with the line to write, which means the same unless a note says more."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable
from itertools import product
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from language_support import findings, marked
from published import DECLARED, relation
from stepping import session

from ltlc.base.fixes import with_fixes
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.frontend.syntax import phrasebook, phrases
from ltlc.semantics.verdicts import Verdict

NAMES = f"""{DECLARED}decl v /odom Odometry.twist.twist.linear.x
decl scan /scan LaserScan.ranges
decl far /far LaserScan.ranges
decl place /odom Odometry.pose.pose.position
zone yard = [(0, 0), (4, 0), (4, 3)]
"""

SAME = [
    ("p U q", "p U q", "until q, always p"),
    ("x: p U q", "p U q", "x: until q, always p"),
    ("p W q", "p W q", "(until q, always p) or always p"),
    ("p unless q", "p W q", "(until q, always p) or always p"),
    ("p R q", "p R q", "(until p and q, always q) or always q"),
    ("p releases q", "p R q", "(until p and q, always q) or always q"),
    ("always (p && q W r)", "G(p & (q W r))", None),
    ("always (p -> q U r)", "G(p -> (q U r))", "always (p implies (until r, always q))"),
    ("(p and q) U r", "(p & q) U r", "until r, always (p and q)"),
    ("(p until q)", "p U q", "(until q, always p)"),
    ("always p until q", "p U q", "until q, always p"),
    ("G (p -> q W r)", "G(p -> (q W r))", "always (p implies ((until r, always q) or always q))"),
    ("if p then q", "G(p -> q)", "always (p implies q)"),
    ("always if p then q", "G(p -> q)", "always (p implies q)"),
    ("whenever p, eventually q", "G(p -> F q)", "always (p implies eventually q)"),
    ("p causes q", "G(p -> F q)", "always (p implies eventually q)"),
    ("p leads to q", "G(p -> F q)", "always (p implies eventually q)"),
    ("p requires q", "!p W q", "always (p implies once q)"),
    ("p forbids q", "G(p -> G !q)", "always (p implies never q)"),
    ("no {p}", "G !p", "never p"),
    ("some {p}", "F p", "eventually p"),
    ("globally: no /r", "G !r", "never new r"),
    ("globally: some /r", "F r", "eventually new r"),
    ("globally: /r causes /s", "G(r -> F s)", "always (new r implies eventually new s)"),
    ("/r requires /s", "!r W s", "always (new r implies once new s)"),
    ("/r forbids /s", "G(r -> G !s)", "always (new r implies never new s)"),
    ("after /p: no /r", "G(p -> G !r)", "after new p, never new r"),
    ("until /q: no /r", "!r W q", "(never new r) or (until new q, never new r)"),
    ("until /q: some /r", "!q U r", "until new r, never new q"),
    ("until /q: /r causes /s", "(r -> (!q U s)) W q", None),
    ("before p, eventually q", "(!p U (q & !p)) | (G !p & F q)", None),
    ("the robot shall always satisfy r", "G r", "always r"),
    ("robot shall never satisfy r", "G !r", "never r"),
    ("the robot shall satisfy r", "F r", "eventually r"),
    ("the robot shall immediately satisfy r", "r", "initially r"),
    ("the robot shall until s satisfy r", "r W s", "(always r) or (until s, always r)"),
    ("the robot shall before s satisfy r", "!(!(r & !s) U s)", "(never s) or (until s, eventually r)"),
    ("whenever p the robot shall eventually satisfy r", "G(p -> F r)", None),
    ("upon p the robot shall eventually satisfy r", "G((!p & X p) -> X(F r)) & (p -> F r)", None),
    (
        "in m mode the robot shall eventually satisfy r",
        "G((!m & X m) -> X(!(m & X !m) U r)) & (m -> (!(m & X !m) U r))",
        "after_until m, not m, (eventually r)",
    ),
    ("never p;;", "G !p", "never p"),
    ("never p until q", "!p U q", "until q, never p"),
    ("never p unless q", "!p W q", "(until q, never p) or never p"),
    ("never p W q", "!p W q", "(until q, never p) or never p"),
    ("never p U q", "!p U q", "until q, never p"),
    ("[] p", "G p", "always p"),
    ("<> p", "F p", "eventually p"),
    ("F (p U q)", "F(p U q)", "eventually (until q, always p)"),
    ("□ p", "G p", "always p"),
    ("G !p", "G !p", "always not p"),
    ("F ~p", "F !p", "eventually not p"),
    ("G[0,inf] p", "G p", "always p"),
    ("F[0,∞) p", "F p", "eventually p"),
    ("AG p", "G p", "always p"),
    ("A[] p", "G p", "always p"),
    ("AF p", "F p", "eventually p"),
    ("AG (p -> AF q)", "G(p -> F q)", "always (p implies (eventually q))"),
    ("p ~> q", "G(p -> F q)", "always (p implies eventually q)"),
    ("p --> q", "G(p -> F q)", "always (p implies eventually q)"),
    ("assert property (p |-> q);", "G(p -> q)", "always (p implies q)"),
    ("assert (p |-> q)", "G(p -> q)", "always (p implies q)"),
    ("p |-> q", "G(p -> q)", "always (p implies q)"),
    ("always (p until! q)", "G(p U q)", "always (until q, always p)"),
    ("p precedes q", "!q W p", "always (q implies once p)"),
    ("at all times p", "G p", "always p"),
    ("p always", "G p", "always p"),
    ("p never", "G !p", "never p"),
    ("while p, q", "G(p -> q)", "always (p implies q)"),
    ("while p, never q", "G(p -> !q)", "after_until p, not p, never q"),
    ("never p while q", "G !(p & q)", "never (p and q)"),
    ("always p if q", "G(q -> p)", "always (q implies p)"),
    ("if p and q: r", "G(p & q -> r)", "always ((p and q) implies r)"),
    ("The robot shall never satisfy r", "G !r", "never r"),
]  # fmt: skip

OTHERS = [
    ("for each g of v, always v == g and p", "each g of v: always v == g and p"),
    ("each g in v: always v == g", "each g of v: always v == g"),
    ("for every new v, eventually p within 1 s", "each new v: eventually p within 1 s"),
    ("for each v: eventually p within 1 s", "each new v: eventually p within 1 s"),
    ("always scan[*] > 1", "always all(scan > 1)"),
    ("always rate(v) > 10 Hz", "always rate(v) >= 10 Hz over 1 s"),
    ("never any(scan > v over scan)", "never any(scan > v over (scan))"),
    ("never (any(scan < far over scan, far) and p)", "never (any(scan < far over (scan), (far)) and p)"),
    ("p S q", "p since q"),
    ("p until 3 s", "always p for 3 s"),
    ("p U[1,5] q", "(always p for 1 s) and (within [1 s, 5 s], until q, always p)"),
    ("always (v in [0, 1])", "always ((0 <= v and v <= 1))"),
    ("never v in 0..1", "never (0 <= v and v <= 1)"),
    ("when p the robot shall q", "always (p and not previously p implies (eventually q))"),
    ("always (v > 1 implies X q)", "always (@{v, -1} > 1 implies q)"),
    ("if v > .5, q", "always (v > 0.5 implies q)"),
    ("globally: /r causes /s within 2 s", "always (new r implies eventually new s within 2 s)"),
    ("globally: /odom {twist.twist.linear.x > 2} requires /s", "always ((new v and v > 2) implies once new s)"),
    ("p T q", "not (not p since not q)"),
    ("always (p implies X q)", "always (@{p, -1} implies q)"),
    ("G (v > 1 -> next q)", "always (@{v, -1} > 1 implies q)"),
    ("G_[0,10] p", "always p for 10 s"),
    ("F[0,2] p", "eventually p within 2 s"),
    ("eventually[0:2] p", "eventually p within 2 s"),
    ("F[1,4] p", "eventually p within [1 s, 4 s]"),
    ("G[1,4] p", "always p for [1 s, 4 s]"),
    ("O[0,4] p", "once p within 4 s"),
    ("H[0,4] p", "historically p for 4 s"),
    ("always (p implies F[0,5] (q or r))", "always (p implies (eventually (q or r) within 5 s))"),
    ("p U[0,5] q", "(until q, always p) and (eventually q within 5 s)"),
    ("p until[0,3] q", "(until q, always p) and (eventually q within 3 s)"),
    ("eventually p in 2 s", "eventually p within 2 s"),
    ("p in 2 s", "eventually p within 2 s"),
    ("always (q implies p in 2 s)", "always (q implies (eventually p within 2 s))"),
    ("never once p 4 times in 2 s", "never once p 4 times within 2 s"),
    ("never once p 4 within 2 s", "never once p 4 times within 2 s"),
    ("never p 4 times within 2 s", "never once p 4 times within 2 s"),
    ("never max(v over 2 s) > 1", "never once v > 1 within 2 s"),
    ("always rate(/odom) >= 10 Hz over 1 s", "always rate(v) >= 10 Hz over 1 s"),
    ("each g of v: always v[g] > 1", "each g of v: always v > 1"),
    ("never place in yard", "never inside(place, yard)"),
    ("always v between 0 and 1", "always (0 <= v and v <= 1)"),
    ("never |v| > 2", "never abs(v) > 2"),
    ("never v' > 2", "never (v - @{v, -1}) > 2"),
    ("never age(/scan) > 1 s", "never age(scan) > 1 s"),
    ("never min(scan < .3)", "never any(scan < 0.3)"),
    ("never max(scan > 3)", "never any(scan > 3)"),
    ("a: b: never p", "b: never p"),
    ("when p, q", "always (p implies q)"),
    ("after p until q, never r", "after_until p, q, never r"),
    ("between p and q, never r", "after_until p, q, never r"),
    ("after /p until /q: /r forbids /s", "after_until new p, new q, always (new r implies never new s)"),
    ("no /odom {twist.twist.linear.x > 2}", "never (new v and v > 2)"),
    ("some /r within 2 s", "eventually new r within 2 s"),
    ("the robot shall within 5 s satisfy r", "eventually r within 5 s"),
    ("the robot shall for 5 seconds satisfy r", "always r for 5 s"),
    ("always X p", "after once new p 2 times, always p"),
    ("G X v > 1", "after once new v 2 times, always v > 1"),
    ("X p", "after once new p 2 times, initially p"),
    ("G (p && X q)", "always (@{p, -1} and q)"),
    ("never max(v) over 5 s > 2", "never once v > 2 within 5 s"),
    ("always (p implies max(v) within 500 ms >= 2)", "always (p implies once v >= 2 within 500 ms)"),
    ("always max(v) over 5 s < 2", "always not once v >= 2 within 5 s"),
    ("always max(v) over 5 s <= 2", "always not once v > 2 within 5 s"),
    ("always min(v) over 5 s > 2", "always not once v <= 2 within 5 s"),
    ("always min(v) over 5 s >= -2.5", "always not once v < -2.5 within 5 s"),
    ("fast: never min(v) over 5 s < 2 and p", "fast: never once v < 2 within 5 s and p"),
    ("never mean(v) over 5 s > 2", "never mean(@{v, -49:}) > 2"),
    ("max(scan < 3)", "all(scan < 3)"),
    ("always min(scan > .3)", "always all(scan > 0.3)"),
    ("always (new /odom implies p)", "always (new v implies p)"),
    ("never /odom/twist/twist/linear/x > 1", "never v > 1"),
    ("p within [1, 3] s", "eventually p within [1 s, 3 s]"),
    ("eventually p within [100, 300] ms", "eventually p within [100 ms, 300 ms]"),
    ("never v % 2 == 1", "never mod(v, 2) == 1"),
    ("never p for more than 2 s", "never historically p for 2 s"),
    ("always p for at least 2 s", "always p for 2 s"),
    ("never v > 1,5", "never v > 1.5"),
    ("never v > 1 // too fast", "never v > 1  # too fast"),
    ("never (p or ~q) and ~r;", "never (p or not q) and not r"),
    ("p |=> q", "always (@{p, -1} implies q)"),
    ("EF p", "eventually p"),
    ("every 2 s p", "always eventually p within 2 s"),
    ("new scan at least every 500 ms", "always eventually new scan within 500 ms"),
    ("if p then q within 2 s", "always (p implies eventually q within 2 s)"),
    ("when p, q within 2 seconds", "always (p implies eventually q within 2 s)"),
    ("eventually p within 2 s when q", "always (q implies eventually p within 2 s)"),
    ("v must not exceed 2", "never v > 2"),
    ("v should always be below 2", "always v < 2"),
    ("always v is less than 2", "always v < 2"),
    ("always v is below 2", "always v < 2"),
    ("never v exceeds 2", "never v > 2"),
    ("never v is more than 2", "never v > 2"),
    ("never v is above 2", "never v > 2"),
    ("always v is at most 2", "always v <= 2"),
    ("always v is at least 2", "always v >= 2"),
    ("never v is equal to 2", "never v == 2"),
    ("never v equals 2", "never v == 2"),
    ("eventually p at least 3 times", "eventually once p 3 times"),
    ("p -> F[0,2] q", "always (p implies (eventually q within 2 s))"),
    ("F[0,500ms] p", "eventually p within 500 ms"),
    ("G_[1s, 3s] p", "always p for [1 s, 3 s]"),
]


def answer(line: str) -> tuple[str, str]:
    """The line that is offered, and its note."""
    text = NAMES + line + "\n"
    [found] = [each for each in findings(text) if each.code not in ("LTL104", "LTL306")]
    [fix] = found.fixes
    assert (found.code, marked(found)) == ("LTL021", line)
    return with_fixes(text, [fix]).removeprefix(NAMES).rstrip("\n"), found.help.partition("; note: ")[2]


@pytest.mark.parametrize(("line", "formula", "written"), SAME, ids=[each[0] for each in SAME])
def test_what_is_offered_without_a_note_means_the_same(line: str, formula: str, written: str | None) -> None:
    offered, note = answer(line)
    assert note == ""
    assert written in (None, offered)
    messages = frozenset("pqrs") if "/" in line else frozenset[str]()
    assert relation(formula, offered, messages) == "the same"


@pytest.mark.parametrize(("line", "written"), OTHERS, ids=[each[0] for each in OTHERS])
def test_what_is_offered_is_in_the_names_and_numbers_of_the_file_and_accepted(line: str, written: str) -> None:
    offered, _ = answer(line)
    assert offered == written
    specification, diagnostics = load_text(Source("props.txt", f"{NAMES}{offered}\n"))
    assert specification is not None, [each.message for each in diagnostics]


@pytest.mark.parametrize(
    "line",
    [
        "p && q W r",
        "F[1,4] p",
        "G[1,4] p",
        "F[0,2] p",
        "always (p implies X q)",
        "never v' > 2",
        "when p, q",
        "X p",
        "always scan[*] > 1",
        "never any(scan < far over scan, far)",
        "always rate(v) > 10 Hz",
        "for each v: eventually p",
    ],
)
def test_a_note_says_where_what_is_offered_differs(line: str) -> None:
    assert answer(line)[1]


V = "decl v /v Float64.data\n"
OPERATORS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}


@settings(max_examples=20, deadline=None)
@given(
    extreme=st.sampled_from([min, max]),
    relation_=st.sampled_from(sorted(OPERATORS)),
    messages=st.lists(st.tuples(st.integers(1, 7), st.integers(0, 2)), min_size=1, max_size=6),
    further=st.integers(0, 6),
)
def test_a_window_of_time_is_offered_as_what_it_is_at_every_nanosecond(
    extreme: Callable[[Iterable[int]], int], relation_: str, messages: list[tuple[int, int]], further: int
) -> None:
    offered, _ = answer(f"always {extreme.__name__}(v) over 4 ns {relation_} 1")
    live, times = session(V + offered), [sum(gap for gap, _ in messages[: n + 1]) for n in range(len(messages))]
    for time, (_, value) in zip(times, messages, strict=True):
        live.samples(time, ("v",), (float(value),))
    live.advance(times[-1] + further)
    held = [*zip(times, times[1:], messages, strict=False), (times[-1], times[-1] + further, messages[-1])]
    within = (
        extreme(
            value for begin, end, (_, value) in held if (begin < now or (begin == now and is_after)) and end > now - 5
        )
        for now in range(times[0], times[-1] + further + 1)
        for is_after in ((True,) if now == times[0] else (False, True))  # at a message, what was held comes before it
    )
    assert (live.tracks[0].verdict is Verdict.VIOLATED) == (not all(OPERATORS[relation_](value, 1) for value in within))


@pytest.mark.parametrize(("line", "first"), [("always X p", None), ("X p", 2)])
def test_the_next_step_is_offered_as_the_next_message(line: str, first: int | None) -> None:
    for values in product([False, True], repeat=4):
        live = session(f"decl p /p Bool.data\n{answer(line)[0]}\n")
        for time, value in enumerate(values):
            live.samples(time, ("p",), (value,))
        assert (live.tracks[0].verdict is Verdict.VIOLATED) == (not all(values[1:first]))


@pytest.mark.parametrize(
    ("line", "written"),
    [
        ("decl w /w nav_msgs::Odometry.twist.twist.linear.x", "decl w /w nav_msgs/Odometry.twist.twist.linear.x"),
        ("decl w /w nav_msgs::msg::Odometry.twist.twist.linear.x", "decl w /w nav_msgs/Odometry.twist.twist.linear.x"),
        ("decl w /w Odometry twist.twist.linear.x", "decl w /w Odometry.twist.twist.linear.x"),
        ("w = /odom.pose.pose.position.x", "decl w /odom Odometry.pose.pose.position.x"),
        ("w = /imu Imu.angular_velocity.z", "decl w /imu Imu.angular_velocity.z"),
        ("decl w odom/pose/pose/position/x", "decl w odom Odometry.pose.pose.position.x"),
        ("decl w /odom Odometry pose/pose/position/x", "decl w /odom Odometry.pose.pose.position.x"),
        ("decl w std_msgs/Float64 /w.data", "decl w /w std_msgs/Float64.data"),
        ("decl w Odometry.pose.pose.position.x /odom", "decl w /odom Odometry.pose.pose.position.x"),
        (
            "decl scans sensor_msgs/msg/LaserScan /scan.ranges[0]",
            "decl scans /scan sensor_msgs/msg/LaserScan.ranges[0]",
        ),
        ("decl w Odometry /odom", "decl w /odom Odometry"),
    ],
)
def test_a_declaration_in_another_spelling_is_answered(line: str, written: str) -> None:
    assert answer(line)[0] == written


GUARDS = [
    ("guard /c_raw /c else stop", "guard /c_raw to /c else stop"),
    ("guard /c_raw -> /c", "guard /c_raw to /c"),
    ("guard /c from /c_raw", "guard /c_raw to /c"),
    ("guard /c_raw to /c otherwise stop", "guard /c_raw to /c else stop"),
    ("guard /c_raw to /c, stop", "guard /c_raw to /c else stop"),
    ("guard /c_raw to /c else stop or crawl", "guard /c_raw to /c else stop, crawl"),
    ("guard /c_raw to /c else stop crawl", "guard /c_raw to /c else stop, crawl"),
    ("message stop: {data: 0}", "message stop {data: 0}"),
    ("message stop = {data: 0}", "message stop {data: 0}"),
    ("assume that always p", "assume always p"),
    ("a: assume always p", "assume a: always p"),
]


@pytest.mark.parametrize(("line", "written"), GUARDS)
def test_a_guard_in_other_words_is_answered(line: str, written: str) -> None:
    assert answer(line)[0] == written


def test_the_page_shows_the_answers() -> None:
    page = (Path(__file__).parents[1] / "docs" / "patterns.md").read_text(encoding="utf-8")
    _, _, table = page.partition("| written | answer |\n|---|---|\n")
    rows = re.findall(r"^\| `(.*)` \| `(.*)` \|$", table.partition("\n\n")[0].replace("\\|", "|"), re.MULTILINE)
    assert len(rows) > 10
    assert [answer(line)[0] for line, _ in rows] == [written for _, written in rows]


def test_each_phrase_is_tried_here() -> None:
    lines = [each[0] for each in SAME] + [each[0] for each in OTHERS] + [each[0] for each in GUARDS]
    lines += [
        "decl w /w a::B.c",
        "decl w /w B c",
        "w = /odom.a",
        "w = /imu Imu.a",
        "decl w /odom/a/b",
        "decl w /w B a/b",
        "zone z = (0, 0), (4, 0), (4, 3)",
        "decl w B /w.a",
    ]
    untried = [
        phrase.pattern
        for phrase in phrasebook.PHRASES
        if all(phrases.meant(line, NAMES, lambda _: True) == _without(phrase, line) for line in lines)
    ]
    assert untried == []


def _without(phrase: phrasebook.Phrase, line: str) -> phrases.Meant | None:
    """What `line` would mean if nobody knew `phrase`."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(phrases, "PHRASES", tuple(each for each in phrasebook.PHRASES if each is not phrase))
        return phrases.meant(line, NAMES, lambda _: True)


def test_the_lines_around_are_read_as_if_it_were_not_there() -> None:
    text = f"{NAMES}a: never p\nif p then q\nnever q and\n  r\np U q  # why\nb: never r s\n"
    assert [each.code for each in findings(text) if each.code != "LTL104"] == ["LTL021", "LTL021", "LTL019"]


def test_an_each_without_a_key_is_answered_with_its_forms() -> None:
    (found,) = (each for each in findings(f"{NAMES}l: each v: eventually p\n") if each.code == "LTL101")
    assert found.help.startswith("write `each NAME of KEY: P`")


def test_a_line_that_is_only_wrong_is_no_foreign_phrase() -> None:
    for line in ("never p q", "never (p", "always p for", "p q r", "never p and"):
        assert "LTL021" not in [each.code for each in findings(f"{NAMES}{line}\n")]


@pytest.mark.parametrize("part", ["(a", "a)(", "(a)", "a U ", "|a", "if a then ", "/a {b} causes ", "in 2 s ", ". 3"])
def test_no_line_takes_long(part: str) -> None:
    for line in ((part * 200)[:200], f"never {part * 40}"[:200]):
        phrases.meant(line, NAMES, lambda _: False)
