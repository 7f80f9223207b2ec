"""Emitted Python monitors against the machines they are made of and the reference value of expressions."""

from __future__ import annotations

import ast
import itertools
import math
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stepping import (
    FLAG,
    MODE,
    SCAN,
    X,
    Y,
    Z,
    emitted,
    expected,
    from_text,
    machine,
    machines,
    never,
    number,
    samples,
    specification,
)

from ltlc.backends import python
from ltlc.backends.names import class_name, variable
from ltlc.backends.python import standalone_classes
from ltlc.backends.python.code import layout, literal
from ltlc.backends.python.plan import plan_code
from ltlc.backends.trees import Infix, Text, prose
from ltlc.compiler import Compiled
from ltlc.runtime import functions, properties, sampling, session
from ltlc.semantics.monitor import Decision, Monitor
from ltlc.semantics.verdicts import Verdict
from ltlc.specification import expressions as e
from ltlc.specification.evaluation import letter
from ltlc.specification.expressions import Comparison, Condition, IsTrue, Relation, Same
from ltlc.specification.functions import Function

NASTY = [
    'quote " and \' and """ and \\',
    "line\nbreak\r\nand\x00nul",
    "\u202ereversed\u2066 größe \U0001f916 \u2028",
    "{{ 7 * 7 }} {% raw %} #}",
    '"""\nimport os\nos.abort()\n"""',
    "\\",
    '"',
    "# comment",
]


def verdicts_of(compiled: Compiled, run: Sequence[dict[e.Signal, Any]]) -> list[str]:
    """The verdicts of the emitted class, the values handed over by name."""
    [written] = standalone_classes([compiled], "props.txt")
    monitor = emitted([compiled])[written.name]()
    return [monitor.step(**{name: sample[signal] for name, signal in written.parameters}).value for sample in run]


@settings(max_examples=75)
@given(machines(), st.lists(samples(), max_size=8))
def test_any_machine_over_any_conditions_is_stepped_as_defined(
    compiled: Compiled, run: list[dict[e.Signal, Any]]
) -> None:
    assert verdicts_of(compiled, run) == expected(compiled, run)[0]


@settings(max_examples=50)
@given(machines(most_states=3), st.lists(samples(), max_size=8))
def test_the_classes_of_the_runtime_tell_invalid_steps_from_valid_ones_to_the_end(
    compiled: Compiled, run: list[dict[e.Signal, Any]]
) -> None:
    monitor = runtime_namespace([compiled])["plan"]().properties[0].monitor()
    inputs = compiled.specification.inputs()
    depth = max((getattr(i, "samples", 0) for i in inputs), default=0)
    for now in range(depth, len(run)):
        monitor.step(*(run[now - getattr(i, "samples", 0)][i.signal] for i in inputs))
    answers, invalid = expected(compiled, run)
    assert monitor.invalid == invalid
    assert monitor.verdict.value == (answers[-1] if answers else "not_started")


def runtime_namespace(compiled: Sequence[Compiled]) -> dict[str, Any]:
    namespace: dict[str, Any] = {"INFINITY": math.inf}
    for module in (functions, sampling, properties, session):
        namespace |= vars(module)
    namespace["Verdict"] = Verdict
    exec("from __future__ import annotations\n" + plan_code(compiled, specification(compiled)), namespace)
    return namespace


def parity(atoms: int) -> Monitor:
    """Violated as soon as an odd number of atoms holds at a step: no diagram over it is a small tree."""
    decisions = []
    for level in range(atoms):
        for odd in (0, 1):
            following = [~(2 * (level + 1) + (odd ^ bit)) if level + 1 < atoms else odd ^ bit for bit in (0, 1)]
            decisions.append(Decision(level, following[0], following[1]))
    names = tuple(f"a{level}" for level in range(atoms))
    return Monitor(names, (Verdict.PRESUMABLY_SATISFIED, Verdict.VIOLATED), (~0, 1), tuple(decisions))


def test_a_machine_with_2_to_the_30_ways_is_written_in_a_few_pages() -> None:
    signals = [number(f"s{i}") for i in range(30)]
    conditions = {f"a{i}": Comparison(e.Current(s), Relation.GREATER, e.Number(0.0)) for i, s in enumerate(signals)}
    compiled = machine(parity(30), conditions)
    assert len(python.emit([compiled], specification([compiled])).splitlines()) < 10_000
    assert verdicts_of(compiled, [dict.fromkeys(signals, 1.0)])[-1] == "presumably_satisfied"
    assert verdicts_of(compiled, [{s: float(s is not signals[7]) for s in signals}])[-1] == "violated"


def test_a_chain_of_a_hundred_atoms_does_not_nest_too_deeply() -> None:
    signals = [number(f"s{i}") for i in range(100)]
    conditions = {f"a{i}": Comparison(e.Current(s), Relation.GREATER, e.Number(0.0)) for i, s in enumerate(signals)}
    last = len(signals) - 1
    decisions = [Decision(i, i % 3, ~(i + 1) if i < last else 3) for i in range(len(signals))]
    verdicts = (Verdict.PRESUMABLY_SATISFIED, Verdict.PRESUMABLY_VIOLATED, Verdict.VIOLATED, Verdict.SATISFIED)
    compiled = machine(Monitor(tuple(conditions), verdicts, (~0, 1, 2, 3), tuple(decisions)), conditions)
    assert verdicts_of(compiled, [dict.fromkeys(signals, 1.0)]) == ["satisfied"]
    assert verdicts_of(compiled, [{s: float(s is not signals[50]) for s in signals}]) == ["violated"]


AB = "decl a /odom Odometry.pose.pose.position.x\ndecl b /odom Odometry.pose.pose.position.y\n"


def test_a_state_evaluates_only_the_atoms_that_it_needs() -> None:
    class Watched(float):
        asked = 0

        def __le__(self, other: float) -> bool:
            Watched.asked += other == 0
            return float(self) <= other

    compiled, _ = from_text(AB + "after a > 0, never b > 0")
    monitor = emitted(compiled)["Line3"]()
    monitor.step(a=0.0, b=Watched(1.0))
    assert Watched.asked == 0
    monitor.step(a=1.0, b=Watched(-1.0))
    assert Watched.asked == 1


def test_a_nan_is_no_step_even_where_the_state_does_not_ask_for_it() -> None:
    compiled, _ = from_text(AB + "after a > 0, never b > 0")
    monitor = emitted(compiled)["Line3"]()
    assert monitor.step(a=1.0, b=math.nan) == "not_started"
    assert monitor.step(a=0.0, b=1.0) == "presumably_satisfied"
    assert monitor.invalid == 1


@pytest.mark.parametrize("relation", Relation)
@pytest.mark.parametrize("margin", [0.0, 0.5])
@pytest.mark.parametrize("forbidden", [True, False])
@pytest.mark.parametrize("value", [0.0, 0.5, 1.0, 1.5, 2.0])
def test_a_comparison_and_its_negation_are_told_apart_at_their_border(
    relation: Relation, margin: float, forbidden: bool, value: float
) -> None:
    verdicts = (Verdict.PRESUMABLY_SATISFIED, Verdict.VIOLATED)
    decision = Decision(0, 0, 1) if forbidden else Decision(0, 1, 0)
    condition = Comparison(e.Current(X), relation, e.Number(1.0), margin)
    compiled = machine(Monitor(("a",), verdicts, (-1, 1), (decision,)), {"a": condition})
    assert verdicts_of(compiled, [{X: value}]) == expected(compiled, [{X: value}])[0]


def test_a_machine_with_many_states_goes_from_each_to_the_next() -> None:
    count = 23
    verdicts = tuple(Verdict.PRESUMABLY_VIOLATED if q else Verdict.PRESUMABLY_SATISFIED for q in range(count))
    decisions = tuple(Decision(0, q, (q + 1) % count) for q in range(count))
    cycle = Monitor(("a",), verdicts, tuple(~q for q in range(count)), decisions)
    compiled = machine(cycle, {"a": IsTrue(e.Current(FLAG))})
    run = [{FLAG: flag} for flag in [True, False, True] * count]
    assert verdicts_of(compiled, run) == expected(compiled, run)[0]
    assert verdicts_of(compiled, run).count("presumably_satisfied") > 1


@pytest.mark.parametrize("outer", e.Operator)
@pytest.mark.parametrize("inner", e.Operator)
def test_parentheses_are_kept_where_they_matter(outer: e.Operator, inner: e.Operator) -> None:
    right = e.Arithmetic(inner, e.Current(Y), e.Current(Z))
    total = e.Arithmetic(outer, e.Current(X), right)
    left = e.Arithmetic(outer, e.Arithmetic(inner, e.Current(X), e.Negative(e.Current(Y))), e.Current(Z))
    for expression in (total, left, e.Negative(total)):
        compiled = never(Comparison(expression, Relation.GREATER, e.Number(1.0)))
        runs = [[{X: x, Y: y, Z: z}] for x in (7.0, 3.0) for y in (2.0, 5.0) for z in (3.0, -4.0)]
        assert [verdicts_of(compiled, run) for run in runs] == [expected(compiled, run)[0] for run in runs]


def quotient(left: e.Signal, right: e.Signal) -> e.Expression:
    return e.Arithmetic(e.Operator.OVER, e.Current(left), e.Current(right))


@pytest.mark.parametrize(
    ("left", "right", "verdict"),
    [
        (1.0, 0.0, "violated"),
        (-1.0, 0.0, "presumably_satisfied"),
        (1.0, -0.0, "presumably_satisfied"),
        (0.0, 0.0, "not_started"),
        (math.inf, math.inf, "not_started"),
        (10**400, 1, "violated"),
        (-(10**400), 1, "presumably_satisfied"),
        (1, 10**400, "presumably_satisfied"),
        (True, True, "presumably_satisfied"),
    ],
)
def test_division_is_that_of_ieee_doubles_and_never_raises(left: float, right: float, verdict: str) -> None:
    compiled = never(Comparison(quotient(X, Z), Relation.GREATER, e.Number(2.0)))
    assert verdicts_of(compiled, [{X: left, Z: right}]) == [verdict]


@pytest.mark.parametrize("margin", [0.0, 0.5])
def test_integers_beyond_all_doubles_compare_as_infinite(margin: float) -> None:
    near = never(Comparison(e.Current(X), Relation.EQUAL, e.Number(3.0), margin))
    above = never(Comparison(e.Current(X), Relation.GREATER, e.Number(3.0), margin))
    assert verdicts_of(near, [{X: 10**400}]) == ["presumably_satisfied"]
    assert verdicts_of(above, [{X: 10**400}]) == ["violated"]


def test_before_there_are_enough_samples_a_monitor_has_not_started() -> None:
    compiled = never(Comparison(e.Past(X, 2), Relation.GREATER, e.Number(0.0)))
    run = [{X: float(x)} for x in (1, 0, 0, 0)]
    assert verdicts_of(compiled, run) == ["not_started", "not_started", "violated", "violated"]
    assert verdicts_of(compiled, run[1:]) == ["not_started", "not_started", "presumably_satisfied"]


def test_signals_whose_names_coincide_in_python_get_different_parameters() -> None:
    both = never(Comparison(e.Current(X), Relation.GREATER, e.Current(Y)))
    other = never(Comparison(e.Current(Y), Relation.GREATER, e.Number(0.0)), "second")
    first, second = standalone_classes([both, other], "props.txt")
    assert [name for name, _ in first.parameters] == ["robot_x", "robot_x_2"]
    assert second.parameters == (("robot_x_2", Y),)


@pytest.mark.parametrize(
    "name", ["class", "l", "self", "float", "divide", "value", "Verdict", "_", "__init__", "3d", "größe"]
)
def test_any_name_of_a_signal_or_a_label_gives_code_that_runs(name: str) -> None:
    signal = number(name)
    condition = Comparison(quotient(signal, Z), Relation.GREATER, e.Number(0.0))
    compiled = [
        never(condition, name),
        never(condition, name),
        never(Comparison(e.Past(signal, 1), Relation.LESS, e.Number(0.0)), name),
    ]
    module = emitted(compiled)
    parameters = [name for name, _ in standalone_classes(compiled, "props.txt")[0].parameters]
    answers = module["Monitors"]().step(*([1.0] * len(parameters)))
    assert [v.value for v in answers.values()] == ["violated", "violated", "not_started"]


@pytest.mark.parametrize("text", NASTY)
def test_nothing_written_in_a_specification_becomes_code(text: str) -> None:
    condition = Same(e.Current(MODE), e.String(text))
    compiled = [never(condition, label=text, text=text)]
    module = python.emit(compiled, specification(compiled, name=text))
    tree = ast.parse(module)
    assert {type(node) for node in tree.body} <= {
        *(ast.Expr, ast.Import, ast.ImportFrom, ast.ClassDef, ast.FunctionDef, ast.Assign)
    }
    assert module.isascii()
    assert all(character == "\n" or character.isprintable() for character in module)
    assert verdicts_of(compiled[0], [{MODE: "other"}, {MODE: text}]) == ["presumably_satisfied", "violated"]
    described = runtime_namespace(compiled)["plan"]().properties[0]
    assert (described.label, described.text) == (text, text)


@given(st.text())
def test_a_literal_is_the_string_and_prose_stays_in_its_docstring(text: str) -> None:
    assert ast.literal_eval(literal(text)) == text
    module = f'"""first:\n\n{prose(text)}\n"""\n# {prose(text)}\n'
    assert len(ast.parse(module).body) == 1


def ruff(*arguments: str, text: str) -> str:
    command = [sys.executable, "-m", "ruff", *arguments, "--isolated", "-"]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=False, timeout=60).stdout


LONG = [number("a_long_name_of_a_signal_that_goes_on_and_on_" + c) for c in ("until", "nearly", "the_end")]


def wide() -> list[Compiled]:
    """Properties whose lines have to be broken in every way."""
    a, b, c = (e.Current(s) for s in LONG)
    total = e.Arithmetic(e.Operator.PLUS, e.Arithmetic(e.Operator.TIMES, a, b), c)
    smallest = e.Call(Function.MIN, (a, b, c, total))
    conditions: dict[str, Condition] = {
        "a0": Comparison(total, Relation.GREATER, smallest, 0.25),
        "a1": Comparison(a, Relation.LESS, b),
        "a2": Comparison(b, Relation.LESS, c),
        "a3": Comparison(e.Past(LONG[0], 2), Relation.EQUAL, e.Number(0.0), 0.125),
        "a4": IsTrue(e.Current(FLAG)),
        "a5": Comparison(e.Call(Function.MAX, (e.Current(SCAN),)), Relation.AT_MOST, quotient(LONG[0], LONG[1])),
    }
    kinds = [v for v in Verdict if v is not Verdict.NOT_STARTED]
    found = [machine(parity(6), conditions, "a label", "a text " * 40)]
    for states in (2, 5, 12):
        edges = tuple(~(state * 7 % 11) for state in range(states))
        decisions = [Decision(i % 6, (i * 5) % states, (i * 3 + 1) % states) for i in range(11)]
        plain = [v for v in kinds if not v.is_permanent]
        verdicts = tuple(plain[state % 2] for state in range(states))
        found.append(machine(Monitor(tuple(conditions), verdicts, edges, tuple(decisions)), conditions, f"m{states}"))
    return found


@pytest.mark.parametrize("kind", ["wide", "drawn"])
def test_the_emitted_file_is_formatted_and_passes_the_default_rules(kind: str) -> None:
    pytest.importorskip("ruff")
    compiled = wide() if kind == "wide" else from_text(SPECIFICATION)[0]
    text = python.emit(compiled, specification(compiled))
    assert ruff("format", "--diff", text=text) == ""
    assert ruff("check", "--quiet", "--output-format=concise", text=text) == ""


def test_a_sum_on_several_lines_has_parentheses_only_where_its_tree_needs_them() -> None:
    a, b, c = (Text(name * 40) for name in "abc")
    total = Infix("+", (Infix("-", (a, b)), Infix("-", (Text("x"), Text("y"))), c))
    assert layout("    d = ", total) == [
        "    d = (",
        f"        {a.text}",
        f"        - {b.text}",
        "        + (x - y)",
        f"        + {c.text}",
        "    )",
    ]


SPECIFICATION = """
model robot: position /odom Odometry.pose.pose.position ;
decl scan /scan LaserScan.ranges
decl flag /flag std_msgs/Bool.data
decl mode /mode std_msgs/String.data
stop_at_sign: after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1,
    eventually robot.velocity =={0.01} 0
no_jerk: never robot.velocity - @{robot.velocity, -3} > 0.1 / robot.distance.stop_sign
never robot.localization_error > 0.2
always ((min(scan) > 0.3 or flag) and (robot.distance.stop_sign < 1 implies eventually robot.velocity == 0))
after flag, (until mode == "stop", robot.orientation < 1.5) and never mode != "go"
"""


def test_the_stop_sign_property_reads_as_a_person_would_write_it() -> None:
    compiled, _ = from_text(
        "stop_at_sign: after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1,\n"
        "    eventually robot.velocity =={0.01} 0\n"
    )
    [written] = standalone_classes(compiled, "props.txt")
    assert written.text == STOP_AT_SIGN


STOP_AT_SIGN = '''\
class StopAtSign:
    """Line 1 of props.txt:

    after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually
    robot.velocity =={0.01} 0
    """

    __slots__ = ("invalid", "state", "verdict")

    def __init__(self) -> None:
        self.state = 0
        self.verdict = NOT_STARTED
        self.invalid = 0

    def step(self, robot_distance_stop_sign: float, robot_velocity: float) -> Verdict:
        """Judge one more step; it is skipped if a value is NaN."""
        if not robot_distance_stop_sign <= INFINITY or not robot_velocity <= INFINITY:
            self.invalid += 1
            return self.verdict
        state = self.state
        if state == 0:  # presumably satisfied
            self.verdict = PRESUMABLY_SATISFIED
            if robot_distance_stop_sign < 1.0:
                if -0.01 <= robot_velocity <= 0.01:
                    self.state = 2
                else:
                    self.state = 1
                    self.verdict = PRESUMABLY_VIOLATED
        elif state == 1:  # presumably violated
            if robot_distance_stop_sign > 1.0:
                self.state = 3
                self.verdict = VIOLATED
            elif -0.01 <= robot_velocity <= 0.01:
                self.state = 2
                self.verdict = PRESUMABLY_SATISFIED
        elif state == 2 and robot_distance_stop_sign > 1.0:  # presumably satisfied
            self.state = 0
        return self.verdict
'''


def test_the_same_specification_gives_the_same_bytes() -> None:
    compiled, found = from_text(SPECIFICATION)
    assert python.emit(compiled, found) == python.emit(*from_text(SPECIFICATION))


@pytest.mark.parametrize(
    ("label", "name"),
    [
        ("stop_at_sign", "StopAtSign"),
        ("line 3", "Line3"),
        ("line 3.2", "Line3_2"),
        ("line 32", "Line32"),
        ("", "Property"),
    ],
)
def test_a_class_is_called_after_its_label(label: str, name: str) -> None:
    assert class_name(label) == name


def test_parameters_are_called_after_their_signals() -> None:
    assert variable("robot.distance.stop_sign") == "robot_distance_stop_sign"
    assert variable("scan.ranges[0]") == "scan_ranges_0"


def test_all_properties_are_stepped_at_once() -> None:
    compiled, _ = from_text(
        "decl x /odom Odometry.pose.pose.position.x\ndecl y /odom Odometry.pose.pose.position.y\n"
        "low: never x > 2\neventually y > x\n"
    )
    monitors = emitted(compiled)["Monitors"]()
    assert monitors.step(x=1.0, y=0.0) == {"low": "presumably_satisfied", "line 4": "presumably_violated"}
    assert monitors.step(x=3.0, y=4.0) == {"low": "violated", "line 4": "satisfied"}
    assert monitors.low.verdict == "violated"


@pytest.mark.parametrize(
    ("rate", "age", "said"),
    [("_rate_ = 5\n", "age(x) < 1 s", 1), ("", "age(x) < 1 s", 0), ("_rate_ = 5\n", "x < 1", 0)],
)
def test_a_module_says_that_it_hears_of_messages_at_ticks_only_where_ages_depend_on_it(
    rate: str, age: str, said: int
) -> None:
    text = python.emit(*from_text(f"{rate}decl x /x Float64.data\nalways {age}\n"))
    assert text.count("hears of a message at the tick after it") == said


def test_monitors_are_independent_of_one_another() -> None:
    module = emitted([never(IsTrue(e.Current(FLAG)))])
    first, second = module["Line1"](), module["Line1"]()
    first.step(flag=True)
    assert (first.verdict, second.verdict) == ("violated", "not_started")


def test_letters_of_all_kinds_are_reached() -> None:
    """The samples of these tests would be of little worth if they gave one letter only."""
    condition = Comparison(e.Arithmetic(e.Operator.MINUS, e.Current(X), e.Current(Z)), Relation.GREATER, e.Number(0.0))
    seen = {
        letter(never(condition).specification.atoms, {e.Current(X): x, e.Current(Z): z})
        for x, z in itertools.product((0.0, 1.0, math.inf, math.nan), repeat=2)
    }
    assert len(seen) == 3
