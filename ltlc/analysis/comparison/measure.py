"""What one formula costs and allows: its monitor and Spot's automata, its class, and when it can be decided."""

from __future__ import annotations

import time
from collections.abc import Iterator

from ltlc.analysis.comparison.results import Monitorability, Monitored
from ltlc.analysis.comparison.shortest import shortest_word
from ltlc.analysis.comparison.timed import earliest_in_time
from ltlc.automata import translate
from ltlc.automata.machine import Machine, letters_of
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor, Target
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
    return list(dict.fromkeys(_leaves(monitor, monitor.edges[state])))


def edges(monitor: Monitor) -> int:
    """The number of pairs of a state and a successor of it."""
    return sum(len(successors(monitor, state)) for state in range(len(monitor.verdicts)))


def _leaves(monitor: Monitor, target: Target) -> Iterator[int]:
    pending, seen = [target], set()
    while pending:
        current = pending.pop()
        if current in seen:
            continue
        seen.add(current)
        if current >= 0:
            yield current
        else:
            pending += [monitor.decisions[~current].high, monitor.decisions[~current].low]


def earliest(monitor: Monitor, verdict: Verdict, formula: Formula, alphabet: Alphabet) -> Word | None:
    """A shortest run, of one step at least, after which `monitor`, made of `formula`, says `verdict`."""
    if timed_atoms(formula):
        return earliest_in_time(monitor, verdict, formula, alphabet)
    return shortest_word((machine_of(monitor, formula, alphabet),), lambda output: output is verdict)


def machine_of(monitor: Monitor, formula: Formula, alphabet: Alphabet) -> Machine:
    """`monitor`, made of `formula`, as a machine that knows which letters of `alphabet` exist."""
    letters = letters_of(formula, alphabet)
    diagrams = letters.diagrams
    known: dict[Target, Diagram] = {}

    def lift(target: Target) -> Diagram:
        if target >= 0:
            return diagrams.terminal(target)
        if target not in known:
            decision = monitor.decisions[~target]
            known[target] = diagrams.decision(decision.atom, lift(decision.low), lift(decision.high))
        return known[target]

    return Machine(letters, list(monitor.verdicts), [letters.restrict(lift(target)) for target in monitor.edges])
