"""Shortest runs of monitors side by side, breadth first, one letter for each way on that exists."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence

from ltlc.semantics.alphabet import Alphabet, Answers
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.words import Letter, Word

States = tuple[int, ...]
"""The state of each monitor."""

MOST_STATES = 20_000
"""A search that has seen more states side by side than this gives up."""


def shortest(monitors: Sequence[Monitor], alphabet: Alphabet, wanted: Callable[[States], bool]) -> Word | None:
    """A shortest word, not empty, after which `wanted` is true of the states; None if none is found."""
    return next(all_shortest(monitors, alphabet, wanted), None)


def all_shortest(monitors: Sequence[Monitor], alphabet: Alphabet, wanted: Callable[[States], bool]) -> Iterator[Word]:
    """Words, not empty, after which `wanted` is true of the states, each reaching them in another way, short first."""
    start = tuple(0 for _ in monitors)
    words: dict[States, Word] = {start: ()}
    waiting = deque([start])
    while waiting and len(words) < MOST_STATES:
        states = waiting.popleft()
        for letter, after in moves(monitors, states, alphabet):
            word = (*words[states], letter)
            if wanted(after):
                yield word
            if after not in words:
                words[after] = word
                waiting.append(after)


def moves(monitors: Sequence[Monitor], states: States, alphabet: Alphabet) -> Iterator[tuple[Letter, States]]:
    """The ways on from `states`, each with a letter that exists and takes it."""
    edges = [monitor.edges[state] for monitor, state in zip(monitors, states, strict=True)]
    for answers in _ways(monitors, edges, {}):
        letter = alphabet.completed(answers)
        if letter is not None:
            yield letter, tuple(monitor.step(state, letter) for monitor, state in zip(monitors, states, strict=True))


def _ways(monitors: Sequence[Monitor], edges: Sequence[int], answers: Answers) -> Iterator[Answers]:
    """The combinations of answers that lead through the decisions of all monitors, one after the other."""
    if not monitors:
        yield answers
        return
    first, *others = monitors
    edge, *rest = edges
    if edge >= 0:
        yield from _ways(others, rest, answers)
        return
    decision = first.decisions[~edge]
    atom = first.atoms[decision.atom]
    for answer, target in ((False, decision.low), (True, decision.high)):
        if answers.get(atom, answer) == answer:
            yield from _ways(monitors, [target, *rest], {**answers, atom: answer})
