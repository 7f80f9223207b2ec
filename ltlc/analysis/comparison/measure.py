"""What one formula costs and allows: its monitor and Spot's automata, its class, and when it can be decided."""

from __future__ import annotations

import time

from ltlc.analysis.comparison.results import Monitorability, Monitored
from ltlc.analysis.comparison.shortest import shortest_word
from ltlc.analysis.comparison.timed import earliest_in_time
from ltlc.automata import translate
from ltlc.automata.machine import Machine, letters_of
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.diagrams import rows
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor, below
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Word


def monitored(formula: Formula, alphabet: Alphabet) -> Monitored:
    """The monitor of `formula`, made by `ltlc.automata.translate`, with what it took and what it can decide."""
    start = time.perf_counter()
    monitor = translate(formula, alphabet)
    seconds = time.perf_counter() - start
    violation = earliest(monitor, Verdict.VIOLATED, formula, alphabet)
    return Monitored(monitor, seconds, edges(monitor), monitorability(monitor), violation)


def monitorability(monitor: Monitor) -> Monitorability:
    """Whether a permanent verdict can come from every state of `monitor`, from some or from none."""
    deciding = {state for state, verdict in enumerate(monitor.verdicts) if verdict.is_permanent}
    while True:
        more = {q for q in range(len(monitor.verdicts)) if not deciding.isdisjoint(successors(monitor, q))} | deciding
        if more == deciding:
            break
        deciding = more
    if len(deciding) == len(monitor.verdicts):
        return Monitorability.ALWAYS
    return Monitorability.SOMETIMES if deciding else Monitorability.NEVER


def successors(monitor: Monitor, state: int) -> list[int]:
    """The states to which some letter leads from `state`, each once."""
    return [target for target in below(monitor.decisions, [monitor.edges[state]]) if target >= 0]


def edges(monitor: Monitor) -> int:
    """The number of pairs of a state and a successor of it."""
    return sum(len(successors(monitor, state)) for state in range(len(monitor.verdicts)))


def earliest(monitor: Monitor, verdict: Verdict, formula: Formula, alphabet: Alphabet) -> Word | None:
    """A shortest run, of one step at least, after which `monitor`, made of `formula`, says `verdict`."""
    if timed_atoms(formula):
        return earliest_in_time(monitor, verdict, formula, alphabet)
    return shortest_word((machine_of(monitor, formula, alphabet),), lambda output: output is verdict)


def machine_of(monitor: Monitor, formula: Formula, alphabet: Alphabet) -> Machine:
    """`monitor`, made of `formula`, as a machine that knows which letters of `alphabet` exist."""
    letters = letters_of(formula, alphabet)
    row = rows(letters.diagrams, monitor.decisions, letters.diagrams.variable)
    return Machine(letters, list(monitor.verdicts), [letters.restrict(row(target)) for target in monitor.edges])
