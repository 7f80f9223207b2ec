"""The runs on which a monitor is judged: short ones all, every transition of it, every pair of it and its formula.

The second kind is the W-method of conformance testing (Chow, *Testing software design modeled by finite-state
machines*, 1978): if the monitor differs from the reference, and the reference needs at most one state more than the
monitor has, then the verdicts differ on one of these runs. The third needs no such bound: what remains of the formula
after a run decides which continuations satisfy it, so a monitor of the right formula that gives a wrong finite verdict
on any run gives one on the run that first leads to the same state and the same residual. Both are complete when the
letters are: for small alphabets.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Iterator, Sequence
from itertools import chain, islice, product

from ltlc.assurance.residuals import Residuals
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet, Answers
from ltlc.semantics.diagrams import Diagram, Diagrams, of_predicate
from ltlc.semantics.ltl import TRUE, Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.properties import predicates
from ltlc.semantics.timed_atoms import operands, timed_atoms
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter, Word, all_words

MOST_LETTERS = 24
"""An alphabet with at most this many letters is used whole; of a larger one, letters that matter."""

LONGEST_SHORT_RUN, MOST_SHORT_RUNS = 6, 400
"""All runs of a length are tried up to this length, and as long as there are at most that many of them."""


MORE_STATES = 1
"""So many states more than the monitor the reference may need: a wrong monitor is often one that forgot something."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """The monitor gave the verdict of the reference on each of `runs` runs, the longest of `longest` steps.

    `exhaustive` says up to which length every run over the judging letters was among them; 0 in time.
    """

    runs: int
    longest: int
    exhaustive: int


@dataclass(frozen=True, slots=True)
class Mismatch:
    """After `run`, the shortest found, the monitor says `monitor`; `expected` says why that is wrong."""

    run: Word
    monitor: Verdict
    expected: str


def judging_letters(compiled: Compiled) -> list[Letter]:
    """Letters that exist and between them answer each question of the property and of its monitor in every way.

    A small alphabet is taken whole. Of a large one come the ways to decide each state predicate and event of the
    property, and each way from a state of the monitor to the next. Atoms that time decides are not in it.
    """
    alphabet = compiled.specification.alphabet
    if alphabet.count() <= MOST_LETTERS:
        return list(alphabet.letters())
    chance = random.Random(0)
    timed = timed_atoms(compiled.formula)
    names = (*alphabet.atoms, *(atom.name for atom in timed))
    asked = [*predicates(compiled.specification.property), *(p for atom in timed for p in operands(atom))]
    questions = [
        *(_ways_to_decide(predicate, names) for predicate in asked),
        *(_ways_on(compiled.monitor, target) for target in compiled.monitor.edges),
    ]
    found: dict[Letter, None] = {}
    for question in questions:
        for answers in islice(question, MOST_LETTERS):
            untimed = {atom: answer for atom, answer in answers.items() if atom in alphabet.atoms}
            found.update(dict.fromkeys(_completions(alphabet, untimed, chance)))
    return list(islice(found, 4 * MOST_LETTERS))


def _ways_to_decide(predicate: Formula, atoms: Sequence[str]) -> Iterator[Answers]:
    diagrams = Diagrams()
    levels = {atom: level for level, atom in enumerate(atoms)}
    for answers, _ in diagrams.paths(of_predicate(predicate, diagrams, levels)):
        yield {atoms[level]: answer for level, answer in answers.items()}


def _ways_on(monitor: Monitor, target: int) -> Iterator[Answers]:
    if target >= 0:
        yield {}
        return
    decision = monitor.decisions[~target]
    for answer, rest in ((False, decision.low), (True, decision.high)):
        for answers in _ways_on(monitor, rest):
            yield {monitor.atoms[decision.atom]: answer, **answers}


def _completions(alphabet: Alphabet, answers: Answers, chance: random.Random) -> Iterator[Letter]:
    """Letters that exist and give `answers`: one with as few further atoms as it goes, and one at random."""
    smallest = alphabet.completed(answers)
    if smallest is None:
        return
    yield smallest
    free = frozenset(a for a in alphabet.free_atoms() if answers.get(a, chance.random() < 1 / 2))
    yield free.union(*(chance.choice(group.fitting(answers)) for group in alphabet.groups))


def exhaustive_length(letters: Sequence[Letter]) -> int:
    """The length up to which all runs over `letters` are tried."""
    within = (n for n in range(LONGEST_SHORT_RUN, 1, -1) if len(letters) ** n <= MOST_SHORT_RUNS)
    return next(within, 1)


def short_runs(letters: Sequence[Letter]) -> Iterator[Word]:
    """All words over `letters` up to `exhaustive_length`, the empty one first."""
    for length in range(exhaustive_length(letters) + 1):
        yield from all_words(letters, length)


def transition_runs(monitor: Monitor, letters: Sequence[Letter]) -> Iterator[Word]:
    """To each state, then each letter, or each two, then each word that distinguishes two states."""
    access = access_words(monitor, letters)
    suffixes = distinguishing_words(monitor, letters)
    for length in (1, 1 + MORE_STATES):
        for parts in product(access.values(), all_words(letters, length), suffixes):
            yield tuple(chain(*parts))


def residual_runs(monitor: Monitor, formula: Formula, letters: Sequence[Letter]) -> Iterator[Word]:
    """A shortest run to each state of `monitor` together with each residual of `formula`, shorter ones first."""
    residuals = Residuals(monitor.atoms, TRUE)
    start = (0, residuals.of(formula))
    seen = {start}
    queue: deque[tuple[Word, tuple[int, Diagram]]] = deque([((), start)])
    while queue:
        word, (state, residual) = queue.popleft()
        yield word
        for letter in letters:
            place = (monitor.step(state, letter), residuals.after(residual, letter))
            if place not in seen:
                seen.add(place)
                queue.append(((*word, letter), place))


def access_words(monitor: Monitor, letters: Sequence[Letter]) -> dict[int, Word]:
    """A shortest word over `letters` to each state that one leads to, the initial state first."""
    words: dict[int, Word] = {0: ()}
    queue = deque([0])
    while queue:
        state = queue.popleft()
        for letter in letters:
            successor = monitor.step(state, letter)
            if successor not in words:
                words[successor] = (*words[state], letter)
                queue.append(successor)
    return words


def distinguishing_words(monitor: Monitor, letters: Sequence[Letter]) -> list[Word]:
    """Words, the empty one among them, that distinguish any two states that `letters` can distinguish."""
    words: list[Word] = [()]
    signatures: list[tuple[Verdict, ...]] = [(verdict,) for verdict in monitor.verdicts]
    for word in words:  # grows: where two states still go together, a letter before a word that splits their successors
        for letter in letters:
            candidate = (letter, *word)
            outputs = [monitor.verdicts[state_after(monitor, candidate, start)] for start in range(len(signatures))]
            refined = [(*s, output) for s, output in zip(signatures, outputs, strict=True)]
            if len(set(refined)) > len(set(signatures)):
                words.append(candidate)
                signatures = refined
    return words


def state_after(monitor: Monitor, word: Word, start: int = 0) -> int:
    """The state of `monitor` after `word`, from the state `start`."""
    state = start
    for letter in word:
        state = monitor.step(state, letter)
    return state
