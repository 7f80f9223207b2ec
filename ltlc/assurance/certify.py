"""Making certificates: why the verdicts of a monitor are those of its formula. Untrusted; `check` has the last word."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

from ltlc.assurance.residuals import Residuals
from ltlc.assurance.strategies import Strategies
from ltlc.assurance.tableau import MOST_EDGES, MOST_NODES, Tableau, TooLargeError
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.certificate import Certificate, Level, Place, is_run
from ltlc.semantics.diagrams import Diagram, rows
from ltlc.semantics.lasso import holds_on_lasso
from ltlc.semantics.ltl import Formula
from ltlc.semantics.monitor import Monitor
from ltlc.semantics.reset_machine import Clocks, ResetMachine
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Lasso, Letter, Word

MOST_ANNOTATIONS = 5000

Remaining = tuple[Clocks, Diagram]
"""Where the clocks are, and what remains to be satisfied, as a residual."""


def _order(remaining: Remaining) -> tuple[int, str]:
    return remaining[1], repr(remaining[0])


@dataclass(frozen=True, slots=True)
class NotCertified:
    """There is no certificate that the checker accepts, and why.

    `too_large`: because of a limit, named by `reason`. `too_late`: verdicts are right, but may come late.
    """

    reason: str
    too_large: bool = False
    too_late: bool = False


class _FailedError(Exception):
    """Carries a `NotCertified`."""

    def __init__(self, reason: str, too_large: bool) -> None:
        super().__init__(reason)
        self.too_large = too_large


def certify(formula: Formula, alphabet: Alphabet, monitor: Monitor) -> Certificate | NotCertified:
    """A certificate for `monitor` as a monitor of `formula` over the letters of `alphabet`.

    That one comes back does not mean that the monitor is right: `ltlc.semantics.certificate.check` says that. That none
    comes back means that the monitor is wrong, or that the formula is too large for this search.
    """
    try:
        return _Producer(formula, alphabet.restricted_to(monitor.atoms), monitor).certificate()
    except _FailedError as failure:
        return NotCertified(str(failure), failure.too_large)
    except TooLargeError:
        return NotCertified(
            f"the proof of its permanent verdicts takes more than {MOST_NODES:,} cases or {MOST_EDGES:,} steps", True
        )
    except RecursionError:
        return NotCertified("its formula is nested too deeply", True)


class _Producer:
    def __init__(self, formula: Formula, alphabet: Alphabet, monitor: Monitor) -> None:
        self.formula = formula
        self.monitor = monitor
        self.assumption = alphabet.as_formula()
        self.residuals = Residuals(monitor.atoms, self.assumption)
        self.time = ResetMachine(formula)
        self.tableau = Tableau(self.residuals, self.time)
        self.edges = _Edges(monitor, self.residuals, self.time)

    def certificate(self) -> Certificate:
        found, doomed = self._annotate()
        annotations = [sorted(places, key=_order) for places in found]
        return Certificate(
            self.formula,
            self.assumption,
            self.monitor,
            tuple(
                tuple(Place(clocks, self.residuals.formula(residual)) for clocks, residual in places)
                for places in annotations
            ),
            self._levels(doomed),
            tuple(tuple(dict.fromkeys(words)) for words in self._witnesses(annotations)),
        )

    def _annotate(self) -> tuple[list[set[Remaining]], list[Remaining]]:
        """What may remain in each state without a permanent verdict, and what must never be satisfied."""
        annotations: list[set[Remaining]] = [set() for _ in self.monitor.verdicts]
        doomed: dict[Remaining, None] = {}
        todo = [(0, (self.time.initial, self.residuals.of(self.formula)))]
        while todo:
            state, (clocks, residual) = todo.pop()
            match self.monitor.verdicts[state]:
                case Verdict.VIOLATED:
                    doomed[clocks, residual] = None
                case Verdict.SATISFIED:
                    doomed[clocks, self.residuals.diagrams.negation(residual)] = None
                case _ if (clocks, residual) not in annotations[state]:
                    annotations[state].add((clocks, residual))
                    progressed = self.residuals.progress(residual)
                    for move in self.residuals.moves(self.time, clocks):
                        after = self.edges.successors(state, move.letters, progressed)
                        todo.extend((successor, (move.target, left)) for successor, left in after)
            if sum(map(len, annotations)) > MOST_ANNOTATIONS:
                reason = f"what may remain to be satisfied in its states takes more than {MOST_ANNOTATIONS:,} formulas"
                raise _FailedError(reason, too_large=True)
        return annotations, list(doomed)

    def _levels(self, doomed: list[Remaining]) -> tuple[Level, ...]:
        found = self.tableau.judge(doomed)
        if isinstance(found, Lasso):
            raise _FailedError("a verdict that is claimed to be permanent is not", too_large=False)
        return found

    def _witnesses(self, annotations: list[list[Remaining]]) -> Iterator[list[Lasso]]:
        """For each state, infinite words that satisfy and that violate each of its annotations."""
        if self.time.words_are_runs:
            yield from (self._runs(state, places) for state, places in enumerate(annotations))
            return
        strategies = Strategies(self.residuals, self.time, (place for places in annotations for place in places))
        for places in annotations:
            yield [word for place in places for wanted in (True, False) for word in strategies.words(*place, wanted)]

    def _runs(self, state: int, annotations: list[Remaining]) -> list[Lasso]:
        words: list[Lasso] = []
        for clocks in dict.fromkeys(clocks for clocks, _ in annotations):
            words += self.edges.settled_words(state, clocks)
        for clocks, annotation in annotations:
            formula = self.residuals.formula(annotation)
            values = {holds_on_lasso(formula, word) for word in words if is_run(self.time, clocks, word)}
            for wanted, residual in ((True, annotation), (False, self.residuals.diagrams.negation(annotation))):
                word = None if wanted in values else self.tableau.judge([(clocks, residual)])
                if isinstance(word, Lasso):
                    words.append(word)
        return words


class _Edges:
    """The edges of a monitor as diagrams over the letters that exist."""

    def __init__(self, monitor: Monitor, residuals: Residuals, time: ResetMachine) -> None:
        self.time = time
        self.monitor = monitor
        self.residuals = residuals
        self.diagrams = residuals.diagrams
        self._row = rows(self.diagrams, monitor.decisions, self.diagrams.variable)

    def successors(self, state: int, letters: Diagram, progressed: Diagram) -> Iterator[tuple[int, Diagram]]:
        """Each state after `state` with each residual that `letters` leave of `progressed` there."""
        seen: set[tuple[Diagram, ...]] = set()
        stack = [(letters, self._row(self.monitor.edges[state]), progressed)]
        while stack:
            current = stack.pop()
            if current in seen or current[0] == self.diagrams.false:
                continue
            seen.add(current)
            level = min(self._atom(diagram) for diagram in current)
            if level == len(self.residuals.atoms):
                yield self.diagrams.value(current[1]), current[2]
                continue
            stack.append(self._side(current, level, high=False))
            stack.append(self._side(current, level, high=True))

    def _atom(self, diagram: Diagram) -> int:
        """The atom that `diagram` asks first, or the number of atoms if it asks none."""
        count = len(self.residuals.atoms)
        return count if self.diagrams.is_terminal(diagram) else min(self.diagrams.split(diagram)[0], count)

    def _side(
        self, current: tuple[Diagram, Diagram, Diagram], level: int, high: bool
    ) -> tuple[Diagram, Diagram, Diagram]:
        def cofactor(diagram: Diagram) -> Diagram:
            if self._atom(diagram) != level:
                return diagram
            return self.diagrams.split(diagram)[2 if high else 1]

        allowed, target, residual = current
        return cofactor(allowed), cofactor(target), cofactor(residual)

    def letters_to(self, state: int, letters: Diagram) -> dict[int, Letter]:
        """One of `letters` to each state that can come after `state` by them."""
        target = self.diagrams.choose(letters, self._row(self.monitor.edges[state]), self.diagrams.false)
        left = self.residuals.after_letters(target)
        return {self.diagrams.value(terminal): letter for terminal, letter in left.items()}

    def settled_words(self, state: int, clocks: Clocks) -> Iterator[Lasso]:
        """A shortest run from `state` to a verdict of either kind, its last letter repeated forever as time goes on.

        Without `next`, the finite verdict is that of this word: `last_step_for_ever` in `proofs/Stutter.v`.
        """
        wanted = {True, False}
        queue: deque[tuple[int, Clocks, Word]] = deque([(state, clocks, ())])
        seen: set[tuple[int, Clocks]] = set()
        while queue and wanted:
            here, now, word = queue.popleft()
            for move in self.residuals.moves(self.time, now):
                lasts = move.target == now and len(move.fair) == self.time.sets
                for successor, letter in self.letters_to(here, move.letters).items():
                    holds = self.monitor.verdicts[successor].holds
                    if lasts and holds in wanted:
                        wanted.discard(holds)
                        yield Lasso(word, (letter,))
                    if (successor, move.target) not in seen:
                        seen.add((successor, move.target))
                        queue.append((successor, move.target, (*word, letter)))
