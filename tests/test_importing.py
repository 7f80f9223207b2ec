"""Files of other tools: what is read of each form, what it becomes, and whether that is shown to be the same."""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path

import fretish_by_definition as fretish
import pytest
from effort import some_of

from ltlc.base.limits import Budget
from ltlc.base.source import Source, Span
from ltlc.frontend.language import load_text
from ltlc.importing.conversion import Imported, convert
from ltlc.importing.document import document, rate
from ltlc.importing.forms import FORMS, form_of, measure_of
from ltlc.importing.names import Signals
from ltlc.importing.requirement import UnusableFileError
from ltlc.importing.showing import Shown
from ltlc.importing.writing import Reading
from ltlc.interfaces.commands.import_ import read


def imported(key: str, text: str, step: int | None = 0) -> tuple[list[Imported], str]:
    """What is imported of a file of this form, and the specification; `step` 0 is the usual reading of the form."""
    form, signals = FORMS[key], Signals()
    reading = Reading((10**9 if form.reading == "points" else None) if step == 0 else step)
    found = convert(read(Source(f"x.{key}", text), form, signals, reading), signals, reading, Budget())
    return found, document(found, signals, reading, form.name, f"x.{key}")


def said(key: str, text: str, step: int | None = 0) -> list[str]:
    """The properties of a file, each of which must be shown equal if it has a formula."""
    found, specification = imported(key, text, step)
    for each in found:
        assert each.text, each.problem
        assert each.requirement.meaning is None or (each.shown is not None and each.shown.is_equal), each
    _, diagnostics = load_text(Source("imported.ltlc", specification))
    assert not [d for d in diagnostics if d.code not in {"LTL520", "LTL604"}], specification
    return [each.text for each in found]


def problems(key: str, text: str, step: int | None = 0) -> list[str]:
    return [each.problem for each in imported(key, text, step)[0]]


def fret(*requirements: tuple[str, str], **variables: str) -> str:
    """An export of FRET: sentences with their formulas of the future, which may be missing."""
    entries = [
        {"reqid": f"R-{n}", "fulltext": sentence, "semantics": {"ftExpanded": formula} if formula else {}}
        for n, (sentence, formula) in enumerate(requirements)
    ]
    typed = [{"variable_name": name, "dataType": kind} for name, kind in variables.items()]
    return json.dumps({"requirements": entries, "variables": typed})


FRETISH = {
    "always": ("The robot shall always satisfy ready", "(LAST V ready)", "always ready"),
    "upon, immediately": (
        "Upon go the robot shall immediately satisfy lamp.",
        "((LAST V (((! go) & ((! LAST) & (X go))) -> (X lamp))) & (go -> lamp))",
        "always (go and not @{go, -1 else false} implies lamp)",
    ),
    "upon, eventually": (
        "Upon go the robot shall satisfy lamp",
        "((LAST V (((! go) & ((! LAST) & (X go))) -> (X ((! LAST) U lamp)))) & (go -> ((! LAST) U lamp)))",
        "always (go and not @{go, -1 else false} implies (eventually lamp))",
    ),
    "upon, within": (
        "Upon go the robot shall within 3 seconds satisfy lamp",
        "((LAST V (((! go) & ((! LAST) & (X go))) -> (X ((F[<=3] lamp) | (F[<3] LAST))))) "
        "& (go -> ((F[<=3] lamp) | (F[<3] LAST))))",
        "always (go and not @{go, -1 else false} implies eventually lamp within 3 s)",
    ),
    "for": (
        "The robot shall for 200 ticks satisfy (level < 3.5)",
        "((G[<=200] (level < 3.5)) | (LAST V (level < 3.5)))",
        "always level < 3.5 for 200 s",
    ),
    "in a mode, immediately": (
        "In m mode the robot shall immediately satisfy lamp",
        "((LAST V ((! ((((! m) & (! LAST)) & (X m)) & (! LAST))) | (X lamp))) & (m -> lamp))",
        "always (m and not @{m, -1 else false} implies lamp)",
    ),
    "after a mode, for": (
        "after m whenever go the robot shall for 4 ticks satisfy lamp",
        "(((! (m & (LAST | (X (! m))))) U ((m & (LAST | (X (! m)))) & (X (LAST V (go -> (G[<=4] lamp)))))) "
        "| (LAST V (! (m & (LAST | (X (! m)))))))",
        "always (once (not m and @{m, -1 else false}) and go implies always lamp for 4 s)",
    ),
    "until, of an older export with marks": (
        "when go if (level > 3) Controller shall until done satisfy lamp",
        "((LAST V (((! <b><i>(go & (level > 3))</i></b>) & ((! LAST) & (X <b><i>(go & (level > 3))</i></b>))) -> "
        "(X ((done V (lamp | done)) | (LAST V lamp))))) & (<b><i>(go & (level > 3))</i></b> -> "
        "((done V (lamp | done)) | (LAST V lamp))))",
        "always (not done since (go and level > 3 and not @{go and level > 3, -1 else false} and not done) "
        "implies lamp)",
    ),
    "in a mode, at its last position": (
        "in mode m the robot shall at the last timepoint satisfy lamp",
        "((LAST V ((! ((((! m) & (! LAST)) & (X m)) & (! LAST))) | (X (((m & (LAST | (X (! m)))) | LAST) V (((m & "
        "(LAST | (X (! m)))) | LAST) -> lamp))))) & (m -> (((m & (LAST | (X (! m)))) | LAST) V (((m & (LAST | "
        "(X (! m)))) | LAST) -> lamp))))",
        "always (not m and @{m, -1 else false} implies @{lamp, -1 else false})",
    ),
    "without a formula": (
        "Unless m is false or if go the tall robot shall at the next timepoint satisfy if lamp then level = 3",
        "",
        "always (@{m or go, -1 else false} and not @{m or go, -2 else false} and lamp implies level == 3)",
    ),
}


@pytest.mark.parametrize(("sentence", "formula", "expected"), FRETISH.values(), ids=list(FRETISH))
def test_a_sentence_of_fret_is_shown_equal_to_the_formula_that_fret_has_for_it(
    sentence: str, formula: str, expected: str
) -> None:
    assert said("fret", fret((sentence, formula))) == [expected]


@pytest.mark.parametrize("timing", fretish.TIMINGS)
def test_a_timing_of_fret_means_what_fret_publishes_in_each_scope_and_with_each_condition(timing: str) -> None:
    number = list(fretish.TIMINGS).index(timing)
    for scope, condition in some_of(product(fretish.SCOPES, fretish.CONDITIONS), number):
        if timing == "after" and scope.startswith("only"):
            continue  # takes longer to compare, and nobody is known to write it
        parts = (scope, condition, timing)
        (found,), _ = imported("fret", fret((fretish.sentence(*parts), fretish.formula(*parts))))
        assert found.shown is not None, found
        assert found.shown.is_equal, found


def test_a_unit_of_fret_that_it_does_not_count_is_told() -> None:
    sentence = "the robot shall within 5 minutes satisfy lamp"
    (found,), _ = imported("fret", fret((sentence, "((F[<=5] lamp) | (F[<5] LAST))")))
    assert found.text == "eventually lamp within 5 s"
    assert found.requirement.notes == ("FRET counts `5 minutes` as 5 positions",)
    (seconds,), _ = imported("fret", fret((sentence.replace("minutes", "seconds"), "")))
    assert not [note for note in seconds.requirement.notes if "counts" in note]


def test_a_formula_of_fret_that_does_not_say_what_its_sentence_says_is_told() -> None:
    (found,), text = imported("fret", fret(("the robot shall always satisfy (a | b) = c", "(LAST V (a | b))")))
    assert found.shown is not None
    assert not found.shown.is_equal
    assert "Not equal: only the formula of FRET accepts `({" in text


def test_conditions_are_compared_with_what_is_known_of_the_numbers_in_them() -> None:
    def relation(high: str) -> Shown | None:
        formula = f"((LAST V (((! {high}) & ((! LAST) & (X {high}))) -> (X lamp))) & ({high} -> lamp))"
        sentence = "upon level > 5 if level > 7 the robot shall immediately satisfy lamp"
        return imported("fret", fret((sentence, formula)))[0][0].shown

    assert relation("(level > 7)") == Shown()
    other = relation("(level > 5)")
    assert other is not None
    assert other.property_only == "({level > 5}) for ever"
    assert other.formula_only == "{lamp, level > 5}; {level > 5, level > 7}; ({level > 5, level > 7}) for ever"


def test_a_condition_that_only_the_formula_reads_is_one_of_the_same_numbers() -> None:
    text = fret(("The tank shall always satisfy level > 5", "(LAST V ((level > 7) | (level > 5)))"), level="double")
    assert said("fret", text) == ["always level > 5"]


def test_fret_excuses_what_is_open_at_the_end() -> None:
    (found,), text = imported("fret", fret(FRETISH["upon, within"][:2]))
    assert found.shown is not None
    assert found.shown.finite
    assert "of runs that end, only the formula of FRET accepts `{go}`" in " ".join(text.split())


def test_types_of_fret_are_those_of_its_variables() -> None:
    _, text = imported(
        "fret", fret(("The robot shall always satisfy n = k", "(LAST V (n = k))"), n="integer", k="integer")
    )
    assert "decl n /n std_msgs/Int64.data" in text


def test_variables_of_fret_that_have_a_value_are_definitions() -> None:
    document_ = json.loads(fret(("In landing the robot shall always satisfy mode = idle & speed < top", "")))
    document_["variables"] = [
        {"variable_name": "idle", "dataType": "integer", "idType": "Internal", "assignment": "3"},
        {"variable_name": "top", "dataType": "double", "assignment": "2.5 * idle"},
        {"variable_name": "landing", "dataType": "boolean", "modeRequirement": "gear and not (speed > 9.0)"},
        {"variable_name": "speed", "dataType": "double", "assignment": "pre (speed) + 1.0"},
    ]
    text = json.dumps(document_)
    assert said("fret", text) == ["always (landing implies mode == idle and speed < top)"]
    _, specification = imported("fret", text)
    assert "idle    = 3\ntop     = 2.5 * idle\nlanding = gear and not speed > 9.0\n" in specification
    assert "decl speed /speed std_msgs/Float64.data\n" in specification


def test_the_id_sentence_and_rationale_of_fret_are_those_of_the_property() -> None:
    entry = {
        "reqid": 'A "1"',
        "fulltext": "the lamp shall always satisfy on",
        "rationale": "nobody sees  it otherwise",
        "semantics": {"ftExpanded": "(LAST V on)"},
    }
    _, text = imported("fret", json.dumps([entry]))
    assert "## the lamp shall always satisfy on\n" in text
    assert '[id "A \\"1\\"", rationale "nobody sees it otherwise"]' in text
    specification, _ = load_text(Source("x", text))
    assert specification is not None
    (property_,) = specification.properties
    assert property_.requirement is not None
    assert property_.requirement.id == 'A "1"'


C2PO = """-- a power supply
STRUCT
    Cell: { volt: float; on: bool; };
ENUM
    Mode: { Idle: 0, Run: 2 };
INPUT
    a, b: bool;
    v, w: float;
    m: Mode;
    xs: int[3];
DEFINE
    low := v <= 4.0;
    steady := abs(v - prev(22.0, v)) < 1.0;
    one := Cell(v, a);
    two := Cell(w, b);
FTSPEC
"""

C2PO_SAID = {
    "a -> (low && b)": "always (a implies low and b)",
    "!G[0,2]!(steady)": "always eventually steady within 2 s",
    "a -> F[0,140] low": "always (a implies eventually low within 140 s)",
    "a -> F[3,7] b": "always (@{a, -3 else false} implies eventually b within 4 s)",
    "a U[0,2] b": "(always (until b, always a)) and (always eventually b within 2 s)",
    "G[3,7325] (a -> b)": "after @{a or not a, -3 else false}, always (a implies b)",
    "foreach(x: xs)(x > 5)": "always (xs_0 > 5 and xs_1 > 5 and xs_2 > 5)",
    "forsome(x: xs[0..1])(x >= 4)": "always (xs_0 >= 4 or xs_1 >= 4)",
    "foratmost(c: {one, two}, 1)(c.on)": "never (a and b)",
    "one.volt > two.volt": "always v > w",
    "m == Run": "always m == 2",
    "a => F[0,2] b": "always (a implies eventually b within 2 s)",
    "a -> b -> a": "always ((a implies b) implies a)",
    "prev(true, a)": "never @{not a, -1 else false}",
    "rate(v) > 0.5": "always v - @{v, -1 else 0} > 0.5",
    "2.0 * rate(v) > w": "always 2.0 * (v - @{v, -1 else 0}) > w",
    "a ? b : low": "always ((a implies b) and (a or low))",
    "(a ? v : w) > 3.5": "always ((a implies v > 3.5) and (a or w > 3.5))",
}


@pytest.mark.parametrize(("formula", "expected"), C2PO_SAID.items(), ids=list(C2PO_SAID))
def test_a_specification_of_c2po_holds_at_every_position(formula: str, expected: str) -> None:
    assert said("c2po", f"{C2PO}    s: {formula};") == [expected]


def test_the_past_of_c2po_is_said() -> None:
    text = C2PO.replace("FTSPEC", "PTSPEC") + "p: a S[0,2] b; H[1,3] a; O[2] a -> b;"
    assert said("c2po", text) == [
        "always (a since b within 2 s)",
        "never once @{not a, -1 else false} within 2 s",
        "always (once a within 2 s implies b)",
    ]


def test_definitions_of_c2po_keep_their_names() -> None:
    assert "steady = abs(v - @{v, -1 else 22.0}) < 1.0\n" in imported("c2po", f"{C2PO} steady;")[1]


def test_atoms_of_c2po_are_definitions() -> None:
    text = "INPUT b: bool; v: float;\nATOMIC fast := v > 1.0; on := b == true;\nFTSPEC fast; on;"
    assert said("c2po", text) == ["always fast", "always on"]
    assert "fast = v > 1.0\n" in imported("c2po", text)[1]


def test_lines_of_formulas_are_specifications_of_c2po() -> None:
    assert said("c2po", "a0 -> G[0,5] a1\n# nothing\na1;\n") == [
        "always (a0 implies always a1 for 5 s)",
        "always a1",
    ]


SMV = """MODULE main
VAR
  mode : {idle, busy};
  a : boolean; b : boolean;
  n : 0..5;
DEFINE full := n = 5;
ASSIGN next(a) := !a;
"""

SMV_SAID = {
    "LTLSPEC G (a -> F full)": "always (a implies (eventually n == 5))",
    "LTLSPEC NAME busy_1 := G (mode = busy -> X (a | n > 3));": (
        'always (@{mode == "busy", -1 else false} implies a or n > 3)'
    ),
    "LTLSPEC a U b -- until": "until b, always a",
    "INVARSPEC n <= 5;": "always n <= 5",
    "LTLSPEC G F a -> G F b": "(eventually (never a)) or (always (eventually b))",
    "LTLSPEC G (a <-> b -> a)": "always ((a implies b) and (b implies a) implies a)",
    "LTLSPEC a = b": "initially ((a implies b) and (b implies a))",
    "LTLSPEC G ((!a & X a) -> X b)": "always (@{not a, -1 else false} and a implies b)",
}


@pytest.mark.parametrize(("formula", "expected"), SMV_SAID.items(), ids=list(SMV_SAID))
def test_an_ltlspec_of_nusmv_is_judged_at_the_first_position(formula: str, expected: str) -> None:
    assert said("smv", SMV + formula) == [expected]


STL = """specification limits
  float v
  input float w
  const float most = 2.5
  gap = v - w;
"""

STL_SAID = {
    "out = always(gap > most -> eventually[0:500ms] (w >= 3))": (
        "always (v - w > 2.5 implies eventually w >= 3 within 500 ms)"
    ),
    "always[2:10] (v < 3)": "always v < 3 for [2 s, 10 s]",
    "not v > 3 since[0:2 s] w < 1": "always (not v > 3 since w < 1 within 2 s)",
    "eventually[0:3](v > 1 and w > 1)": "eventually (v > 1 and w > 1) within 3 s",
    "v > 1 until[0:5] w > 1": "(until w > 1, always v > 1) and (eventually w > 1 within 5 s)",
}


@pytest.mark.parametrize(("formula", "expected"), STL_SAID.items(), ids=list(STL_SAID))
def test_signal_temporal_logic_of_rtamt_is_said_over_signals(formula: str, expected: str) -> None:
    assert said("stl", STL + formula)[-1] == expected


def test_what_rtamt_calls_by_a_name_is_put_in_its_place() -> None:
    assert said("stl", "a = v > 1\nb = w > 1\nalways (a implies b)") == ["always (v > 1 implies w > 1)"]


def test_predicates_of_reelay_stand_in_braces() -> None:
    text = 'x: once[0:18]{speed > 8} -> {door: "open"}\ny: {lamp} since {speed < 1, lamp}\n'
    assert said("stl", text) == [
        'always (once (speed > 8) within 18 s implies door == "open")',
        "always (lamp since (speed < 1 and lamp))",
    ]


def test_the_past_ends_earlier_at_points_only() -> None:
    text = "a: once[2:5]{speed > 8}"
    assert said("stl", text, 10**9) == ["always once @{speed > 8, -2 else false} within 3 s"]
    assert "--reading points" in problems("stl", text)[0]


HPL_SAID = {
    "globally: no /laser {not data in [0 to 127]}": "never (new laser and not (0 <= laser_data and laser_data <= 127))",
    "globally: some /b within 100 ms": "eventually new b within 100 ms",
    "globally: /a {data > 0} causes /b within 1 s": (
        "always (new a and a_data > 0 implies eventually new b within 1 s)"
    ),
    "globally: /b requires (/a or /c) within 2 s": "always (new b implies once (new a or new c) within 2 s)",
    "globally: /a forbids /b": "always (new a implies (never new b))",
    "globally: /a forbids /b within 5 s": "always (new a implies never new b within 5 s)",
    "after /a: no /b": "after new a, never new b",
    "after /b: no /b": "after (previously (new b)), never new b",
    "until /q: no /b": "(never new b) or (until new q, never new b)",
    "until /q: some /b": "until new b, never new q",
    "after /a until /q: no /b": "after new a, (never new b) or (until new q, never new b)",
    "until /q: /a causes /b": "always (new a and historically (not new q) implies (until new b, never new q))",
    "globally: no /b {forall i in [0 to 3]: xs[@i] > 0}": "never (new b and all(b_xs[0:4] > 0))",
    "globally: no /b {state = PRESSED}": "never (new b and b_state == PRESSED)",
    "globally: no ~b {len(xs) > 3}": "never (new b and len(b_xs) > 3)",
    "globally: no /b {exists i in markers: markers[@i].type in {1, 9}}": (
        "never (new b and any(b_markers_type == 1 or b_markers_type == 9))"
    ),
    "globally: no /b {exists x in xs: @x**2 > 4}": "never (new b and any(b_xs * b_xs > 4))",
    "after /a as A: no /b {data > @A.data}": "after new a, never (new b and b_data > @{a_data, opening})",
    "globally: /a as A {ok} causes /b {id = @A.id} within 2 s": (
        "each new a: (initially (a_ok)) implies (eventually (new b and b_id == @{a_id, opening}) within 2 s)"
    ),
}


@pytest.mark.parametrize(("property_", "expected"), HPL_SAID.items(), ids=list(HPL_SAID))
def test_a_property_of_hpl_is_said_of_messages(property_: str, expected: str) -> None:
    assert said("hpl", property_) == [expected]


def test_properties_of_hpl_have_the_types_that_their_fields_belong_to() -> None:
    _, text = imported("hpl", "globally: no /cmd_vel {linear.x > 1.5 and angular.z < 0}")
    assert "/cmd_vel geometry_msgs/Twist.linear.x\n" in text
    assert "/cmd_vel geometry_msgs/Twist.angular.z\n" in text


def test_comments_of_hpl_are_the_id_and_the_text() -> None:
    text = '# id: p1\n# title: "Stops"\nglobally: no /a\n\n# id: p2\nafter /a\nuntil /q: some /b\n'
    found, written = imported("hpl", text)
    assert [each.requirement.id for each in found] == ["p1", "p2"]
    assert "## Stops\n" in written


def test_a_misspelled_property_of_hpl_leaves_the_one_before_it() -> None:
    found, _ = imported("hpl", "after /a\n  until /q: no /b\nglobaly: no /x\nglobally: no /c\n")
    assert [bool(each.text) for each in found] == [True, False, True]
    assert found[1].problem == "`globally` is expected in `globaly: no /x`"
    assert found[1].requirement.place == Span(27, 41)


def test_that_ticks_have_passed_has_a_name() -> None:
    _, text = imported("c2po", "INPUT a, b: bool;\nFTSPEC F[2,3] a; G[2,9] b; F[3,4] a;")
    assert "passed_2 = @{a or not a, -2 else false} # there was a tick so many ticks ago" in " ".join(text.split())
    assert "always (passed_2 implies eventually a within 1 s)\n" in text
    assert "after passed_2_2, always b\n" in text
    assert "always (passed_3 implies" in text
    specification, _ = load_text(Source("x", text))
    assert specification is not None
    assert len(specification.properties) == 3


def test_an_answer_that_is_the_question_itself_is_none() -> None:
    (found,), _ = imported("hpl", "globally: /b requires /b {ok}")
    assert found.text == "always (new b implies (previously (once (new b and b_ok))))"
    assert found.shown is not None
    assert found.shown.is_equal


TABLE = """id,description,formula
R1,Stops for people,"G(near -> F[0,2] stopped)"
R2,No speeding,never speed > 2
R3,A start first,"globally: /cmd_vel {linear.x > 0} requires /start within 5 s"
R4,In time,if near then stopped within 300 ms
R5,Ready,the robot shall always satisfy ready
"""


def test_a_table_has_formulas_properties_and_phrases() -> None:
    assert said("csv", TABLE) == [
        "always (near implies eventually stopped within 2 s)",
        "never speed > 2",
        "always (new cmd_vel and cmd_vel_linear_x > 0 implies once (new start) within 5 s)",
        "always (near implies eventually stopped within 300 ms)",
        "always ready",
    ]


PROBLEMS = {
    "a malformed formula": ("smv", "G (a ->", "the formula ends where a condition or a value is expected"),
    "an unknown sign": ("smv", "G a @ b", "`@` is not expected here"),
    "an until in an until": ("smv", "p U (q U r)", "the parts of an `until`"),
    "no formula": ("csv", "id,formula\na,\n", "it has no formula"),
    "a comma without quotes": ("csv", "id,formula\na,G(p -> F[0,2] q)\n", "double quotes"),
    "a sentence that is not FRETish": (
        "fret",
        json.dumps([{"reqid": "a", "fulltext": "be good"}]),
        "FRETish is expected: ",
    ),
    "an index that ends": ("smv", "G a[", "the formula ends where `]` is expected"),
    "a slice that ends": ("c2po", "INPUT a: bool[2];\nFTSPEC a[1..", "a slice has numbers"),
    "a value": ("smv", "G (n + 1)", "is a value where a condition is expected"),
    "a bound between positions": ("smv", "F[0,1.5] p", "it is a whole number"),
    "an interval backwards": ("smv", "F[5,2] p", "ends before it begins"),
    "an unknown unit": ("stl", "eventually[0:5 parsec] p", "there is no unit `parsec`"),
    "an earlier message": ("hpl", "globally: /b as B requires /a {x < @B.x}", "values of an earlier message"),
    "a message that nobody names": ("hpl", "globally: no /a {x < @B.x}", "`@B` is no message"),
    "the number of a position": ("c2po", "INPUT a: bool;\nFTSPEC TAU > 3;", "`TAU`"),
    "a probability of C2PO": ("c2po", "INPUT a: bool;\nFTSPEC P_0.87 (F[0,3] a) with d = -5;", "`P_0.87`"),
    "a probability of FRET": (
        "fret",
        json.dumps([{"reqid": "a", "fulltext": "the robot shall with probability > 0.9 eventually satisfy lamp"}]),
        "a probability is not decided by one run",
    ),
    "a count in a scope of FRET": (
        "fret",
        json.dumps([{"reqid": "a", "fulltext": "in m the robot shall always satisfy occurred(3, lamp)"}]),
        "`occurred` and `persisted` in a scope",
    ),
    "half a predicate of FRET": (
        "fret",
        json.dumps([{"reqid": "a", "fulltext": "the robot shall always satisfy occurred(lamp)"}]),
        "`occurred` needs a number of positions",
    ),
    "a scope that FRET does not have": (
        "fret",
        json.dumps([{"reqid": "a", "fulltext": "except after m the robot shall always satisfy lamp"}]),
        "another scope is expected",
    ),
    "the beginning of a sentence": ("fret", json.dumps([{"reqid": "a", "fulltext": "in"}]), "FRETish is expected"),
    "the last position of FRET": (
        "fret",
        json.dumps([{"reqid": "a", "fulltext": "the robot shall finally satisfy lamp"}]),
        "the last position only",
    ),
    "a bound of FRET that is no number": (
        "fret",
        json.dumps([{"reqid": "a", "fulltext": "the robot shall within soon satisfy lamp"}]),
        "there is `soon` where a number is expected",
    ),
    "an array of C2PO for a condition": ("c2po", "INPUT xs: bool[2];\nFTSPEC xs;", "several values"),
    "a name that is two things": (
        "smv",
        "VAR n : 0..3;\nLTLSPEC G n",
        "`n` has values of the kind integer, not true and false",
    ),
}


@pytest.mark.parametrize(("key", "text", "expected"), PROBLEMS.values(), ids=list(PROBLEMS))
def test_what_cannot_be_imported_is_listed_with_the_reason(key: str, text: str, expected: str) -> None:
    (found,), written = imported(key, text)
    assert not found.text
    assert expected in found.problem
    assert f"# {found.requirement.id}: " in written[written.index("# Not imported:") :]


def test_one_bad_requirement_leaves_the_others() -> None:
    found, _ = imported("smv", "G a\nG (\nF b\n")
    assert [each.text for each in found] == ["always a", "", "eventually b"]


UNUSABLE = {
    "not JSON": ("fret", '[{"reqid": ', "not JSON"),
    "JSON of something else": ("fret", '{"a": 1}', "FRET exports a list"),
    "nothing": ("smv", "-- nothing\n", "nothing in it"),
    "no specification of C2PO": ("c2po", "INPUT a: bool;", "no FTSPEC"),
    "no column": ("csv", "id,text\n1,2\n", "no column is called `formula`"),
}


@pytest.mark.parametrize(("key", "text", "expected"), UNUSABLE.values(), ids=list(UNUSABLE))
def test_a_file_of_another_form_is_unusable(key: str, text: str, expected: str) -> None:
    with pytest.raises(UnusableFileError, match=expected):
        imported(key, text)


def test_names_that_the_language_does_not_have_are_replaced_and_told() -> None:
    _, text = imported("smv", "G (always.x -> F within)")
    assert "decl always_x      /always_x std_msgs/Bool.data  # always.x\n" in text
    assert "decl signal_within /within   std_msgs/Bool.data  # within\n" in text


def test_ids_that_occur_twice_are_numbered() -> None:
    _, text = imported("csv", "id,formula\na,G p\na,F p\n")
    assert '[id "a"]' in text
    assert '[id "a (2)"]' in text


def test_points_have_a_rate_only_where_positions_are_counted() -> None:
    assert "_rate_ = 10\n" in imported("smv", "G (a -> F[0,3] b)", 10**8)[1]
    assert "_rate_" not in imported("smv", "G (a -> F b)", 10**8)[1]


def test_a_rate_is_a_decimal_number() -> None:
    assert [rate(step) for step in (10**9, 2 * 10**7, 2 * 10**9, 3 * 10**6)] == ["1", "50", "0.5", ""]


def test_the_form_of_a_file_is_in_its_name() -> None:
    names = ("a.json", "b.C2PO", "c.smv", "d.hpl", "e.stl", "f.csv", "g.txt", "h")
    assert [form_of(name) for name in names] == ["fret", "c2po", "smv", "hpl", "stl", "csv", None, None]


def test_bounds_without_a_unit_are_positions_or_seconds() -> None:
    points, signals = measure_of(FORMS["c2po"], 10**8), measure_of(FORMS["stl"], None)
    assert points("5", "") == 5
    assert signals("5", "") == 5 * 10**9
    assert signals("20", "ms") == 2 * 10**7


def test_every_form_has_a_section_in_the_documentation() -> None:
    page = (Path(__file__).parents[1] / "docs" / "import.md").read_text(encoding="utf-8")
    for key, form in FORMS.items():
        assert f"`{key}`" in page
        assert all(f"`{ending}`" in page for ending in form.endings), key
