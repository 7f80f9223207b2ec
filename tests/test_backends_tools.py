"""Monitors for other tools: each output, read back by its own reader, is the monitor that went in."""

from __future__ import annotations

import json
import shutil
import subprocess
from typing import Any

import pytest
from hypothesis import given, settings
from stepping import FLAG, from_text, machine, machines, never, specification

from ltlc.backends import dot, guards, hoa
from ltlc.backends import json as json_target
from ltlc.backends.library import called_in, needed
from ltlc.compiler import Compiled
from ltlc.semantics.monitor import Decision, Monitor
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import all_letters
from ltlc.specification import expressions as e
from ltlc.specification.expressions import IsTrue

ODD = 'a "quoted" \\ back\\slash\nline größe /* */ --BODY--'


def read_hoa(text: str) -> list[Any]:
    spot = pytest.importorskip("spot")
    return list(spot.automata(text))


def step_hoa(automaton: Any, state: int, holds: set[str]) -> list[int]:
    """Where the edges that allow the letter lead."""
    buddy = pytest.importorskip("buddy")
    names = [str(ap) for ap in automaton.ap()]
    letter = buddy.bddtrue
    for name in names:
        variable = automaton.register_ap(name)
        letter &= buddy.bdd_ithvar(variable) if name in holds else buddy.bdd_nithvar(variable)
    return [edge.dst for edge in automaton.out(state) if (edge.cond & letter) != buddy.bddfalse]


@pytest.mark.parametrize("most_cubes", [guards.MOST_CUBES, 0])
@settings(max_examples=25)
@given(compiled=machines())
def test_spot_reads_the_machine_that_was_written(most_cubes: int, compiled: Compiled) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(guards, "MOST_CUBES", most_cubes)
        [automaton] = read_hoa(hoa.emit([compiled], specification([compiled])))
    monitor = compiled.monitor
    assert automaton.num_states() == len(monitor.verdicts)
    assert automaton.get_init_state_number() == 0
    for state in range(len(monitor.verdicts)):
        for letter in all_letters(monitor.atoms):
            assert step_hoa(automaton, state, set(letter)) == [monitor.step(state, letter)]
    accepting = [automaton.state_is_accepting(state) for state in range(len(monitor.verdicts))]
    assert accepting == [verdict is not Verdict.VIOLATED for verdict in monitor.verdicts]


def test_the_verdicts_are_the_names_of_the_states() -> None:
    text = hoa.emit([never(IsTrue(e.Current(FLAG)))], specification([]))
    assert 'State: 0 "presumably_satisfied" {0}' in text
    assert 'State: 1 "violated"\n' in text


def test_strange_names_are_quoted_in_hoa() -> None:
    monitor = Monitor((ODD,), (Verdict.PRESUMABLY_SATISFIED, Verdict.VIOLATED), (-1, 1), (Decision(0, 0, 1),))
    compiled = machine(monitor, {ODD: IsTrue(e.Current(FLAG))}, label=ODD, text=ODD)
    [automaton] = read_hoa(hoa.emit([compiled], specification([compiled], ODD)))
    assert automaton.get_name() == f"{ODD}: {ODD}"
    assert [str(ap).strip('"') for ap in automaton.ap()] == [
        ODD.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    ]


def chain(atoms: int) -> Compiled:
    """As many ways through the decisions as there are subsets of the atoms, of which half lead to a violation."""
    decisions = []
    for level in range(atoms):
        for odd in (0, 1):
            low, high = (~(2 * (level + 1) + (odd ^ bit)) if level + 1 < atoms else odd ^ bit for bit in (0, 1))
            decisions.append(Decision(level, low, high))
    names = tuple(f"a{level}" for level in range(atoms))
    monitor = Monitor(names, (Verdict.PRESUMABLY_SATISFIED, Verdict.VIOLATED), (~0, 1), tuple(decisions))
    return machine(monitor, {name: IsTrue(e.Current(FLAG)) for name in names})


def test_a_monitor_with_2_to_the_40_ways_stays_small_in_every_form() -> None:
    compiled = chain(40)
    for target in (hoa, dot, json_target):
        assert len(target.emit([compiled], specification([compiled]))) < 40_000
    [automaton] = read_hoa(hoa.emit([chain(20)], specification([])))
    assert step_hoa(automaton, 0, {"a3"}) == [1]
    assert step_hoa(automaton, 0, {"a3", "a19"}) == [0]


@given(compiled=machines())
def test_the_json_document_is_the_whole_machine(compiled: Compiled) -> None:
    [found] = json.loads(json_target.emit([compiled], specification([compiled])))["properties"]
    assert compiled.monitor == Monitor(
        tuple(found["atoms"]),
        tuple(Verdict(name) for name in found["states"]),
        tuple(found["edges"]),
        tuple(Decision(*decision) for decision in found["decisions"]),
    )


def test_the_json_document_tells_settings_property_and_alphabet() -> None:
    compiled, found = from_text(
        "_rate_ = 5\ndecl x /odom Odometry.pose.pose.position.x\nfast: never x > 2 and x < 1\n", "a.txt"
    )
    document = json.loads(json_target.emit(compiled, found))
    [described] = document.pop("properties")
    assert document.pop("provenance")["specifications"] == [{"name": "a.txt", "sha256": found.source.sha256}]
    assert document == {"schema": "ltlc-monitors-1", "source": "a.txt", "rate": 5.0, "timeout": None}
    assert (described["label"], described["line"], described["encoding"]) == ("fast", 3, "episode")
    assert described["alphabet"] == [{"atoms": ["x > 2", "x < 1"], "valuations": [["x < 1"], [], ["x > 2"]]}]


def graphviz(text: str) -> dict[str, Any]:
    program = shutil.which("dot")
    if program is None:
        pytest.skip("Graphviz is not installed")
    done = subprocess.run([program, "-Tdot_json"], input=text, capture_output=True, text=True, check=False, timeout=60)
    assert done.stderr == ""
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def test_graphviz_reads_states_edges_and_conditions() -> None:
    compiled = [never(IsTrue(e.Current(FLAG)))] * 2
    graph = graphviz(dot.emit(compiled, specification(compiled)))
    labels = [item.get("label") for item in graph["objects"]]
    assert labels.count("0\\npresumably satisfied") == 2
    assert labels.count("1\\nviolated") == 2
    assert [edge["label"] for edge in graph["edges"] if edge.get("label")] == ["not a", "a", "always"] * 2


def test_strange_names_are_quoted_in_dot() -> None:
    monitor = Monitor((ODD,), (Verdict.PRESUMABLY_SATISFIED, Verdict.VIOLATED), (-1, 1), (Decision(0, 0, 1),))
    compiled = machine(monitor, {ODD: IsTrue(e.Current(FLAG))}, label=ODD, text=ODD)
    graph = graphviz(dot.emit([compiled], specification([compiled], ODD)))
    assert len(graph["edges"]) == 4


def test_what_only_comments_strings_and_members_mention_is_not_called() -> None:
    code = 'f(x); /* g(y)\n"h(" */ s = "i(\\"j("; // k(w) "\nself.l(m); n_f(0); f (1);'
    assert called_in(code) == {"f", "n_f"}


def test_a_function_comes_with_those_that_it_calls_and_in_the_order_of_the_library() -> None:
    library = {"last": "last() { }", "other": "other() { }", "first": "first() { last(); first(); }"}
    assert needed(library, "first()", called_in) == [library["last"], library["first"]]
