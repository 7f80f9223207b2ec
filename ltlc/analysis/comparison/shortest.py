"""Finds the shortest run that distinguishes two formulas: a finite one, or an infinite one as a lasso.

Spot says whether there is such a run; the run that it would give is not the shortest. Here the searches go breadth
first, with one letter of each kind that the automata distinguish.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from ltlc.automata.machine import Letter as Impossible
from ltlc.automata.machine import Letters, Machine
from ltlc.automata.queries import Buchi
from ltlc.dataclass import dataclass
from ltlc.semantics.diagrams import Diagram
from ltlc.semantics.words import Lasso, Letter, Word

MOST_LOOPS = 20_000
"""Different behaviours of loops that the search for a lasso keeps; beyond that it gives up."""


class TooManyLoopsError(Exception):
    """There is a lasso, but the search for a shortest one has grown too large."""


def shortest_word(machines: tuple[Machine, ...], wanted: Callable[..., bool]) -> Word | None:
    """A shortest word, not empty, after which `wanted` is true of the outputs of `machines`; None if there is none.

    `machines` share their diagrams. Among the shortest, one with few atoms at its first steps comes first.
    """
    letters = machines[0].letters
    start = tuple(0 for _ in machines)
    words: dict[tuple[int, ...], Word] = {start: ()}
    waiting = deque([start])
    while waiting:
        states = waiting.popleft()
        for letter, successor in _successors(letters, [m.successors[q] for m, q in zip(machines, states, strict=True)]):
            word = (*words[states], letter)
            if wanted(*(machine.outputs[q] for machine, q in zip(machines, successor, strict=True))):
                return word
            if successor not in words:
                words[successor] = word
                waiting.append(successor)
    return None


def _successors(letters: Letters, rows: list[Diagram]) -> Iterator[tuple[Letter, tuple[int, ...]]]:
    """Each combination of values that `rows` take at a letter that exists, with such a letter."""
    together = letters.diagrams.combine(lambda *values: values, *rows)
    yield from representatives(letters, letters.restrict(together))


def representatives(letters: Letters, diagram: Diagram) -> Iterator[tuple[Letter, Any]]:
    """Each value of `diagram` with a letter that has it, the smallest first; an atom not asked for is false."""
    diagrams = letters.diagrams
    seen: set[Diagram] = set()
    stack: list[tuple[Diagram, Letter]] = [(diagram, frozenset())]
    while stack:
        node, letter = stack.pop()
        if node in seen:
            continue
        seen.add(node)
        if diagrams.is_terminal(node):
            if diagrams.value(node) is not Impossible.IMPOSSIBLE:
                yield letter, diagrams.value(node)
            continue
        level, low, high = diagrams.split(node)
        stack.append((high, letter | {letters.atoms[level]}))
        stack.append((low, letter))


Loop = tuple[tuple[int, ...], tuple[int, ...]]
"""What a word does to an automaton: for each state, the states it can lead to, and those of them it can lead to by an
accepting edge, as bit masks."""


@dataclass(frozen=True, slots=True)
class _Kind:
    """Letters that the automaton does not distinguish: one of them, and its effect."""

    letter: Letter
    edges: Loop


def shortest_lasso(automaton: Buchi) -> Lasso | None:
    """A lasso that `automaton` accepts, with stem and loop together as short as any; None if it accepts nothing.

    Of several, one with a short loop: 'and so it stays'. Raises TooManyLoopsError.
    """
    kinds = list(_kinds(automaton))
    stems: list[dict[int, Word]] = [{1: ()}]
    loops: list[dict[Loop, Word]] = [{_nothing(automaton): ()}]
    known_stems, known_loops = {1}, set(loops[0])
    accepted: list[dict[int, Word]] = [{}]
    length = 0
    while stems[-1] or loops[-1]:
        length += 1
        loops.append(_longer(loops[-1], known_loops, kinds, _after))
        accepted.append(_by_start(loops[-1]))
        for loop_length in range(1, length + 1):
            if lasso := _meeting(stems[length - loop_length], accepted[loop_length]):
                return lasso
        stems.append(_longer(stems[-1], known_stems, kinds, _reached))
        if len(known_loops) > MOST_LOOPS:
            raise TooManyLoopsError
    return None


def _by_start(loops: dict[Loop, Word]) -> dict[int, Word]:
    """The first of the loops for each set of states from which repeating it is accepted."""
    found: dict[int, Word] = {}
    for loop, word in loops.items():
        found.setdefault(_accepting(loop), word)
    return found


def _meeting(stems: dict[int, Word], accepted: dict[int, Word]) -> Lasso | None:
    """A lasso of one of the stems and a loop that is accepted from where that leads."""
    for reached, stem in stems.items():
        for states, loop in accepted.items():
            if reached & states:
                return Lasso(stem, loop)
    return None


def _kinds(automaton: Buchi) -> Iterator[_Kind]:
    letters = automaton.letters
    together = letters.diagrams.combine(lambda *values: values, *automaton.successors)
    for letter, sets in representatives(letters, letters.restrict(together)):
        yield _Kind(letter, (tuple(map(_mask, sets)), tuple(_mask(e for e in edges if e & 1) for edges in sets)))


def _mask(edges: Iterable[int]) -> int:
    """The states to which `edges` lead."""
    return sum(1 << state for state in {edge >> 1 for edge in edges})


def _nothing(automaton: Buchi) -> Loop:
    """What the empty word does."""
    states = range(len(automaton.successors))
    return tuple(1 << state for state in states), tuple(0 for _ in states)


def _longer(
    words: dict[Any, Word], known: set[Any], kinds: list[_Kind], step: Callable[[Any, Loop], Any]
) -> dict[Any, Word]:
    """What words that are longer by a letter do, where none of the `known` ones does the same."""
    found: dict[Any, Word] = {}
    for before, word in words.items():
        for kind in kinds:
            after = step(before, kind.edges)
            if after not in known:
                known.add(after)
                found[after] = (*word, kind.letter)
    return found


def _reached(states: int, edges: Loop) -> int:
    """The states after a letter."""
    return _union(edges[0], states)


def _after(loop: Loop, edges: Loop) -> Loop:
    """What a word does that goes on with a letter."""
    return (
        tuple(_union(edges[0], states) for states in loop[0]),
        tuple(_union(edges[0], late) | _union(edges[1], states) for states, late in zip(*loop, strict=True)),
    )


def _accepting(loop: Loop) -> int:
    """The states from which repeating the loop forever can be accepted."""
    reached = _closure(loop[0])
    recurring = 0
    for state, accepting in enumerate(loop[1]):
        if any(state == after or reached[after] >> state & 1 for after in _bits(accepting)):
            recurring |= 1 << state
    leading = sum(1 << state for state, states in enumerate(reached) if states & recurring)
    return recurring | leading


def _closure(step: tuple[int, ...]) -> tuple[int, ...]:
    """For each state, the states after one or more of what `step` does."""
    while True:
        longer = tuple(states | _union(step, states) for states in step)
        if longer == step:
            return step
        step = longer


def _union(sets: Sequence[int], states: int) -> int:
    """All that is in one of the `sets` with the numbers in `states`."""
    result = 0
    for state in _bits(states):
        result |= sets[state]
    return result


def _bits(mask: int) -> Iterator[int]:
    while mask:
        lowest = mask & -mask
        yield lowest.bit_length() - 1
        mask ^= lowest
