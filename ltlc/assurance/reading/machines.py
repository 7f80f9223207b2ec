"""A step class in the small language as a machine: what it does from each state on, as decisions in normal form.

Told is only what no text can say: types and order of what is read, the numbering of atoms, which scope a value at an
opening is of. All else is read; that it is right is for `==` to say.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial, reduce
from typing import NamedTuple

from ltlc.assurance.reading.beginnings import CATCH_UP, STATE, Beginning, clocks_of, taken_back
from ltlc.assurance.reading.expressions import Reader, Target
from ltlc.assurance.reading.trees import (
    DUE,
    NEVER,
    TIME,
    VERDICT,
    Apply,
    Assign,
    Attribute,
    Block,
    Constant,
    Do,
    If,
    NotUnderstoodError,
    Return,
    Statement,
    StepClass,
    Tree,
    Variable,
    shown,
)
from ltlc.program.expressions import Apply as Applied
from ltlc.program.expressions import Expression, Literal, News, Read, reads_of, replaced
from ltlc.program.functions import Primitive
from ltlc.program.machine import Base, Machine, Outcome, Register, Set, State
from ltlc.program.normal import Literals, normal, pack, positive, reached
from ltlc.semantics.diagrams import Diagram, Diagrams
from ltlc.semantics.verdicts import Verdict


def machine_in(of: StepClass, like: Machine, given: Sequence[Read], target: Target, loose: bool = False) -> Machine:
    """The machine that `of` is, whose step is given the values of `given` after the time; `like` tells what it cannot.

    With `loose`, numbers may come as integers, arrays as anything that has elements, and None for what is not waited
    for, which else whoever gives the values sees to. Raises NotUnderstoodError.
    """
    try:
        return _Reading(of, like, given, target, loose).machine()
    except (IndexError, KeyError, RecursionError, TypeError, ValueError) as error:
        raise NotUnderstoodError(f"it is not a monitor: {error!r}") from None


class _Effect(NamedTuple):
    """What a way through the statements has done so far; `due` is what it says of the next clock step.

    `taken` are the registers whose values a clock step takes, and `anew` the attributes that hold conditions of them.
    """

    state: int | None = None
    verdict: Verdict | None = None
    sets: tuple[Set, ...] = ()
    due: Tree | None = None
    taken: tuple[int, ...] = ()
    anew: tuple[str, ...] = ()


class _Place(NamedTuple):
    """The state in which an instant finds the monitor, whether it is a clock step, and the names that are known."""

    state: int
    by_time: bool
    names: frozenset[str]


SCHEDULED = Attribute("the first clock to be due, of those asked the ones not late")


class _Reading:
    def __init__(self, of: StepClass, like: Machine, given: Sequence[Read], target: Target, loose: bool) -> None:
        self.of, self.like, self.loose = of, like, loose
        self.is_timed = "expire" in of.methods
        self.beginning = self._beginning(given, target, loose)
        self.beginning.read(self.is_timed)
        ages = self.beginning.ages if of.ages is None else dict(of.ages)
        self.clocks = clocks_of(of, like, ages, self.beginning)
        self.has_ages = any(clock.age for clock in self.clocks.values())
        self.asks_clocks = not all(clock.is_set for clock in self.clocks.values())
        self.schedule = self._schedule()
        self.step, held = self._decisions(self.beginning.rest)
        self._require_apart(held)
        self.step_names = frozenset({*self.beginning.names, *(("time",) if self.is_timed else ())})
        expire = of.methods["expire"].body if self.is_timed else ()
        self.expire_names, self.expire = taken_back(expire, self.beginning, held)
        self.diagrams = Diagrams()
        self.levels = {atom: level for level, atom in enumerate(like.atoms)}
        self.verdicts: dict[int, Verdict] = {} if self.beginning.first is None else {0: self.beginning.first}
        self.rows: dict[tuple[int, bool], Diagram] = {}
        self.known: dict[tuple[str, _Place, _Effect], Diagram] = {}
        self.asks_late: set[int] = set()
        self.leaves_due = self.looks_again = False

    def _beginning(self, given: Sequence[Read], target: Target, loose: bool) -> Beginning:
        parameters = self.of.methods["step"].parameters
        time, names = parameters[: int(self.is_timed)], parameters[int(self.is_timed) :]
        if time != ("time",) * self.is_timed or len(names) != len(given) or "time" in names:
            raise NotUnderstoodError(f"a step takes {len(names)} values, not {len(given)}")
        signals = {read.signal for read in given if read.type.scalar.is_number and not read.type.scalar.is_wide}
        arrays = {read.signal for read in given if read.type.is_array}
        body = list(self.of.methods["step"].body)
        known = dict[str, Expression](zip(names, given, strict=True))
        return Beginning(self.of, self.like, target, body, known, *((signals, arrays) if loose else (set(), set())))

    def _require_apart(self, held: Statement | None) -> None:
        """No attribute is called like another one, or like a method, which it would hide. Raises NotUnderstoodError."""
        own = ["state", "verdict", "invalid", *(["due"] if self.is_timed else [])]
        clocks = (name for name in self.clocks if name != "due")
        names = [*own, *clocks, *self.of.kept, *dict(self.of.histories), *self.beginning.held, *self.of.methods]
        names += [name for name in self.beginning.noting if name not in dict(self.of.histories)]
        match held:
            case Assign(Attribute(name)):
                names.append(name)
            case _:
                pass
        if len(set(names)) < len(names):
            raise NotUnderstoodError("an attribute has the name of something else")

    def _decisions(self, rest: Sequence[Statement]) -> tuple[Block, Statement | None]:
        """The decisions of a step, without what it answers, and what it leaves for clock steps."""
        if rest[-1:] != [Return(VERDICT)]:
            raise NotUnderstoodError("it does not return the verdict")
        match rest[-2:-1]:
            case [Assign(Attribute(), Apply("tuple")) as held]:
                return tuple(rest[:-2]), held
            case _:
                return tuple(rest[:-1]), None

    def _schedule(self) -> Block:
        """What makes the next clock step due when the first clock is, of ages the first that is not late."""
        started = [name for name, clock in self.clocks.items() if clock.is_set]
        asked = [name for name, clock in self.clocks.items() if not clock.is_set]
        found: list[Statement] = [Assign(DUE, least(started))]
        for name in asked:
            among = [name] if not started and name == asked[0] else ["due", name]
            found.append(If(Apply("<=", (TIME, Attribute(name))), (Assign(DUE, least(among)),)))
        return tuple(found)

    def machine(self) -> Machine:
        """What is reached from state 0."""
        steps, expires = partial(self.row, by_time=False), partial(self.row, by_time=True)
        values = self.diagrams.values
        states, waits = reached(
            lambda q: values(steps(q)), lambda q: values(expires(q)) if self.is_timed else (), self._is_aging
        )
        count = len(self.like.states)
        if states != tuple(range(count)):
            raise NotUnderstoodError(f"it does not have {count} states")
        self.verdicts.setdefault(0, self.like.states[0].verdict)  # which no text says if nothing leads back there
        if self.looks_again and self.leaves_due:
            raise NotUnderstoodError("`due` keeps its value, which may be in the past")
        if not self.beginning.catches_up and not waits <= self.asks_late:
            raise NotUnderstoodError(f"in state {min(waits - self.asks_late)}, a clock step that is due is not taken")
        self._require_ended()
        roots = [*map(steps, range(count)), *(expires(q) if q in waits else None for q in range(count))]
        packed = pack(self.diagrams, roots, self.like.atoms)
        after = [step for step in packed.targets[:count] if step is not None]
        verdicts = [self.verdicts[q] for q in range(count)]
        return Machine(
            self.like.label,
            self.like.text,
            self.like.line,
            tuple(read for read in self.like.inputs if read in self.beginning.names.values()),
            self.beginning.guards,
            packed.atoms,
            tuple(self.clocks.values()),
            tuple(self._registers(count)),
            tuple(map(State, verdicts, after, packed.targets[count:])),
            packed.decisions,
            packed.outcomes,
            tuple(self.beginning.excused) if self.loose else self.like.excused,
        )

    def _registers(self, count: int) -> list[Register]:
        every = frozenset(range(count))
        pairs = zip(self.like.registers, self.beginning.closed, strict=True)
        return [Register(register.kept, every if closed is None else closed) for register, closed in pairs]

    def _is_aging(self, state: int) -> bool:
        return self.asks_clocks and not self.verdicts[state].is_permanent

    def _require_ended(self) -> None:
        """Messages renew ages even where the verdict is permanent: then nothing is judged, and nothing due."""
        for state, verdict in self.verdicts.items() if self.has_ages else ():
            place = _Place(state, True, self.expire_names)
            ended = self.diagrams.terminal(_Effect(due=NEVER))
            if verdict.is_permanent and self._run(self.expire, place, _Effect()) != ended:
                raise NotUnderstoodError(f"in state {state}, a clock step is judged after a permanent verdict")

    def row(self, state: int, by_time: bool) -> Diagram:
        """Where an instant leads from a state: the values are outcomes."""
        if (state, by_time) not in self.rows:
            try:
                self.rows[state, by_time] = self._row(state, by_time)
            except NotUnderstoodError as error:
                instant = " at a clock step" if by_time else ""
                raise NotUnderstoodError(f"in state {state}{instant}, {error}") from None
        return self.rows[state, by_time]

    def _row(self, state: int, by_time: bool) -> Diagram:
        place = _Place(state, by_time, self.expire_names if by_time else self.step_names)
        found = self._run(self.expire if by_time else self.step, place, _Effect())
        return self.diagrams.relabel(lambda effect: self._outcome(effect, place), [found])[0]

    def _run(self, block: Block, place: _Place, effect: _Effect) -> Diagram:
        """What `block` does after `effect`: the values are effects. What branches stands last in its block."""
        for number, statement in enumerate(block):
            is_last = number == len(block) - 1
            match statement:
                case If() if is_last:
                    return self._branched(statement, place, effect)
                case Do(method, (Variable("time"),)) if self._is_schedule(method) and effect.due is None:
                    effect = effect._replace(due=SCHEDULED)
                case Do(method, arguments) if is_last:
                    return self._called(method, arguments, place, effect)
                case Assign() if statement == STATE and number == 0:
                    place = place._replace(names=place.names | {"state"})
                case Assign(target, value):
                    effect = self._assigned(target, value, place, effect)
                case _:
                    raise NotUnderstoodError(f"`{statement}` is not an outcome of a decision")
        return self.diagrams.terminal(effect)

    def _branched(self, statement: If, place: _Place, effect: _Effect) -> Diagram:
        if statement.guard == CATCH_UP.guard and not place.by_time:
            self._require_begun_anew(statement.then, effect)
            self.asks_late.add(place.state)
            return self._run(statement.otherwise, place, effect)
        where = self._condition(statement.guard, place)
        if where == self.diagrams.true:
            return self._run(statement.then, place, effect)
        if where == self.diagrams.false:
            return self._run(statement.otherwise, place, effect)
        then, otherwise = (self._run(side, place, effect) for side in (statement.then, statement.otherwise))
        return self.diagrams.choose(where, then, otherwise)

    def _require_begun_anew(self, then: Block, effect: _Effect) -> None:
        again = Do("step", tuple(map(Variable, self.of.methods["step"].parameters)))
        if then != (Do("expire"), Return(again)) or effect != _Effect() or self.of.histories or self.asks_clocks:
            raise NotUnderstoodError("after a clock step, the step is not taken with the values that it was given")

    def _is_schedule(self, method: str) -> bool:
        called = self.of.methods.get(method)
        return (
            self.asks_clocks and called is not None and (called.parameters, called.body) == (("time",), self.schedule)
        )

    def _called(self, name: str, arguments: tuple[Tree, ...], place: _Place, effect: _Effect) -> Diagram:
        """A method that decisions share: it is handed on what it calls so itself."""
        if name in ("start", "step", "expire") or name not in self.of.methods:
            raise NotUnderstoodError(f"`{name}` is not called so")
        method = self.of.methods[name]
        if arguments != tuple(map(Variable, method.parameters)) or not place.names >= set(method.parameters):
            raise NotUnderstoodError(f"`{name}` is not passed its arguments")
        inner = place._replace(names=frozenset(method.parameters))
        key = name, inner, effect
        if key not in self.known:
            self.known[key] = self._run(method.body, inner, effect)
        return self.known[key]

    def _assigned(self, target: Variable | Attribute, value: Tree, place: _Place, effect: _Effect) -> _Effect:
        match target, value:
            case Attribute("state"), Constant(int(number)) if effect.state is None:
                return effect._replace(state=number)
            case Attribute("verdict"), Constant(Verdict() as verdict):
                self._show(place.state if effect.state is None else effect.state, verdict)
                return effect._replace(verdict=verdict)
            case Attribute(name), _ if name in self.clocks and self.clocks[name].is_set and effect.due is None:
                return effect._replace(sets=(*effect.sets, self._set(name, value, place)))
            case Attribute("due"), _ if "due" not in self.clocks and effect.due is None:
                return effect._replace(due=value)
            case Attribute(name), Variable(latest) if name in self.of.kept and place.by_time and latest in place.names:
                number = self.of.kept.index(name)
                if self.beginning.names.get(latest) == self.like.registers[number].latest:
                    return effect._replace(taken=(*effect.taken, number))
            case Attribute(name), Attribute(latest) if place.by_time and latest in self.beginning.held:
                if (renewed := self._renewed(name, self.beginning.held[latest], effect)) is not None:
                    return renewed
            case _:
                pass
        raise NotUnderstoodError(f"`{shown(target)} = {shown(value)}` is not an outcome of a decision")

    def _renewed(self, name: str, latest: Expression, effect: _Effect) -> _Effect | None:
        """At a clock step, a value at an opening, or a condition of such values, is what the last step has held."""
        if name in self.of.kept:
            number = self.of.kept.index(name)
            is_latest = latest == self.like.registers[number].latest
            return effect._replace(taken=(*effect.taken, number)) if is_latest else None
        registers = [self.like.registers[number] for number in effect.taken]
        before = self.beginning.held.get(name)
        if before is None or latest != normal(replaced(before, {each.kept: each.latest for each in registers})):
            return None
        return effect._replace(anew=(*effect.anew, name))

    def _asked_anew(self, taken: Sequence[int]) -> set[str]:
        """The attributes that hold conditions of the values of registers."""
        kept = {self.like.registers[number].kept for number in taken}
        held = self.beginning.held.items()
        return {name for name, condition in held if not kept.isdisjoint(reads_of(condition))}

    def _set(self, name: str, value: Tree, place: _Place) -> Set:
        number = list(self.clocks).index(name)
        time = TIME if "time" in place.names else None
        match value:
            case Apply("never", ()):
                return Set(number, Base.NEVER)
            case Apply("+", (Attribute(same), Constant(int(more)))) if same == name:
                return Set(number, Base.DUE, more)
            case Apply("+", (since, Constant(int(more)))) if since == time:
                return Set(number, Base.NOW, more)
            case Apply("+", (Apply("-", (since, Constant(1))), Constant(int(more)))) if since == time:
                return Set(number, Base.JUST_BEFORE, more)
            case _:
                raise NotUnderstoodError(f"`{name}` is {shown(value)}, which is not a due time")

    def _show(self, state: int, verdict: Verdict) -> None:
        if self.verdicts.setdefault(state, verdict) is not verdict:
            raise NotUnderstoodError(
                f"`verdict` is {verdict.name} instead of {self.verdicts[state].name} in state {state}"
            )

    def _outcome(self, effect: _Effect, place: _Place) -> Outcome:
        state = place.state if effect.state is None else effect.state
        if effect.verdict is None and place.state == 0 and not place.by_time and self.beginning.first is None:
            raise NotUnderstoodError("the first step sets no verdict")
        self._show(state, self.verdicts[place.state] if effect.verdict is None else effect.verdict)
        clocks = [each.clock for each in effect.sets]
        if (effect.taken and (effect.sets or effect.due is not None)) or len(set(clocks)) < len(clocks):
            raise NotUnderstoodError("a clock is set twice, or while values are taken")
        if set(effect.anew) != self._asked_anew(effect.taken):
            raise NotUnderstoodError("held conditions are not evaluated again with the values that are taken")
        if effect.taken:
            return Outcome(state, (), False, tuple(sorted(effect.taken)))
        self._require_due(effect, self.verdicts[state])
        return Outcome(state, tuple(sorted(effect.sets)), effect.due == TIME)

    def _require_due(self, effect: _Effect, verdict: Verdict) -> None:
        """`due` is when the next clock step comes: a nanosecond later, or with the first clock that is late."""
        of_ages = NEVER if verdict.is_permanent else SCHEDULED
        right = of_ages if self.asks_clocks else least(list(self.clocks))
        if effect.due is None:
            self.leaves_due = True
            if self.asks_clocks or (effect.sets and "due" not in self.clocks):
                raise NotUnderstoodError(f"`due` is not {shown(right)}")
        elif effect.due == TIME and not verdict.is_permanent:
            self.looks_again = True
        elif effect.due != right:
            raise NotUnderstoodError(f"`due` is {shown(effect.due)} instead of {shown(right)}")

    def _condition(self, tree: Tree, place: _Place) -> Diagram:
        """Where a condition of the state, of clocks and of values is true."""
        match tree:
            case Apply("==" | "<" as relation, (Variable("state"), Constant(int(number)))) if "state" in place.names:
                return self.diagrams.terminal(place.state == number if relation == "==" else place.state < number)
            case Apply(">" | "<=" as relation, (Variable("time"), Attribute(name))) if (
                name in self.clocks and "time" in place.names
            ):
                late = self.diagrams.variable(len(self.like.atoms) + list(self.clocks).index(name))
                return late if relation == ">" else self.diagrams.negation(late)
            case Apply("not", (inner,)):
                return self.diagrams.negation(self._condition(inner, place))
            case Apply("and" | "or" as operator, operands):
                return self._joined(operator == "and", _flat(operator, operands), place)
            case _:
                return self._literal(self._positive(tree, place), tree, place)

    def _joined(self, is_and: bool, operands: Sequence[Tree], place: _Place) -> Diagram:
        """Of some parts together, an atom may consist, such as `-m <= x` and `x <= m`, or its negation."""
        left = [(tree, self._compared(tree, place)) for tree in operands]
        parts: list[Diagram] = []
        for atom, consists in self._compound().items():
            wanted = consists if _is_and(atom) == is_and else {Literals(a, not holds) for a, holds in consists}
            literals = [literal for _, literal in left]
            if wanted <= set(literals):
                found = {literals.index(literal) for literal in wanted}
                left = [each for number, each in enumerate(left) if number not in found]
                parts.append(self._asked(Literals(atom, _is_and(atom) == is_and)))
        parts += [self._condition(tree, place) for tree, _ in left]
        return reduce(self.diagrams.conjunction if is_and else self.diagrams.disjunction, parts)

    def _compound(self) -> Mapping[Applied, set[Literals]]:
        """The atoms that are conjunctions or disjunctions, with what they consist of."""
        compound = (a for a in self.levels if isinstance(a, Applied) and a.primitive in (Primitive.AND, Primitive.OR))
        return {atom: set(map(positive, atom.arguments)) for atom in compound}

    def _compared(self, tree: Tree, place: _Place) -> Literals | None:
        """The condition of a comparison, unless it is one of states or times."""
        match tree:
            case Apply("<" | "<=" | ">" | ">=" | "==" | "!=" | "measured", (first, *_)) if first not in (
                TIME,
                Variable("state"),
            ):
                return self._positive(tree, place)
            case Apply("not", (inner,)) if (negated := self._compared(inner, place)) is not None:
                return Literals(negated.atom, not negated.holds)
            case _:
                return None

    def _positive(self, tree: Tree, place: _Place) -> Literals:
        names = {name: value for name, value in self.beginning.names.items() if name in place.names}
        held = self.beginning.held if place.by_time else {}
        reader = Reader(self.beginning.target, names, held, frozenset(self.beginning.loose))
        return positive(reader.expression(tree))

    def _asked(self, literal: Literals) -> Diagram:
        asked = self.diagrams.variable(self.levels[literal.atom])
        return asked if literal.holds else self.diagrams.negation(asked)

    def _literal(self, literal: Literals, tree: Tree, place: _Place) -> Diagram:
        if isinstance(literal.atom, Literal):
            return self.diagrams.terminal(literal.atom.value == literal.holds)
        if literal.atom not in self.levels:
            raise NotUnderstoodError(f"`{shown(tree)}` is not a condition of the property")
        if place.by_time and any(isinstance(read, News) for read in reads_of(literal.atom)):
            raise NotUnderstoodError(f"`{shown(tree)}` is evaluated after the news is over")
        return self._asked(literal)


def least(names: Sequence[str]) -> Tree:
    """The earliest of the times that attributes have."""
    attributes = tuple(map(Attribute, names))
    return Apply("min", attributes) if len(names) > 1 else attributes[0] if names else NEVER


def _is_and(atom: Applied) -> bool:
    return atom.primitive is Primitive.AND


def _flat(operator: str, operands: Sequence[Tree]) -> list[Tree]:
    found: list[Tree] = []
    for each in operands:
        match each:
            case Apply(same, inner) if same == operator:
                found += _flat(operator, inner)
            case _:
                found.append(each)
    return found
