"""What a step does before it decides anything: what names stand for, whether it is a step, and what is kept of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field

from ltlc.assurance.reading.counted import counted, presumed
from ltlc.assurance.reading.expressions import Reader, Target
from ltlc.assurance.reading.trees import (
    DUE,
    NEVER,
    TIME,
    VERDICT,
    Ago,
    Apply,
    Assign,
    Attribute,
    Block,
    Choice,
    Constant,
    Do,
    If,
    NotUnderstoodError,
    Push,
    Return,
    Statement,
    StepClass,
    Tree,
    Unpack,
    Variable,
    While,
    shown,
)
from ltlc.dataclass import dataclass
from ltlc.program.expressions import Apply as Applied
from ltlc.program.expressions import Expression, Held, Kept, News, Recent
from ltlc.program.functions import Primitive
from ltlc.program.machine import Age, Clock, Excused, Instead, Machine, Occurrences
from ltlc.program.normal import normal
from ltlc.semantics.verdicts import Verdict

CATCH_UP = While(Apply(">", (TIME, DUE)), (Do("expire"),))
"""The clock steps that are due are taken."""

STATE = Assign(Variable("state"), Attribute("state"))
_OWN = {"state": Constant(0), "verdict": Constant(Verdict.NOT_STARTED), "invalid": Constant(0)}
_HAS_BEGUN = Apply("!=", (VERDICT, Constant(Verdict.NOT_STARTED)))
INVALID = Assign(Attribute("invalid"), Apply("+", (Attribute("invalid"), Constant(1))))
"""Counts a message that makes no step."""


@dataclass
class Beginning:
    """The statements of `step` are taken off `rest` as they are read. All raise NotUnderstoodError.

    `names` are what local variables stand for; `closed` of each register the states in which it is the latest value,
    None if it always is; `counts` what clocks count, `presumed` after how long those that no count has
    set yet are due, and `noting` the attributes that say whether it held, or when;
    `first` the verdict that a first step sets whatever it decides, if there is one.
    """

    of: StepClass
    like: Machine
    target: Target
    rest: list[Statement]
    names: dict[str, Expression]
    loose: set[str] = field(default_factory=set)
    raw: set[str] = field(default_factory=set)
    held: dict[str, Expression] = field(default_factory=dict)
    ages: dict[str, tuple[str, int]] = field(default_factory=dict)
    closed: list[frozenset[int] | None] = field(default_factory=list)
    guards: tuple[Expression, ...] = ()
    excused: list[Excused] = field(default_factory=list)
    counts: dict[str, Occurrences] = field(default_factory=dict)
    presumed: dict[str, int] = field(default_factory=dict)
    noting: list[str] = field(default_factory=list)
    catches_up: bool = False
    first: Verdict | None = None

    def reader(self) -> Reader:
        """What reads expressions over the names so far."""
        return Reader(self.target, dict(self.names), dict(self.held), frozenset(self.loose))

    def read(self, is_timed: bool) -> None:
        """All up to the first decision."""
        self.catches_up = self._while(self._catching_up)
        heard = self._hearing()
        self._while(lambda statement: self._stand_in(statement, heard is not None))
        self._while(self._conversion)
        if self.raw:
            raise NotUnderstoodError(f"`{min(self.raw)}` is not converted to Python values")
        self._histories()
        self._while(self._value)
        if len(self.closed) != len(self.like.registers) or len(self.of.kept) != len(self.closed):
            raise NotUnderstoodError("a value at an opening is not taken")
        self._guard(is_timed and (not self.catches_up or heard is not None))
        if heard not in (None, bool(self.guards or self.excused)):
            raise NotUnderstoodError("a message that makes no step does not renew an age that is late")
        for number, name in enumerate(self._registers()):
            if not self._drop(Assign(Attribute(self.of.kept[number]), Variable(name))):
                raise NotUnderstoodError("a value at an opening is not kept")
        self._while(self._counted)
        self._while(self._first)
        self._while(self._held)

    def _counted(self, statement: Statement) -> bool:
        """A clock that is late unless something has occurred so often."""
        if (due := presumed(statement)) is not None:
            self.presumed[due[0]] = due[1]
            return True
        found = counted(statement)
        if found is None:
            return False
        depth = dict(self.of.histories).get(found.history)
        names = [found.history, *([found.held] if found.held else [])]
        if depth != found.times or found.clock in self.counts or not set(names).isdisjoint(self.noting):
            raise NotUnderstoodError(f"`{found.clock}` counts differently")
        condition = normal(self.reader().expression(found.condition))
        is_presumed = found.clock in self.presumed
        if is_presumed and self.presumed[found.clock] != found.duration:
            raise NotUnderstoodError(f"`{found.clock}` is first due at a different time")
        begins = found.held is not None
        self.counts[found.clock] = Occurrences(condition, begins, found.times, found.duration, is_presumed)
        self.noting += names
        return True

    def _while(self, part: Callable[[Statement], bool]) -> bool:
        """Read the next statements as long as they are such a part; whether there is one."""
        found = False
        while self.rest and part(self.rest[0]):
            self.rest.pop(0)
            found = True
        return found

    def _drop(self, right: Statement) -> bool:
        if self.rest[:1] != [right]:
            return False
        self.rest.pop(0)
        return True

    def _name(self, name: str, value: Expression) -> None:
        if name in self.names or name in ("time", "state"):
            raise NotUnderstoodError(f"`{name}` is set again")
        self.names[name] = value

    def _registers(self) -> list[str]:
        """The local variables that have the values at openings."""
        return [name for name, value in self.names.items() if isinstance(value, Kept)]

    def _catching_up(self, statement: Statement) -> bool:
        return statement == CATCH_UP and not self.catches_up

    def _hearing(self) -> bool | None:
        """The ages that messages renew; whether those that were late are due at once. None if none is renewed here."""
        found: set[bool] = set()

        def heard(statement: Statement) -> bool:
            match statement:
                case If() if counted(statement) is not None:
                    return False
                case If(Variable(name), then, ()) if isinstance(news := self.names.get(name), News):
                    found.add(self._renewed(news, list(then)))
                    return True
                case _:
                    return False

        self._while(heard)
        if len(found) > 1:
            raise NotUnderstoodError("some messages renew ages that are late, and some do not")
        return found.pop() if found else None

    def _renewed(self, news: News, then: list[Statement]) -> bool:
        renewed = {}
        for statement in then:
            match statement:
                case Assign(Attribute(name), Apply("+", (Variable("time"), Constant(int(duration))))):
                    renewed[name] = (news.signal, duration)
                case _:
                    pass
        late = joined("or", [Apply(">", (TIME, Attribute(name))) for name in renewed])
        at_once = If(joined("and", [late, _HAS_BEGUN]), (Assign(DUE, Apply("-", (TIME, Constant(1)))),))
        is_at_once = then[:1] == [at_once]
        if len(then) != len(renewed) + is_at_once or self.ages.keys() & renewed.keys():
            raise NotUnderstoodError(f"a message of `{news.signal}` does more than renew ages")
        self.ages |= renewed
        return is_at_once

    def _stand_in(self, statement: Statement, catches_up: bool) -> bool:
        """Something else is taken for what has no value; if messages should have brought one, there is no step."""
        match statement:
            case If(Apply("missing", (Variable(name),)), (*guard, Assign(Variable(same), instead)), ()):
                read, told = self.names.get(name), self._news_of(guard, catches_up)
                if name != same or not isinstance(read, Held) or told is None:
                    raise NotUnderstoodError(f"`{name}` must not be handled as missing like this")
                self.excused.append(Excused(read, told, constant(instead)))
                return True
            case _:
                return False

    def _news_of(self, guard: Sequence[Statement], catches_up: bool) -> tuple[News, ...] | None:
        """Where there is no step because all this news has come; None if the statements say something else."""
        match guard:
            case []:
                return ()
            case [If(came, none, ())] if none == (INVALID, *((CATCH_UP,) if catches_up else ()), Return(VERDICT)):
                news = [self.reader().expression(part) for part in _parts(came, "and")]
                told = tuple(each for each in news if isinstance(each, News))
                return told if len(told) == len(news) else None
            case _:
                return None

    def _conversion(self, statement: Statement) -> bool:
        """What a caller gives is made doubles, or an array taken apart."""
        match statement:
            case Assign(Variable(name), Apply("number" | "elements_of" | "doubles_of" as function, (Variable(same),))):
                read = self.names.get(name)
                is_array = isinstance(read, Held) and read.type.is_array
                if name != same or not isinstance(read, Held) or is_array != (function != "number"):
                    raise NotUnderstoodError(f"`{name}` must not be converted by `{function}`")
                if function != "elements_of" and (read.type.scalar.is_wide or not read.type.scalar.is_number):
                    raise NotUnderstoodError(f"`{name}` must not be made a double")
                self.raw.discard(read.signal)
                self.loose -= {read.signal} if function != "elements_of" else set()
                return True
            case _:
                return False

    def _histories(self) -> None:
        """Each sample is added to its history, without enough of them there is no step, and older ones are read."""
        pushed: dict[str, Held] = {}
        counting = {each.history for each in map(counted, self.rest) if each is not None}
        kept = [(name, most) for name, most in self.of.histories if name not in counting]
        depths = dict.fromkeys(dict(kept), 0)

        def push(statement: Statement) -> bool:
            match statement:
                case Push(history, Variable(name)) if history in depths and history not in pushed:
                    read = self.names.get(name)
                    if isinstance(read, Held):
                        pushed[history] = read
                        return True
            return False

        def ago(statement: Statement) -> bool:
            match statement:
                case Assign(Variable(name), Ago(history, samples, all)) if history in pushed and samples > 0:
                    depths[history] = max(depths[history], samples + 1)
                    signal, type_ = pushed[history].signal, pushed[history].type
                    array = Recent(signal, samples, type_._replace(is_array=True))
                    self._name(name, array if all else Held(signal, samples, type_))
                    return True
            return False

        self._while(push)
        short = [Apply("<", (Apply("len", (Attribute(h),)), Constant(most))) for h, most in kept]
        if short and not self._drop(If(joined("or", short), (Return(VERDICT),))):
            raise NotUnderstoodError("samples may be read that are not there")
        self._while(ago)
        if pushed.keys() != depths.keys() or depths != dict(kept):
            raise NotUnderstoodError("a history is not as long as what is read of it")

    def _value(self, statement: Statement) -> bool:
        """A local variable: a value at an opening, or something that is computed."""
        match statement:
            case Assign(Variable(name), value) if statement != STATE:
                if not self._opening(name, value):
                    self._name(name, self.reader().expression(value))
                return True
            case _:
                return False

    def _opening(self, name: str, value: Tree) -> bool:
        """The latest value where the scope is closed, else the one that is kept."""
        number = len(self.closed)
        if number >= min(len(self.of.kept), len(self.like.registers)):
            return False
        closed: frozenset[int] | None = None
        match value:
            case Choice(guard, Variable() as latest, otherwise):
                closed = frozenset(map(_state, _parts(guard)))
                if otherwise != Attribute(self.of.kept[number]):
                    raise NotUnderstoodError(f"`{name}` is not the right value at an opening")
            case Variable() as latest:
                pass
            case _:
                return False
        register = self.like.registers[number]
        if self.names.get(latest.name) != register.latest:
            raise NotUnderstoodError(f"the value at an opening in `{self.of.kept[number]}` is taken elsewhere")
        self._name(name, register.kept)
        self.closed.append(closed)
        return True

    def _guard(self, catches_up: bool) -> None:
        """Where something is NaN there is no step; the clock steps that are due are taken all the same."""
        found: list[Expression] = []
        match self.rest[:1]:
            case [If(test, (first, *_) as then, ()) as guard] if first == INVALID:
                right = (INVALID, *((CATCH_UP,) if catches_up else ()), Return(VERDICT))
                if then != right:
                    raise NotUnderstoodError("an invalid step does more than it should, or less")
                reader = self.reader()
                found += [_undefined(reader, part) for part in _parts(test)]
                self.rest.remove(guard)
            case _:
                pass
        vacuous = {g for g in self.like.guards if not self.target.converts and g.type.scalar.is_integer}
        told = [guard for guard in self.like.guards if guard in found or guard in vacuous]
        self.guards = (*told, *(guard for guard in dict.fromkeys(found) if guard not in told))

    def _first(self, statement: Statement) -> bool:
        """The first step sets the verdict, whatever comes next."""
        match statement:
            case If(Apply("==", (Attribute("verdict"), Constant(Verdict.NOT_STARTED))), then, ()):
                match then:
                    case (Assign(Attribute("verdict"), Constant(Verdict() as verdict)),) if self.first is None:
                        self.first = verdict
                        return True
            case _:
                pass
        return False

    def _held(self, statement: Statement) -> bool:
        """A condition that clock steps ask again."""
        match statement:
            case Assign(Attribute(name), value) if name not in (*_OWN, "due", *self.of.kept, *self.held):
                self.held[name] = self.reader().expression(value)
                return True
            case _:
                return False


def clocks_of(of: StepClass, like: Machine, ages: dict[str, tuple[str, int]], beginning: Beginning) -> dict[str, Clock]:
    """The clocks by their attributes, in the order in which the text declares them. Raises NotUnderstoodError.

    A clock alone may be `due` itself, which then says by nothing but its use that it is one.
    """
    start = of.methods["start"]
    found: dict[str, Tree] = {}
    for statement in start.body:
        match statement:
            case Assign(Attribute(name), value) if name not in found:
                found[name] = value
            case _:
                raise NotUnderstoodError("the function that initialises a monitor differs")
    if {name: found.pop(name, None) for name in _OWN} != _OWN:
        raise NotUnderstoodError("a monitor begins differently")
    is_timed = "expire" in of.methods
    if start.parameters != (("session",) if is_timed else ()) or is_timed != ("due" in found):
        raise NotUnderstoodError("a monitor of time begins with the session, and others do not")
    if is_timed and (len(found) > 1 or not like.clocks) and found.pop("due") != NEVER:
        raise NotUnderstoodError("a clock step is due before the first step")
    histories = dict(of.histories)
    if any(found.pop(name, None) != Constant(False) for name in beginning.noting if name not in histories):
        raise NotUnderstoodError("something has been counted before the first step")
    counts = beginning.counts
    for name, value in found.items():
        right = Apply("+", (Variable("session"), Constant(ages[name][1]))) if name in ages else NEVER
        right = Apply("-", (NEVER,)) if name in counts else right
        if value != right:
            raise NotUnderstoodError(f"`{name}` is {shown(value)} instead of {shown(right)}")
    if not beginning.presumed.keys() <= counts.keys():
        raise NotUnderstoodError("the first step sets a clock")
    if not ages.keys() | counts.keys() <= found.keys() or ages.keys() & counts.keys():
        raise NotUnderstoodError("an age has no clock, or has a count")
    return {name: Clock(Age(*ages[name]) if name in ages else None, counts.get(name)) for name in found}


def taken_back(body: Block, beginning: Beginning, held: Statement | None) -> tuple[frozenset[str], Block]:
    """The names that are known in `expire` when it begins to decide, and what it does from there on.

    `held` is what the step has left of its values. Raises NotUnderstoodError.
    """
    rest, names, own = list(body), set[str](), beginning.names
    if rest[:1] == [Assign(TIME, Apply("+", (DUE, Constant(1))))]:
        rest.pop(0)
        names.add("time")
    match rest[:1], held:
        case [Unpack(targets, Attribute(name))], Assign(Attribute(same), Apply("tuple", values)):
            if name != same or tuple(map(Variable, targets)) != values:
                raise NotUnderstoodError("a clock step judges other values than those of the last step")
            rest.pop(0)
            names |= set(targets)
        case _:
            pass
    while rest and isinstance(rest[0], Assign) and isinstance(rest[0].target, Variable) and rest[0] != STATE:
        name, value = rest[0].target.name, rest[0].value
        visible = {known: each for known, each in own.items() if known in names}
        reader = Reader(beginning.target, visible, _kept(beginning), frozenset(beginning.loose))
        if own.get(name) != reader.expression(value):
            raise NotUnderstoodError(f"`{name}` differs at clock steps")
        rest.pop(0)
        names.add(name)
    return frozenset(names), tuple(rest)


def _kept(beginning: Beginning) -> dict[str, Expression]:
    """What the attributes stand for that keep values at openings."""
    registers = (register.kept for register in beginning.like.registers)
    return dict(zip(beginning.of.kept, registers, strict=True))


def joined(operator: str, parts: Sequence[Tree]) -> Tree:
    """`and` or `or` of one or more."""
    return parts[0] if len(parts) == 1 else Apply(operator, tuple(parts))


def _parts(tree: Tree, function: str = "or") -> tuple[Tree, ...]:
    """What an `or`, or an `and`, is of."""
    return tree.arguments if isinstance(tree, Apply) and tree.function == function else (tree,)


def constant(tree: Tree) -> Instead:
    """What a literal is."""
    match tree:
        case Constant(bool() | int() | float() | str() as value):
            return value
        case Apply("-", (Constant(int() | float() as value),)):
            return -value
        case Apply("tuple", parts):
            return tuple(constant(part) for part in parts)
        case _:
            raise NotUnderstoodError(f"`{shown(tree)}` is not a constant")


def _state(tree: Tree) -> int:
    match tree:
        case Apply("==", (Attribute("state"), Constant(int(number)))):
            return number
        case _:
            raise NotUnderstoodError(f"`{shown(tree)}` does not test the state")


def _undefined(reader: Reader, tree: Tree) -> Expression:
    match reader.expression(tree):
        case Applied(Primitive.NOT, (Applied(Primitive.MEASURED, (inner,)),)):
            return inner
        case _:
            raise NotUnderstoodError(f"`{shown(tree)}` does not test for NaN")
