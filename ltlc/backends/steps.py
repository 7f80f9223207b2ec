"""A monitor as nested conditions: for each state the atoms that it needs, asked one after the other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from typing import assert_never

from ltlc.backends.statements import If, Statement, choice, conjunction, disjunction
from ltlc.backends.trees import Chain, Code, Text
from ltlc.backends.wording import Wording
from ltlc.dataclass import dataclass
from ltlc.program.machine import Base, Machine, Outcome
from ltlc.semantics.monitor import Decision, Target, below

Ask = Callable[[int, bool], Code]
"""Code for: the atom with this number holds, or, with False, does not hold."""

MOST_BRANCHES = 40
"""A state with more outcomes than this has the parts that its decisions share written as methods of their own."""

DEEPEST = 12
"""Decisions nested deeper than this become methods of their own; Python limits the depth of indentation."""

LONGEST_CHAIN = 8
"""With more states than this, the state is found by halving instead of one comparison after the other."""


@dataclass(frozen=True, slots=True)
class Branch:
    """Where a conjunction or disjunction of literals leads."""

    operator: str
    literals: tuple[tuple[int, bool], ...]
    then: Target
    otherwise: Target


@dataclass(frozen=True, slots=True)
class Late:
    """What a step does in one of `states` if a clock step was due before it, which `is_due` asks."""

    states: Set[int]
    is_due: Code
    statements: tuple[Statement, ...]


class Steps:
    """Writes the body of `step` for one machine or, with `held`, that of `expire`, which takes a clock step.

    `take` says how a clock step takes the values of registers, by number. `parameters` are handed on to the methods
    that shared decisions become. The time of the instant is in the local variable `time`, the state before in `state`.
    """

    def __init__(
        self,
        machine: Machine,
        ask: Ask,
        parameters: Sequence[str],
        wording: Wording,
        held: bool = False,
        take: Callable[[Sequence[int]], tuple[Statement, ...]] = lambda registers: (),
    ) -> None:
        self._wording = wording
        self._take = take
        self._machine = machine
        self._ask = ask
        self._parameters = parameters
        self._held = held
        self._edges = [state.expire if held else state.step for state in machine.states]
        self._methods = _shared(machine, self._edges)
        self._wanted: list[int] = []
        self._asks_clocks = not all(clock.is_set for clock in machine.clocks)
        self.clocks = clock_names(machine)

    def asked_atoms(self) -> Set[int]:
        """The atoms that some decision is about; others are about clocks."""
        targets = below(self._machine.decisions, (edge for edge in self._edges if edge is not None))
        asked = {self._machine.decisions[~target].atom for target in targets if target < 0}
        return {atom for atom in asked if atom < len(self._machine.atoms)}

    def busy(self) -> dict[int, tuple[Statement, ...]]:
        """The states in which something happens, and what."""
        blocks = {state: self._state(state) for state in range(len(self._edges))}
        return {state: block for state, block in blocks.items() if block}

    def statements(self, late: Late | None = None) -> tuple[bool, tuple[Statement, ...]]:
        """What takes state and verdict to their values after an instant, where `state` has been read.

        That need not be if the first value is true. A clock step comes in busy states only.
        """
        busy = self.busy()
        if late is None and len(busy) == 1 and (self._held or len(self._edges) == 1):
            return True, next(iter(busy.values()))
        return False, self._among(busy) if late is None else self._or_late(busy, late)

    def _or_late(self, busy: Mapping[int, tuple[Statement, ...]], late: Late) -> tuple[Statement, ...]:
        """The block of the current state, or `late`, which the states without a clock come before if they are few."""
        is_few = len(busy) <= LONGEST_CHAIN
        first = {state: block for state, block in busy.items() if is_few and state not in late.states}
        rest = {state: block for state, block in busy.items() if state not in first}
        return self._among(first, (If(late.is_due, late.statements, self._among(rest)),))

    def _among(
        self, blocks: Mapping[int, tuple[Statement, ...]], otherwise: tuple[Statement, ...] = ()
    ) -> tuple[Statement, ...]:
        """The block of the current state; in states without one, `otherwise`."""
        states = list(blocks)
        if len(states) > LONGEST_CHAIN:
            lower, upper = states[: len(states) // 2], states[len(states) // 2 :]
            sides = [self._among({q: blocks[q] for q in half}) for half in (lower, upper)]
            return (If(_compared("<", upper[0]), sides[0], sides[1]),)
        chain = otherwise
        for state in reversed(states):
            remark = self._machine.states[state].verdict.value.replace("_", " ")
            plain = choice(_compared("==", state), blocks[state], chain)
            chain = (If(plain.guard, plain.then, plain.otherwise, remark),)
        return chain

    def _state(self, state: int) -> tuple[Statement, ...]:
        """The step from `state`. The first step, possibly from state 0 to itself, sets a verdict where none was."""
        first = self._wording.starts(self._machine.states[0].verdict) if state == 0 and not self._held else ()
        edge = self._edges[state]
        return (*first, *(self._unasked(state) if edge is None else self._target(edge, state, 0)))

    def _unasked(self, state: int) -> tuple[Statement, ...]:
        """What is done where no clock step comes: messages that renew ages ask for one, though nothing is judged."""
        is_heard = any(clock.age for clock in self._machine.clocks) and self._machine.states[state].verdict.is_permanent
        return (self._wording.soonest(()),) if is_heard else ()

    def _target(self, target: Target, source: int | None, depth: int) -> tuple[Statement, ...]:
        """Statements that lead to `target` from the state `source`, None where it can be any."""
        if target >= 0:
            return self._leaf(self._machine.outcomes[target], source)
        if depth > 0 and (~target in self._methods or depth > DEEPEST):
            return self._call(~target)
        return self._branch(self._merged(self._machine.decisions[~target]), source, depth)

    def _leaf(self, outcome: Outcome, source: int | None) -> tuple[Statement, ...]:
        target, states = outcome.state, self._machine.states
        statements = self._clocks(outcome)
        if target == source:
            return statements
        move = self._wording.state(target)
        if source is None:
            return (move, *self._wording.settled(states[target].verdict), *statements)
        if states[source].verdict is states[target].verdict:
            return (move, *statements)
        return (move, *self._wording.verdict(states[target].verdict), *statements)

    def _clocks(self, outcome: Outcome) -> tuple[Statement, ...]:
        """What is done to clocks, and to `due`, the last time before the next clock step, and what values are taken."""
        if outcome.taken:
            return self._take(outcome.taken)
        statements = [
            self._wording.clock(self.clocks[clock], self._counted_from(clock, base), duration)
            for clock, base, duration in outcome.sets
        ]
        if outcome.again:
            statements.append(self._wording.again())
        elif self._asks_clocks:
            is_permanent = self._machine.states[outcome.state].verdict.is_permanent
            statements.append(self._wording.soonest(()) if is_permanent else self._wording.schedule())
        elif self.clocks != ["due"] and (statements or _looks_again(self._machine)):
            statements.append(self._wording.soonest(self.clocks))
        return tuple(statements)

    def _counted_from(self, clock: int, base: Base) -> str:
        match base:
            case Base.NOW:
                return "time"
            case Base.JUST_BEFORE:
                return "time - 1"
            case Base.DUE:
                return self.clocks[clock]
            case Base.NEVER:
                return ""
            case _:
                assert_never(base)

    def _call(self, decision: int) -> tuple[Statement, ...]:
        if decision not in self._wanted:
            self._wanted.append(decision)
        return (self._wording.call(self.method(decision), self._parameters),)

    def method(self, decision: int) -> str:
        """The name of the method that a shared decision becomes."""
        return f"_expire_{decision}" if self._held else f"_decide_{decision}"

    def _branch(self, branch: Branch, source: int | None, depth: int) -> tuple[Statement, ...]:
        """One `if` statement; a side that changes nothing is omitted, one that asks further comes last."""
        then = self._target(branch.then, source, depth + 1)
        otherwise = self._target(branch.otherwise, source, depth + 1)
        if then == otherwise:
            return then
        if not then:
            return (choice(self._guard(branch, False), otherwise, ()),)
        if _asks(then) and otherwise and not _asks(otherwise):
            return (choice(self._guard(branch, False), otherwise, then),)
        return (choice(self._guard(branch, True), then, otherwise),)

    def _guard(self, branch: Branch, holds: bool) -> Code:
        """The condition of `branch`, or its negation by De Morgan."""
        parts = [self._asked(atom, value == holds) for atom, value in branch.literals]
        return conjunction(parts) if (branch.operator == "and") == holds else disjunction(parts)

    def _asked(self, atom: int, holds: bool) -> Code:
        """That an atom holds or, behind the atoms, that a clock is late; or not."""
        clock = atom - len(self._machine.atoms)
        return self._ask(atom, holds) if clock < 0 else self._wording.is_late(self.clocks[clock], holds)

    def _merged(self, decision: Decision) -> Branch:
        """`decision` together with those that it is the conjunction or disjunction of."""
        atom, low, high = decision
        alone = Branch("and", ((atom, True),), high, low)
        starts = (
            alone,
            Branch("or", ((atom, True),), high, low),
            Branch("and", ((atom, False),), low, high),
            Branch("or", ((atom, False),), low, high),
        )
        merged = (self._extended(start) for start in starts)
        return next((branch for branch in merged if len(branch.literals) > 1), alone)

    def _extended(self, branch: Branch) -> Branch:
        """Go on as long as the next decision shares one side."""
        while True:
            is_and = branch.operator == "and"
            inner, shared = (branch.then, branch.otherwise) if is_and else (branch.otherwise, branch.then)
            if inner >= 0 or ~inner in self._methods:
                return branch
            atom, low, high = self._machine.decisions[~inner]
            if shared not in (low, high):
                return branch
            value, other = ((shared == low) == is_and), high if shared == low else low
            literals = (*branch.literals, (atom, value))
            then, otherwise = (other, shared) if is_and else (shared, other)
            branch = Branch(branch.operator, literals, then, otherwise)

    def shared(self) -> Iterator[tuple[int, tuple[Statement, ...]]]:
        """The decisions that became methods, with what they do; to be asked after `statements`."""
        done = 0
        while done < len(self._wanted):
            decision = self._wanted[done]
            done += 1
            yield decision, self._target(~decision, None, 0)


def clock_names(machine: Machine) -> list[str]:
    """The attributes that hold the due times of the clocks; a single one that is set may be `due` itself."""
    if len(machine.clocks) == 1 and machine.clocks[0].is_set and not _looks_again(machine):
        return ["due"]
    return [f"due_{clock}" for clock in range(len(machine.clocks))]


def scheduled(machine: Machine, wording: Wording) -> tuple[Statement, ...]:
    """The next clock step is due when a clock is that is set, or asked and not late."""
    clocks = list(zip(clock_names(machine), machine.clocks, strict=True))
    known = [name for name, clock in clocks if clock.is_set]
    statements = [wording.soonest(known)]
    for name in (name for name, clock in clocks if not clock.is_set):
        statements.append(If(wording.is_late(name, False), (wording.soonest(["due", name] if known else [name]),)))
        known = ["due"]
    return tuple(statements)


def _looks_again(machine: Machine) -> bool:
    return any(outcome.again for outcome in machine.outcomes)


def _asks(statements: tuple[Statement, ...]) -> bool:
    return len(statements) == 1 and isinstance(statements[0], If)


def _compared(operator: str, state: int) -> Code:
    return Chain((Text("state"), Text(str(state))), (operator,))


def _shared(machine: Machine, edges: Sequence[Target | None]) -> set[int]:
    """The decisions to be written once because states would become too long: those with several ways to them."""
    branches: dict[Target | None, int] = dict.fromkeys([None, *range(len(machine.outcomes))], 1)
    for number, decision in sorted(enumerate(machine.decisions), key=lambda item: -item[1].atom):
        branches[~number] = branches[decision.low] + branches[decision.high]
    if all(branches[target] <= MOST_BRANCHES for target in edges):
        return set()
    targets = [t for decision in machine.decisions for t in (decision.low, decision.high)]
    targets += [target for target in edges if target is not None]
    ways = Counter(~target for target in targets if target < 0)
    return {decision for decision, count in ways.items() if count > 1 and branches[~decision] > 2}
