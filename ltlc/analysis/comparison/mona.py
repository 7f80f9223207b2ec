"""Finite words judged by MONA: a formula as a formula of monadic second-order logic on strings.

Henriksen et al., *Mona: Monadic second-order logic in practice*, 1995. Nothing that ltlc makes depends on it: it is an
independent construction, for comparisons and tests, where `mona` is installed.
"""

from __future__ import annotations

import resource
import subprocess
from functools import partial
from itertools import count
from pathlib import Path
from typing import assert_never

from ltlc.automata.machine import Letters, Machine, explore
from ltlc.dataclass import dataclass
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.ltl import And, Atom, Formula, Next, Not, Or, Truth, Until, atoms
from ltlc.semantics.words import Word

MOST_SECONDS = 60


@dataclass(frozen=True)
class MonaAutomaton:
    """A deterministic automaton as `mona -xw` prints it; `nodes` are (variable, low, high), or (-1, state, 0)."""

    atoms: tuple[str, ...]
    initial: int
    final: tuple[int, ...]
    behaviour: tuple[int, ...]
    nodes: tuple[tuple[int, int, int], ...]

    def accepts(self, word: Word) -> bool:
        """Whether the non-empty `word` satisfies the formula; the first step of all reads no letter."""
        state = self._step(self.initial, frozenset())
        for letter in word:
            state = self._step(state, letter)
        return self.final[state] == 1

    def machine(self, letters: Letters) -> Machine:
        """Whether the word, not empty, satisfies the formula, as a machine over `letters`, which has its atoms."""
        diagrams = letters.diagrams
        levels = {atom: level for level, atom in enumerate(letters.atoms)}

        def lift(node: int) -> Diagram:
            variable, low, high = self.nodes[node]
            if variable == -1:
                return diagrams.terminal(low)
            return diagrams.choose(diagrams.variable(levels[self.atoms[variable]]), lift(high), lift(low))

        rows = [lift(node) for node in self.behaviour]
        start = self._step(self.initial, frozenset())
        return explore(letters, start, lambda state: rows[state], lambda state: self.final[state] == 1)

    def _step(self, state: int, letter: frozenset[str]) -> int:
        variable, low, high = self.nodes[self.behaviour[state]]
        while variable != -1:
            variable, low, high = self.nodes[high if self.atoms[variable] in letter else low]
        return low


def automaton(formula: Formula, folder: Path) -> MonaAutomaton:
    """What MONA makes of `formula`; `folder` is for its input file. Raises RuntimeError if it gives up."""
    names = atoms(formula)
    tracks = {name: f"P{number}" for number, name in enumerate(names)}
    file = folder / "formula.mona"
    declared = ", ".join(tracks.values()) or "UNUSED"
    file.write_text(f"m2l-str;\nvar2 {declared};\n{_at(formula, '0', tracks, count())};\n")
    printed = _run_mona(file)
    header, _, rest = printed.partition("bdd:")
    fields = dict(line.split(":", 1) for line in header.splitlines() if ":" in line)
    lines = rest.split("end")[0].strip().splitlines()
    return MonaAutomaton(
        names,
        int(fields["initial"]),
        tuple(int(x) for x in fields["final"].split()),
        tuple(int(x) for x in fields["behaviour"].split()),
        tuple((int(v), int(low), int(high)) for v, low, high in (line.split() for line in lines)),
    )


def _run_mona(file: Path) -> str:
    """What `mona` prints. It limits its own time, as this process may be stopped before it ends."""
    limit = partial(resource.setrlimit, resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS))
    command = ["mona", "-xw", str(file)]
    try:
        done = subprocess.run(command, check=True, capture_output=True, text=True, preexec_fn=limit)
    except subprocess.CalledProcessError as error:
        raise RuntimeError(f"mona ended with {error.returncode}: {error.stderr.strip()}") from error
    return done.stdout


def _at(formula: Formula, position: str, tracks: dict[str, str], fresh: count[int]) -> str:
    """`formula` at `position`, in MONA's syntax."""

    def at(operand: Formula, where: str = position) -> str:
        return _at(operand, where, tracks, fresh)

    match formula:
        case Truth():
            return "true"
        case Atom(name):
            return f"({position} in {tracks[name]})"
        case Not(operand):
            return f"~{at(operand)}"
        case And(left, right):
            return f"({at(left)} & {at(right)})"
        case Or(left, right):
            return f"({at(left)} | {at(right)})"
        case Next(operand):
            later = f"v{next(fresh)}"
            return f"(ex1 {later}: {position} < max($) & {later} = {position} + 1 & {at(operand, later)})"
        case Until(left, right):
            end, before = f"v{next(fresh)}", f"v{next(fresh)}"
            all_before = f"all1 {before}: ({position} <= {before} & {before} < {end}) => {at(left, before)}"
            return f"(ex1 {end}: {position} <= {end} & {at(right, end)} & ({all_before}))"
        case _:
            assert_never(formula)
