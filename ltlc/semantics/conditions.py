"""Conditions: what a formula demands of the current step and of what comes after it, and when two conditions agree.

Coq: `proofs/Conditions.v`, with the same names. There, formulas and conditions are trees; here, equal ones are one
number in a `Conditions`, so that comparing them costs nothing. The answers are the same.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Hashable, Iterable
from dataclasses import field
from enum import Enum
from typing import NamedTuple, TypeVar

from ltlc.dataclass import dataclass
from ltlc.semantics.ltl import TRUE, And, Atom, Formula, Next, Not, Or, Truth, Until, children
from ltlc.semantics.words import Letter

FormulaNumber = int
"""A formula is known by its number in its `Conditions`; its parts have smaller numbers."""

Condition = int
"""A condition is known by its number in its `Conditions`; its parts have smaller numbers."""

Fact = int
"""A fact is an atom at the current step, or a formula judged from the next step on."""

Value = TypeVar("Value")

FALSE_CONDITION: Condition = 0
TRUE_CONDITION: Condition = 1


class Kind(Enum):
    """How a condition is made."""

    CONSTANT = "constant"
    FACT = "fact"
    NEGATION = "negation"
    CONJUNCTION = "conjunction"
    DISJUNCTION = "disjunction"


class Node(NamedTuple):
    """A condition: its kind and parts (or its fact), and what is asked of it often."""

    kind: Kind
    left: int
    right: int
    facts: int
    """The facts in it, as a set of bits."""
    first_fact: Fact | None
    """The leftmost fact. Coq: `first_fact`."""
    first_atom: str | None
    """The leftmost atom of the current step. Coq: `first_atom`."""
    weight: int
    """Its size as a tree. Coq: `weight`."""


class Bound(Enum):
    """What bounds the search for an answer."""

    WORK = "work"
    DEPTH = "depth"


@dataclass(slots=True)
class Memory:
    """What has been found out, and how much work may still be done. Coq: `memory`.

    `met` is the bound that was last met, if any: why an answer may be missing. No answer depends on it.
    """

    budget: int
    known: dict[Hashable, bool] = field(default_factory=dict)
    met: Bound | None = None

    def spend(self, cost: int) -> bool:
        """Take `cost` from the budget, if that much is left. Coq: `spend`."""
        if cost > self.budget:
            self.met = Bound.WORK
            return False
        self.budget -= cost
        return True

    def descend(self, depth: int) -> bool:
        """Whether another case distinction may be made where `depth` more may be nested."""
        if depth == 0:
            self.met = Bound.DEPTH
        return depth > 0


class Conditions:
    """A store of formulas and of conditions, Boolean combinations of facts.

    A condition is simplified as it is made: constants inside it and double negations disappear; nothing else does.
    """

    def __init__(self) -> None:
        self._formulas: list[tuple[Formula, tuple[FormulaNumber, ...]]] = []
        self._formula_numbers: dict[Hashable, FormulaNumber] = {}
        self._seen: dict[int, tuple[Formula, FormulaNumber]] = {}
        self._later: dict[FormulaNumber, Condition] = {}
        self._unfolded: dict[FormulaNumber, Condition] = {}
        self._facts: dict[Hashable, Fact] = {}
        self._nodes: list[Node] = []
        self._conditions: dict[tuple[Kind, int, int], Condition] = {}
        self._assigned: dict[tuple[Condition, Fact, bool], Condition] = {}
        for constant in (FALSE_CONDITION, TRUE_CONDITION):
            self._add(Node(Kind.CONSTANT, constant, -1, 0, None, None, 1))

    def number(self, formula: Formula) -> FormulaNumber:
        """The number of `formula`; equal formulas have the same, atoms being known by their names.

        Shared parts are looked at once, however deep.
        """
        stack = [formula]
        while stack:
            current = stack[-1]
            parts = children(current)
            missing = [part for part in parts if id(part) not in self._seen]
            if id(current) not in self._seen and missing:
                stack.extend(missing)
                continue
            stack.pop()
            if id(current) not in self._seen:
                self._seen[id(current)] = (current, self._number_of(current, parts))
        return self._seen[id(formula)][1]

    def _number_of(self, formula: Formula, parts: Iterable[Formula]) -> FormulaNumber:
        numbers = tuple(self._seen[id(part)][1] for part in parts)
        key = ("atom", formula.name) if isinstance(formula, Atom) else (type(formula).__name__, *numbers)
        found = self._formula_numbers.get(key)
        if found is None:
            found = self._formula_numbers[key] = len(self._formulas)
            self._formulas.append((formula, numbers))
        return found

    def later(self, formula: Formula) -> Condition:
        """`formula` from the next step on; its Boolean operators become those of conditions. Coq: `later`."""
        return self._later_of(self.number(formula))

    def _later_of(self, number: FormulaNumber) -> Condition:
        for each in self._missing(number, self._later):
            formula, parts = self._formulas[each]
            if isinstance(formula, Atom | Next | Until):
                self._later[each] = self._from_next(each)
            else:
                self._later[each] = self._combine(formula, [self._later[part] for part in parts])
        return self._later[number]

    def unfold(self, formula: Formula) -> Condition:
        """`formula` now, in terms of this step's atoms and of formulas from the next step on.

        Coq: `unfold`; it means what `formula` means: `unfold_correct`.
        """
        number = self.number(formula)
        for each in self._missing(number, self._unfolded):
            self._unfolded[each] = self._unfold(each)
        return self._unfolded[number]

    def _unfold(self, number: FormulaNumber) -> Condition:
        formula, parts = self._formulas[number]
        below = [self._unfolded[part] for part in parts]
        match formula:
            case Atom(name):
                return self.at_step(name)
            case Next():
                non_empty = self._from_next(self.number(Until(TRUE, TRUE)))
                return self.conjunction(non_empty, self._later_of(parts[0]))
            case Until():
                return self.disjunction(below[1], self.conjunction(below[0], self._from_next(number)))
            case _:
                return self._combine(formula, below)

    def _combine(self, formula: Formula, parts: list[Condition]) -> Condition:
        """The Boolean operator of `formula`, on conditions."""
        match formula:
            case Truth():
                return TRUE_CONDITION
            case Not():
                return self.negation(parts[0])
            case And():
                return self.conjunction(parts[0], parts[1])
            case Or():
                return self.disjunction(parts[0], parts[1])
            case _:
                raise TypeError(f"not a formula of core LTL: {formula!r}")

    def fold(
        self,
        formula: Formula,
        make: Callable[[Formula, list[Value]], Value],
        values: dict[FormulaNumber, Value] | None = None,
    ) -> Value:
        """The value of `formula`, where `make` gives that of any formula from the values of its parts.

        `values` are those known already, to which this adds.
        """
        number = self.number(formula)
        values = {} if values is None else values
        for each in self._missing(number, values):
            part, below = self._formulas[each]
            values[each] = make(part, [values[number] for number in below])
        return values[number]

    def _missing(self, number: FormulaNumber, done: Container[FormulaNumber]) -> list[FormulaNumber]:
        """`number` and its parts that are not `done`, parts first."""
        found: set[FormulaNumber] = set()
        stack = [number]
        while stack:
            current = stack.pop()
            if current not in done and current not in found:
                found.add(current)
                stack.extend(self._formulas[current][1])
        return sorted(found)

    def at_step(self, atom: str) -> Condition:
        """`atom` holds at the current step. Coq: `AtStep`."""
        return self._fact(("at step", atom), atom)

    def _from_next(self, number: FormulaNumber) -> Condition:
        """A formula holds from the next step on. Coq: `FromNext`."""
        return self._fact(("from next", number), None)

    def _fact(self, key: Hashable, atom: str | None) -> Condition:
        fact = self._facts.setdefault(key, len(self._facts))
        return self._add(Node(Kind.FACT, fact, -1, 1 << fact, fact, atom, 1))

    def _add(self, node: Node) -> Condition:
        key = (node.kind, node.left, node.right)
        found = self._conditions.get(key)
        if found is None:
            found = self._conditions[key] = len(self._nodes)
            self._nodes.append(node)
        return found

    def node(self, condition: Condition) -> Node:
        """How `condition` is made."""
        return self._nodes[condition]

    def fact_of_atom(self, atom: str) -> Fact:
        """The fact that `atom` holds at the current step."""
        return self._nodes[self.at_step(atom)].left

    def negation(self, operand: Condition) -> Condition:
        """True where `operand` is false. Coq: `negation`."""
        if operand <= TRUE_CONDITION:
            return TRUE_CONDITION - operand
        node = self._nodes[operand]
        if node.kind is Kind.NEGATION:
            return node.left
        found = self._conditions.get((Kind.NEGATION, operand, -1))
        if found is not None:
            return found
        return self._add(node._replace(kind=Kind.NEGATION, left=operand, right=-1, weight=node.weight + 1))

    def conjunction(self, left: Condition, right: Condition) -> Condition:
        """True where both are. Coq: `conjunction`."""
        if left <= TRUE_CONDITION:
            return right if left == TRUE_CONDITION else left
        if right <= TRUE_CONDITION:
            return left if right == TRUE_CONDITION else right
        return self._binary(Kind.CONJUNCTION, left, right)

    def disjunction(self, left: Condition, right: Condition) -> Condition:
        """True where at least one is. Coq: `disjunction`."""
        if left <= TRUE_CONDITION:
            return left if left == TRUE_CONDITION else right
        if right <= TRUE_CONDITION:
            return right if right == TRUE_CONDITION else left
        return self._binary(Kind.DISJUNCTION, left, right)

    def _binary(self, kind: Kind, left: Condition, right: Condition) -> Condition:
        found = self._conditions.get((kind, left, right))
        if found is not None:
            return found
        a, b = self._nodes[left], self._nodes[right]
        first_fact = b.first_fact if a.first_fact is None else a.first_fact
        first_atom = b.first_atom if a.first_atom is None else a.first_atom
        return self._add(Node(kind, left, right, a.facts | b.facts, first_fact, first_atom, 1 + a.weight + b.weight))

    def later_any(self, formulas: Iterable[Formula]) -> Condition:
        """At least one of `formulas`, from the next step on. Coq: `later_any`."""
        result = FALSE_CONDITION
        for formula in reversed(tuple(formulas)):
            result = self.disjunction(self.later(formula), result)
        return result

    def assign(self, fact: Fact, value: bool, condition: Condition) -> Condition:
        """`condition` where it is known whether `fact` holds. Coq: `assign`."""
        bit = 1 << fact
        if not self._nodes[condition].facts & bit:
            return condition
        assigned = self._assigned
        for each in self._unassigned(condition, fact, value):
            node = self._nodes[each]
            if node.kind is Kind.FACT:
                assigned[each, fact, value] = TRUE_CONDITION if value else FALSE_CONDITION
                continue
            left = assigned.get((node.left, fact, value), node.left)
            if node.kind is Kind.NEGATION:
                assigned[each, fact, value] = self.negation(left)
                continue
            right = assigned.get((node.right, fact, value), node.right)
            make = self.conjunction if node.kind is Kind.CONJUNCTION else self.disjunction
            assigned[each, fact, value] = make(left, right)
        return assigned[condition, fact, value]

    def _unassigned(self, condition: Condition, fact: Fact, value: bool) -> list[Condition]:
        """The parts of `condition` with `fact` in them for which `assign` has not been worked out, parts first."""
        bit = 1 << fact
        found: set[Condition] = set()
        stack = [condition]
        while stack:
            current = stack.pop()
            node = self._nodes[current]
            if not node.facts & bit or current in found or (current, fact, value) in self._assigned:
                continue
            found.add(current)
            if node.kind is not Kind.FACT:
                stack.append(node.left)
                if node.right >= 0:
                    stack.append(node.right)
        return sorted(found)

    def atoms_for(self, depth: int, condition: Condition) -> Letter:
        """Atoms that make `condition` true if they hold and no other does: those that can, one after the other.

        Coq: `atoms_for`. Whether they do is for the caller to see.
        """
        found: set[str] = set()
        for _ in range(depth):
            atom = self._nodes[condition].first_atom
            if atom is None:
                break
            fact = self.fact_of_atom(atom)
            assigned = self.assign(fact, True, condition)
            if assigned == FALSE_CONDITION:
                condition = self.assign(fact, False, condition)
            else:
                condition = assigned
                found.add(atom)
        return frozenset(found)

    def equivalent(self, depth: int, left: Condition, right: Condition, memory: Memory) -> bool:
        """Whether `left` and `right` are found to be true in the same cases, within `depth` nested case distinctions.

        Coq: `equivalent`, `equivalent_sound`. False also means that the work allowed was not enough.
        """
        if left == right:
            return True
        a, b = self._nodes[left], self._nodes[right]
        fact = b.first_fact if a.first_fact is None else a.first_fact
        if fact is None or not memory.descend(depth) or not memory.spend(a.weight + b.weight):
            return False
        known = memory.known.get((left, right))
        if known is not None:
            return known
        answer = all(
            self.equivalent(depth - 1, self.assign(fact, value, left), self.assign(fact, value, right), memory)
            for value in (True, False)
        )
        memory.known[left, right] = answer
        return answer

    def follows(self, depth: int, condition: Condition, conclusion: Condition, memory: Memory) -> bool:
        """Whether `conclusion` is found to be true wherever `condition` is. Coq: `follows`, `follows_sound`."""
        return self.equivalent(depth, self.disjunction(self.negation(condition), conclusion), TRUE_CONDITION, memory)
