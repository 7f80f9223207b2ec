"""Emitted Rust read back: the struct of each property as a step class, and that as a machine."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

from ltlc.assurance.reading.beginnings import CATCH_UP, INVALID, constant, joined
from ltlc.assurance.reading.differences import difference
from ltlc.assurance.reading.expressions import Target
from ltlc.assurance.reading.machines import machine_in
from ltlc.assurance.reading.names import recalls
from ltlc.assurance.reading.outcomes import Difference, ReadBack
from ltlc.assurance.reading.rust_file import Function, RustFile
from ltlc.assurance.reading.rust_text import SINCE, Parser
from ltlc.assurance.reading.trees import (
    DUE,
    NEVER,
    TIME,
    VERDICT,
    Apply,
    Assign,
    Attribute,
    Block,
    Choice,
    Constant,
    Do,
    If,
    Method,
    NotUnderstoodError,
    Return,
    Statement,
    StepClass,
    Tree,
    Variable,
    While,
    shown,
)
from ltlc.backends.rust.expressions import SPELLINGS
from ltlc.program.expressions import Apply as Applied
from ltlc.program.expressions import Held, Kept, News, Read, Recent, Slope, parts
from ltlc.program.functions import ROWS, Row, Spelling, Types
from ltlc.program.machine import Machine
from ltlc.program.types import INTEGER
from ltlc.semantics.verdicts import Verdict

_PRIMITIVES = {row: primitive for primitive, row in ROWS.items()}
_SHARED = frozenset({"History", "Judgement", "Monitors", "Property", "Signals"})
_STEPS = Attribute("judgement.steps")
_COUNTED = Assign(_STEPS, Apply("+", (_STEPS, Constant(1))))
_FIRST: dict[str, Tree] = {"NEVER": NEVER, "-NEVER": Apply("-", (NEVER,)), "false": Constant(False)}
"""What members are at first, but those that are taken at openings or kept for clock steps."""


def _spelling(row: Row, types: Types) -> Spelling | None:
    choose = SPELLINGS.get(_PRIMITIVES[row])
    return None if choose is None else choose(types)


RUST = Target(_spelling, converts=False)


@dataclass(frozen=True)
class Written:
    """What is to be `machine` in a file: the struct called `name`."""

    machine: Machine
    file: RustFile
    name: str

    def read_back(self) -> ReadBack | Difference:
        """Compare the machine that the struct is with the one that it has to be."""
        try:
            of, given = _StructReader(self).step_class()
            found = machine_in(of, self.machine, given, RUST)
        except (NotUnderstoodError, ValueError, RecursionError) as error:
            return Difference(str(error))
        wrong = difference(found, self.machine)
        return ReadBack(len(found.states)) if wrong is None else Difference(wrong)


def written(text: str, machines: Sequence[Machine]) -> Sequence[Written | Difference | None]:
    """What is written of each of `machines`, or its errors; None of those that are not read yet."""
    try:
        file = RustFile(text)
        names = [name for name in file.types if name not in _SHARED]
        if len(names) != len(machines):
            raise NotUnderstoodError(f"there are {len(names)} monitors, not {len(machines)}")
    except (NotUnderstoodError, ValueError) as error:
        return [Difference(str(error))] * len(machines)
    pairs = zip(machines, names, strict=True)
    return [Written(machine, file, name) if is_read(machine) else None for machine, name in pairs]


def is_read(machine: Machine) -> bool:
    """Whether its text can be read: no values are taken at clock steps, nothing is calculated from 64-bit integers."""
    inside = (part for each in (*machine.atoms, *machine.guards) for part in parts(each))
    is_wide = any(isinstance(part, Applied) and part.type == INTEGER for part in inside)
    return not is_wide and not any(outcome.taken for outcome in machine.outcomes)


class _StructReader:
    """The functions of a struct as a step class. All raise NotUnderstoodError."""

    def __init__(self, of: Written) -> None:
        self.file, self.name, self.machine = of.file, of.name, of.machine
        self.functions = of.file.types[of.name]
        words = "".join(re.findall(r"[A-Za-z0-9]+", of.machine.label)).lower()
        if not re.fullmatch(rf"(property)?{words}\d*", of.name.replace("_", "").lower()):
            raise NotUnderstoodError(f"`{of.name}` does not recall `{of.machine.label}`")
        self.is_timed = "expire" in self.functions

    def step_class(self) -> tuple[StepClass, list[Read]]:
        """It, and what its step is given: what it reads of signals first."""
        body = list(self._shown(self.file.function(self.name, "step").block()))
        given: list[Read] = []
        names: list[str] = []
        for read in self.machine.inputs:
            names.append(self._read(body.pop(0), read))
            given.append(read)
        self._require_missed(body, dict(zip(given, names, strict=True)))
        if body.count(_COUNTED) != 1:
            raise NotUnderstoodError("a step is not counted once")
        kept = tuple(
            each.target.name
            for each in body
            if isinstance(each, Assign)
            and isinstance(each.target, Attribute)
            and each.value == Variable(each.target.name)
        )
        self._require_counted(body)
        body.remove(_COUNTED)
        step = (*self._caught_up(), *body, Return(VERDICT))
        methods = {
            name: Method(self._without_time(function.parameters), self._block(function))
            for name, function in self.functions.items()
            if name not in ("new", "step", "expire", "hear")
        }
        if self.is_timed:
            methods["expire"] = Method((), self._block(self.functions["expire"]))
        methods["step"] = Method((*(("time",) if self.is_timed else ()), *names), self._untimed(step))
        ages = self._ages()
        asked = {each.target.name for each in body if isinstance(each, Assign) and isinstance(each.target, Attribute)}
        made = dict(_fields(self.functions["new"].body))
        histories = tuple((name, most) for name, value in made.items() if (most := _depth(value)) is not None)
        methods["start"] = self._start(made, {*asked, *kept, *dict(histories)}, ages)
        return StepClass(self.name, methods, kept, histories, ages), given

    def _block(self, function: Function) -> Block:
        return self._untimed(tuple(self._shown(function.block())))

    def _shown(self, block: Block) -> Iterator[Statement]:
        """Statements without when a verdict came, which stands behind each verdict."""
        for number, statement in enumerate(block):
            is_told = block[number + 1 : number + 2] == (Assign(SINCE, TIME),)
            match statement:
                case Assign(Attribute("verdict")) if not is_told:
                    raise NotUnderstoodError("a verdict comes without its time")
                case Assign(Attribute(SINCE.name)):
                    pass
                case If(guard, then, otherwise):
                    yield If(guard, tuple(self._shown(then)), tuple(self._shown(otherwise)))
                case _:
                    yield statement

    def _require_counted(self, body: Sequence[Statement]) -> None:
        """A step is counted where it is one: before anything is kept, and after what is none has ended."""
        at = body.index(_COUNTED)
        before, after = body[:at], body[at + 1 :]
        may_end = any(isinstance(each, If) and Return(VERDICT) in each.then for each in after)
        is_early = any(isinstance(each, Assign) and isinstance(each.target, Attribute) for each in before)
        if may_end or is_early:
            raise NotUnderstoodError("a step is counted where there is none, or not where there is one")

    def _without_time(self, parameters: tuple[str, ...]) -> tuple[str, ...]:
        return parameters if self.is_timed else tuple(name for name in parameters if name != "time")

    def _untimed(self, block: Block) -> Block:
        """What has no clocks hands on no time."""
        if self.is_timed:
            return block
        found: list[Statement] = []
        for statement in block:
            match statement:
                case If(guard, then, otherwise):
                    found.append(If(guard, self._untimed(then), self._untimed(otherwise)))
                case Do(method, (Variable("time"), *rest)):
                    found.append(Do(method, tuple(rest)))
                case _:
                    found.append(statement)
        return tuple(found)

    def _read(self, statement: Statement, read: Read) -> str:
        """The variable that has the value of an input, read from where its signal is kept."""
        match statement:
            case Assign(Variable(name), value) if self._is_read(self._present(value, read), read):
                return name
            case _:
                raise NotUnderstoodError(f"`{read.signal}` is not read first")

    def _present(self, value: Tree, read: Read) -> Tree:
        """What is read once there is a value; before, of what is not waited for, something else is taken."""
        excused = next((each for each in self.machine.excused if each.input == read), None)
        if excused is None:
            return value
        match value:
            case Choice(Apply("has", (Attribute(place),)), Apply("ago", (Attribute(same), Constant(0))) as now, other):
                if place == same and constant(other) == excused.instead:
                    return now
            case _:
                pass
        raise NotUnderstoodError(f"`{read.signal}` may be read before it has a value")

    def _require_missed(self, body: list[Statement], names: Mapping[Read, str]) -> None:
        """There is no step where messages have come without the value that they should bring."""
        for wanted, news, _ in self.machine.excused:
            match body.pop(0):
                case If(Apply("and", (Apply("not", (Apply("has", (Attribute(place),)),)), *came)), then, ()):
                    told = [Variable(names[each]) for each in news]
                    if _recalls(place, wanted.signal) and came == told and then == (INVALID, Return(VERDICT)):
                        continue
                case _:
                    pass
            raise NotUnderstoodError(f"`{wanted.signal}` may be missing in a step")

    def _is_read(self, value: Tree, read: Read) -> bool:
        match read, value:
            case Held(_, ago), Apply("ago", (Attribute(place), Constant(samples))):
                return samples == ago and _recalls(place, read.signal)
            case Recent(_, ago), Apply("recent", (Attribute(place), Constant(count))):
                return count == ago + 1 and _recalls(place, read.signal)
            case (
                Slope(),
                Apply(
                    "slope",
                    (
                        Apply("-", (Apply("double", (now,)), Apply("double", (before,)))),
                        Apply(
                            "-",
                            (
                                Apply("ago", (Attribute(late), Constant(0))),
                                Apply("ago", (Attribute(early), Constant(1))),
                            ),
                        ),
                    ),
                ),
            ):
                sampled = late.removesuffix("_times")
                right = [Apply("ago", (Attribute(sampled), Constant(samples))) for samples in (0, 1)]
                return [now, before] == right and late == early != sampled and _recalls(sampled, read.signal)
            case News(), Attribute(place):
                return place.startswith("signals.new_")
            case News(), Apply("or", places):
                return all(isinstance(each, Attribute) and each.name.startswith("signals.new_") for each in places)
            case ((Held() | Recent() | Slope() | News() | Kept()), _):
                return False
            case _:
                assert_never(read)

    def _member(self) -> str:
        """What the struct is called in the monitors."""
        made = self.file.function("Monitors", "new").body
        found = [made[at - 2] for at, token in enumerate(made) if token == f"{self.name}::new"]
        if len(found) != 1:
            raise NotUnderstoodError(f"`{self.name}` is not made once")
        return found[0]

    def _caught_up(self) -> Block:
        """Clock steps come before a step: `pass` holds what is due."""
        if not self.is_timed:
            return ()
        due = Attribute(f"{self._member()}.due")
        right = While(Apply(">", (TIME, due)), (Do("expire", ()),))
        for statement in self.file.function("Monitors", "hold").block():
            match statement:
                case While(Apply(">", (Variable("time"), Attribute(due.name))), (Do(method, ()),)):
                    if method == f"{self._member()}.expire":
                        return (CATCH_UP,)
                case _:
                    pass
        raise NotUnderstoodError(f"`hold` does not take the clock steps: {right}")

    def _ages(self) -> Mapping[str, tuple[str, int]]:
        """The ages that `hear` renews, each parameter being told of messages on the topic of a signal."""
        if "hear" not in self.functions:
            return {}
        function = self.functions["hear"]
        signals = list(dict.fromkeys(clock.age.signal for clock in self.machine.clocks if clock.age))
        found: dict[str, tuple[str, int]] = {}
        names = [name for name in function.parameters if name != "time"]
        block = function.block()
        if len(names) != len(signals) or len(block) != len(names):
            raise NotUnderstoodError("`hear` does not pass on the messages from which ages count")
        for name, signal, statement in zip(names, signals, block, strict=True):
            found |= dict(_renewed(statement, name, signal))
        return found

    def _start(self, made: dict[str, list[str]], own: set[str], ages: Mapping[str, tuple[str, int]]) -> Method:
        """What `new` and, of ages, the beginning of a session say; members in `own` begin as anything."""
        if made.pop("judgement", None) != ["Judgement::NEW"] or made.pop("state", None) != ["0"]:
            raise NotUnderstoodError("a monitor begins differently")
        body: list[Statement] = [
            Assign(Attribute("state"), Constant(0)),
            Assign(VERDICT, Constant(Verdict.NOT_STARTED)),
            Assign(Attribute("invalid"), Constant(0)),
        ]
        begun = self._begun()
        for name, value in made.items():
            if name not in own:
                if "".join(value) not in _FIRST or (name in begun and value != ["NEVER"]):
                    raise NotUnderstoodError(f"`{name}` begins differently")
                body.append(Assign(Attribute(name), begun.get(name, _FIRST["".join(value)])))
        if not ages.keys() <= begun.keys() or not begun.keys() <= made.keys():
            raise NotUnderstoodError("an age does not count from the beginning of the session")
        return Method(("session",) if self.is_timed else (), tuple(body))

    def _begun(self) -> dict[str, Tree]:
        prefix, found = f"{self._member()}.", dict[str, Tree]()
        body = self.file.function("Monitors", "begin_session").body
        if body[-2:] != ["true", "}"]:
            raise NotUnderstoodError("the beginning of a session is not marked as such")
        for statement in Parser([*body[:-2], "}"]).block():
            match statement:
                case Assign(Attribute(name), Apply("+", (Variable("time"), duration))) if name.startswith(prefix):
                    found[name.removeprefix(prefix)] = Apply("+", (Variable("session"), duration))
                case _:
                    pass
        return found


def _recalls(place: str, signal: str) -> bool:
    words = "_".join(re.findall(r"[A-Za-z0-9]+", signal))
    return place.startswith("signals.") and recalls(place.removeprefix("signals."), words, [f"signal_{words}"])


def _depth(value: Sequence[str]) -> int | None:
    """How many times a member has room for, if it is one that has times."""
    found = re.fullmatch(r"Times::<(\d+)>::new\(0\)", "".join(value))
    return None if found is None else int(found[1])


def _fields(body: Sequence[str]) -> Iterator[tuple[str, list[str]]]:
    """The members that `Self { … }` gives, with the tokens of their values."""
    inner = list(body[3:-2])
    while inner:
        comma = inner.index(",")
        yield inner[0], inner[2:comma]
        inner = inner[comma + 1 :]


def _renewed(statement: Statement, name: str, signal: str) -> Iterator[tuple[str, tuple[str, int]]]:
    """The ages that a message renews, if that is all it does: one that was late makes a clock step due at once."""
    match statement:
        case If(Variable(told), (at_once, *anew), ()) if told == name:
            clocks = []
            for each in anew:
                match each:
                    case Assign(Attribute(clock), Apply("+", (Variable("time"), Constant(int(duration))))):
                        clocks.append(clock)
                        yield clock, (signal, duration)
                    case _:
                        raise NotUnderstoodError(f"a message of `{signal}` does more than renew ages")
            late = joined("or", [Apply(">", (TIME, Attribute(clock))) for clock in clocks])
            has_begun = Apply("!=", (VERDICT, Constant(Verdict.NOT_STARTED)))
            guard = joined("and", [late, has_begun])
            if at_once == If(guard, (Assign(DUE, Apply("-", (TIME, Constant(1)))),)):
                return
        case _:
            pass
    raise NotUnderstoodError(f"a message of `{signal}` does not renew ages as it should: {shown(Variable(name))}")
