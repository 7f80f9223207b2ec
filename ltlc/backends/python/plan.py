"""The code from which the runtime makes its plan: signals, monitors, scopes; for `ltlc run` and for emitted nodes."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import field, replace
from importlib import import_module
from pathlib import PurePath
from typing import assert_never

from ltlc.automata import watching
from ltlc.backends.counts import ages
from ltlc.backends.inputs import is_from_session
from ltlc.backends.names import Names, class_name, input_name, variable
from ltlc.backends.python.code import Group, bracketed, layout, literal, tuple_of
from ltlc.backends.python.expressions import python_speller
from ltlc.backends.python.monitors import (
    MODULE_NAMES,
    TYPES,
    VERDICTS,
    instead_text,
    opening_names,
    runtime_class,
)
from ltlc.backends.python.reasons import Reasons
from ltlc.backends.spelling import Speller
from ltlc.backends.trees import INDENT, Code, prose
from ltlc.base.source import Source
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.program.as_new import states_as_new
from ltlc.program.expressions import Apply, reads_of
from ltlc.program.expressions import Expression as Value
from ltlc.program.expressions import parts as parts_of
from ltlc.program.functions import ROWS, Nan, Primitive
from ltlc.program.guards import GuardProgram
from ltlc.program.lowering import has_sample, lowered, predicate, read
from ltlc.program.machine import Machine
from ltlc.program.resting import Held
from ltlc.runtime import MODULES
from ltlc.semantics import properties as p
from ltlc.semantics.denotation import opens_by_itself
from ltlc.semantics.ltl import Formula
from ltlc.semantics.timed_atoms import atoms_within, names_within, timed_atoms
from ltlc.semantics.verdicts import Verdict
from ltlc.specification.expressions import (
    Current,
    Expression,
    Field,
    Input,
    Match,
    New,
    Parallel,
    Past,
    Read,
    Recent,
    Signal,
    Slope,
    openings,
    operands,
    value_type,
)
from ltlc.specification.requirements import Requirement
from ltlc.specification.specification import (
    Instances,
    Path,
    PropertySpecification,
    Slicing,
    Specification,
    fields,
    gone_name,
    parts,
    topics_of,
)
from ltlc.specification.text import predicate_text, read_texts

RUNTIME_NAMES = frozenset(name for module in MODULES for name in vars(import_module(module)))
"""Names of the runtime, which those made from a specification must not hide."""


@dataclass
class _Plan:
    """What has been written so far."""

    source: Source
    given: Collection[str]
    names: Names
    most_ids: int | None = None
    blocks: list[str] = field(default_factory=list)
    signals: dict[Signal, Group] = field(default_factory=dict)


def plan_code(
    compiled: Sequence[Compiled],
    specification: Specification,
    given: Collection[str] = (),
    taken: Collection[str] = (),
    most_ids: int | None = None,
    guards: Sequence[GuardProgram] = (),
) -> str:
    """Definitions of functions and classes, the last a function `plan` that makes the plan.

    Signals whose name is in `given` are readings of a topic with that name, however the specification defines them.
    Functions and classes get names that are neither the runtime's nor in `taken`. An `each` without a limit keeps
    `most_ids`, None is any number. The `guards` keep some of the properties. `Verdict` must be defined before, and the
    other names of the runtime and `INFINITY` when `plan` is called.
    """
    plan = _Plan(specification.source, given, Names(RUNTIME_NAMES | MODULE_NAMES | frozenset(taken)), most_ids)
    properties = [_property(plan, c) for c in compiled]
    parts: tuple[Group | str, ...] = (
        tuple_of(plan.signals.values(), "signals=(", wide=True),
        tuple_of(properties, "properties=(", wide=True),
        f"rate={specification.rate!r}",
        f"timeout={specification.timeout!r}",
        *([tuple_of((_guards(plan, each) for each in guards), "guards=(", wide=True)] if guards else []),
    )
    made = Group("return Plan(", parts, ")", wide=True).lines(INDENT)
    function = ["def plan() -> Plan:", f'{INDENT}"""The signals, each after its parts, and the properties."""', *made]
    return "\n\n\n".join([VERDICTS, *plan.blocks, "\n".join(function)]) + "\n"


def _property(plan: _Plan, compiled: Compiled) -> Group:
    """The description of a property; its class, and the functions of its scopes, become blocks."""
    specification = compiled.specification
    for signal in specification.signals():
        _signal(plan, signal)
    name = plan.names.unique(class_name(specification.label))
    written = runtime_class(compiled, name, plan.source.name)
    plan.blocks.append(written.text.rstrip("\n"))
    arguments: list[Group | str] = [
        f"label={literal(specification.label)}",
        f"file={literal(PurePath(plan.source.name).name)}",
        f"line={specification.line}",
        f"text={literal(specification.text)}",
        tuple_of(map(_input, specification.inputs()), "inputs=("),
        f"monitor={name}",
    ]
    if specification.openings():
        arguments.append(tuple_of(_kept(compiled), "kept=("))
    if written.timed:
        arguments.append("timed=True")
        arguments += _ages(compiled)
    if is_from_session(compiled):
        arguments.append("from_session=True")
    if compiled.machine.excused:
        arguments.append(tuple_of(_excused(compiled), "excused=("))
    if needed := _needed(compiled.machine):
        arguments.append(tuple_of(map(str, needed), "needed=("))
    events: list[Group] = []
    found = [_scope(plan, compiled, scope, events) for scope in scopes(specification, plan.source)]
    if found:
        arguments.append(tuple_of(found, "scopes=(", wide=True))
    if events:
        arguments.append(tuple_of(events, "events=(", wide=True))
    owed = obligations(specification, plan.source)
    if owed:
        arguments.append(tuple_of(map(literal, owed), "obligations=("))
    if Verdict.VIOLATED in compiled.monitor.verdicts:
        arguments += _reasons(plan, compiled)
    if names := list(_written(specification)):
        arguments.append(Group("written={", tuple(names), "}"))
    if specification.requirement:
        arguments.append(_requirement(specification.requirement))
    match specification.slicing:
        case Slicing() as slicing:
            arguments.append(_slicing(plan, compiled, slicing))
        case Instances() as instances:
            arguments.append(_instances(plan, compiled, instances))
        case None:
            pass
        case _:
            assert_never(specification.slicing)
    return Group("MonitoredProperty(", tuple(arguments), ")", wide=True)


def _guards(plan: _Plan, of: GuardProgram) -> Group:
    """Guards that share properties; the functions of conditions become blocks."""
    resting = of.resting
    questions = (Group("Asked(", (f"Asks.{q.asks.name}", str(q.of), str(q.number)), ")") for q in resting.questions)
    parts_: tuple[Group | str, ...] = (
        tuple_of((literal(guard.out) for guard in of.guards), "outs=("),
        f"lead={of.lead}",
        tuple_of(map(str, of.parts), "parts=("),
        tuple_of(map(str, sorted(of.assumed)), "assumed=("),
        tuple_of(map(literal, of.spoken), "spoken=("),
        tuple_of(map(_input, of.awaited), "awaited=("),
        tuple_of(map(str, of.most), "most=("),
        tuple_of([_held(plan, each) for each in resting.conditions], "conditions=(", wide=True),
        tuple_of(questions, "questions=("),
        tuple_of((tuple_of(map(str, decision)) for decision in resting.decisions), "decisions=("),
        f"rests={resting.root}",
    )
    return Group("GuardPlan(", parts_, ")", wide=True)


def _held(plan: _Plan, of: Held) -> Group:
    """A condition that is held: its two functions become blocks."""

    def function(what: str, value: Value, meaning: str) -> str:
        name = plan.names.unique(f"guard_{what}")
        _function(plan, name, of.inputs, "bool", lambda speller: [speller.code(value)], meaning)
        return name

    known = function("known", of.known, "Whether a condition that the guard holds compares no NaN.")
    holds = function("holds", of.holds, "Whether it holds.")
    has_first = any(value is not None for value in of.first)
    first = [tuple_of(literal(v) if isinstance(v, str) else repr(v) for v in of.first)] if has_first else []
    return Group("HeldCondition(", (tuple_of(map(_input, of.inputs)), known, holds, *first), ")")


def _written(specification: PropertySpecification) -> Iterator[str]:
    """The news of fields that the author asks of the whole: `new pos` where the input is called `new pos.x`."""
    for wanted in specification.inputs():
        if isinstance(wanted, New) and wanted.signal.heard != wanted.signal.name:
            yield f"{literal(f'new {wanted.signal.name}')}: {literal(f'new {wanted.signal.heard}')}"


def _requirement(stated: Requirement) -> Group:
    """The requirement that a property states, as it is in JSON."""
    attributes = (
        Group(f"{literal(key)}: [", tuple(map(literal, values)), "]") for key, values in stated.attributes.items()
    )
    parts_ = (
        f'"id": {None if stated.id is None else literal(stated.id)}',
        f'"text": {literal(stated.text)}',
        Group('"attributes": {', tuple(attributes), "}"),
    )
    return Group("requirement={", parts_, "}")


def _slicing(plan: _Plan, compiled: Compiled, slicing: Slicing) -> Group:
    """How the run is sliced: the signals of a slice, among them its id."""
    read = {wanted.signal.name for wanted in compiled.specification.inputs()}
    keys = [_key(slicing, read, key, field) for key in slicing.keys for _, field in fields(key)]
    as_new = states_as_new(compiled.machine, compiled.specification, slicing)
    parts_ = (
        _own_signals(plan, compiled),
        tuple_of(keys, "keys=("),
        f"variable={literal(slicing.variable)}",
        f"limit={slicing.limit or plan.most_ids!r}",
        f"as_new=frozenset({sorted(as_new)!r})",
    )
    return Group("slicing=Slicing(", parts_, ")", wide=True)


def _instances(plan: _Plan, compiled: Compiled, of: Instances) -> Group:
    """What begins the property anew: a message on this topic."""
    _, heard = next(fields(of.signal))
    parts_ = (
        _own_signals(plan, compiled),
        f"name={literal(of.signal.heard)}",
        f"topic={literal(heard.topic)}",
        f"mark={literal(of.mark.name)}",
        f"limit={of.limit or plan.most_ids!r}",
    )
    return Group("slicing=Instances(", parts_, ")", wide=True)


def _own_signals(plan: _Plan, compiled: Compiled) -> Group:
    """The signals of a slice or an instance, each after its parts."""
    inner = replace(plan, signals={})
    for wanted in compiled.specification.inputs():
        _signal(inner, wanted.signal)
    return tuple_of(inner.signals.values(), "signals=(", wide=True)


def _key(slicing: Slicing, read: Collection[str], key: Signal, source: Field) -> Group:
    """The ids on a topic, with the arrays that belong to an array of them; `read` are the signals of a slice."""
    arrays = (array for array in slicing.arrays if source.topic in topics_of(array))
    elements = ", ".join(f"{literal(each.name)}: {literal(slicing.element_of(each))}" for each in arrays)
    more = [f"elements={{{elements}}}"] if elements else []
    if gone_name(key.name) in read:
        more.append(f"gone={literal(gone_name(key.name))}")
    return Group("Key(", (literal(source.topic), literal(key.name), *more), ")")


def _needed(machine: Machine) -> list[int]:
    """The places among the inputs of arrays without whose measurements an expression has no value."""
    applied = (part for guard in machine.guards for part in parts_of(guard) if isinstance(part, Apply))
    folds = (a for a in applied if ROWS[a.primitive].nan is Nan.SKIPS or a.primitive is Primitive.NEAREST)
    needed = {each for fold in folds for each in parts_of(fold)}
    return [place for place, wanted in enumerate(machine.inputs) if wanted in needed and wanted.type.is_array]


def _excused(compiled: Compiled) -> Iterator[Group]:
    """The inputs that are not waited for, the news of them, and the conditions that read them, each by its place."""
    machine = compiled.machine
    for wanted, news, instead in machine.excused:
        reading = [n for n, atom in enumerate(machine.atoms) if news and wanted in reads_of(atom)]
        told: tuple[Group | str, ...] = (
            str(machine.inputs.index(wanted)),
            tuple_of(str(machine.inputs.index(each)) for each in news),
            instead_text(instead),
            *([tuple_of(map(str, reading))] if reading else []),
        )
        yield Group("Excused(", told, ")")


def _kept(compiled: Compiled) -> Iterator[Group]:
    """The values that the monitor keeps from openings; by what the author wrote."""
    names = opening_names(compiled)
    for written, name in zip(read_texts(names), names.values(), strict=True):
        yield Group("Kept(", (literal(written), literal(name)), ")")


def _ages(compiled: Compiled) -> list[Group | str]:
    """The clocks that messages renew."""
    found = ages(compiled.machine)
    told = (Group("Age(", (literal(age.signal), literal(name), str(age.duration)), ")") for name, age in found)
    return [tuple_of(told, "ages=(")] if found else []


def _reasons(plan: _Plan, compiled: Compiled) -> list[Group | str]:
    """What a violation is explained by: the conditions, whose function becomes a block, and what they decide."""
    specification, reasons = compiled.specification, Reasons(compiled)
    arguments: list[Group | str] = []
    if reasons.asked:  # some read nothing but ages, which are no conditions
        name = plan.names.unique(f"{variable(specification.label)}_conditions")
        meaning = f"The conditions of {specification.label}, and what they compare."
        _function(plan, name, specification.reads(), "Iterable[Condition]", reasons.conditions, meaning)
        arguments.append(f"conditions={name}")
    return [*arguments, *reasons.arguments()]


def _input(wanted: Input) -> str:
    name = literal(wanted.signal.name)
    match wanted:
        case Current():
            return f"Input({name})"
        case Past(_, samples):
            return f"Input({name}, {samples})"
        case Recent(_, samples):
            return f"Recent({name}, {samples})"
        case Slope():
            return f"Slope({name})"
        case New():
            return f"New({name})"


def _signal(plan: _Plan, signal: Signal) -> None:
    """Describe `signal`, after what it is computed from."""
    if signal in plan.signals:
        return
    if signal.name in plan.given:
        plan.signals[signal] = _reading(signal, None)
    elif isinstance(signal.definition, Field):
        plan.signals[signal] = _reading(signal, signal.definition)
    else:
        for wanted in signal.inputs:
            _signal(plan, wanted.signal)
        plan.signals[signal] = _derived(plan, signal, signal.definition)


def _reading(signal: Signal, source: Field | None) -> Group:
    entries = [s.value for s in source.path if isinstance(s, Match | Parallel)] if source else []
    entry = [f"entry={literal(entries[0])}"] if entries else []
    topic = literal(source.topic if source else signal.name)
    return Group("Reading(", (literal(signal.name), topic, literal(_reading_type(signal)), *entry), ")")


def _reading_type(signal: Signal) -> str:
    """How the runtime calls what `signal` is: integers that may be no doubles are kept as they are."""
    return signal.type.value.replace("number", "integer") if signal.numbers.is_wide else signal.type.value


def _derived(plan: _Plan, signal: Signal, definition: Expression) -> Group:
    """A signal that is computed: its function becomes a block, and that of when it has samples."""

    def function(result: str, value: Value, meaning: str, name: str) -> str:
        unique = plan.names.unique(variable(name))
        _function(plan, unique, signal.inputs, result, lambda speller: [speller.code(value)], meaning)
        return unique

    functions = [function(TYPES[signal.type], lowered(definition), f"The signal {signal.name}.", signal.name)]
    if signal.when is not None:
        meaning = f"Whether {signal.name} has a sample."
        functions.append(function("bool", has_sample(signal), meaning, f"{signal.name} when"))
    return Group("Derived(", (literal(signal.name), tuple_of(map(_input, signal.inputs)), *functions), ")")


def _function(
    plan: _Plan,
    name: str,
    wanted: Sequence[Read],
    result: str,
    write: Callable[[Speller], Sequence[Code]],
    meaning: str,
) -> None:
    """A function of inputs as a block: what it returns or, if `result` is an iterable, all that it yields."""
    local = Names(RUNTIME_NAMES | MODULE_NAMES)
    names = {i: local.unique(input_name(read(i))) for i in wanted}
    parameters = [f"{name}: {TYPES[value_type(i)]}" for i, name in names.items()]
    lines = bracketed(f"def {name}(", parameters, f") -> {result}:")
    lines.append(f'{INDENT}"""{prose(meaning)}"""')
    statement = "yield" if result.startswith("Iterable") else "return"
    for code in write(python_speller({read(i): name for i, name in names.items()})):
        lines += layout(f"{INDENT}{statement} ", code)
    plan.blocks.append("\n".join(lines))


def _scope(plan: _Plan, compiled: Compiled, scope: ScopePart, events: list[Group]) -> Group:
    """A scope; what judges its events becomes blocks, and those that change between steps are added to `events`."""
    specification = compiled.specification
    conditions = {atom.name: atom.condition for atom in specification.atoms}
    wanted = specification.reads()

    def judge(event: Formula, what: str) -> str:
        if scope.opens_by_itself and timed_atoms(event):
            events.append(_past_event(plan, compiled, event, what))
            return str(len(events) - 1)
        name = plan.names.unique(f"{variable(specification.label)}_{what}")
        meaning = f"Whether the event that {what} {scope.text} happens."
        _function(plan, name, wanted, "bool", lambda speller: [speller.code(predicate(event, conditions))], meaning)
        return name

    arguments: list[Group | str] = [f"text={literal(scope.text)}", f"opens={judge(scope.opening, 'opens')}"]
    if scope.closing is not None:
        arguments.append(f"closes={judge(scope.closing, 'closes')}")
    elif not scope.overlapping:
        arguments.append("limit=1")
    if scope.overlapping:
        arguments.append("overlapping=True")
    if scope.inner:
        inner = [_scope(plan, compiled, part, events) for part in scope.inner]
        arguments.append(tuple_of(inner, "inner=(", wide=True))
    return Group("Scope(", tuple(arguments), ")", wide=True)


def _past_event(plan: _Plan, compiled: Compiled, event: Formula, what: str) -> Group:
    """An event that the past decides; the class that watches it becomes a block."""
    reads = names_within(event)
    atoms = tuple(atom for atom in compiled.specification.atoms if atom.name in reads)
    specification = replace(compiled.specification, text=predicate_text(event), property=p.Now(event), atoms=atoms)
    monitor = watching(event, specification.alphabet)
    watched = replace(compiled, specification=specification, formula=event, monitor=monitor)
    name = plan.names.unique(class_name(f"{specification.label} {what}"))
    plan.blocks.append(
        runtime_class(watched, name, plan.source.name, compiled.specification.inputs()).text.rstrip("\n")
    )
    return Group("PastEvent(", (name, *_ages(watched)), ")")


@dataclass(frozen=True, slots=True)
class ScopePart:
    """A scope keyword in a property: as written up to its body, its events, whether it is judged at every step.

    `inner` are the scope keywords in its body.
    """

    text: str
    opening: Formula
    closing: Formula | None
    overlapping: bool
    inner: tuple[ScopePart, ...]

    @property
    def opens_by_itself(self) -> bool:
        """Whether an episode can open or close between steps."""
        return opens_by_itself(self.opening, self.closing)


def scopes(specification: PropertySpecification, source: Source) -> list[ScopePart]:
    """The `after` and `after_until` that no other scope keyword encloses.

    What is inside `until` is omitted: its scopes end with a step that is no part of them. So is what is inside an
    interval, where events from before open nothing, and scopes with an event that changes between steps and reads a
    value at an opening: the monitor knows it, what watches such events does not.
    """
    kept = {
        atom.name
        for atom in specification.atoms
        if any(True for operand in operands(atom.condition) for _ in openings(operand))
    }

    def is_hidden(opening: Formula, closing: Formula | None) -> bool:
        events = (opening,) if closing is None else (opening, closing)
        watched = filter(timed_atoms, events) if opens_by_itself(opening, closing) else ()
        return any(atom.name in kept for event in watched for atom in atoms_within(event))

    def head(path: Path, keyword: str, events: int) -> str:
        written = [_text(specification, source, (*path, index)) for index in range(events)]
        return f"{keyword} {', '.join(written)}"

    def found(node: p.Property, path: Path, overlapping: bool) -> Iterator[ScopePart]:
        match node:
            case p.After(event, _) if is_hidden(event, None):
                return
            case p.AfterUntil(opening, closing, _) if is_hidden(opening, closing):
                return
            case p.After(event, body):
                inner = tuple(found(body, (*path, 1), overlapping))
                yield ScopePart(head(path, "after", 1), event, None, overlapping, inner)
            case p.AfterUntil(opening, closing, body):
                inner = tuple(found(body, (*path, 2), overlapping))
                yield ScopePart(head(path, "after_until", 2), opening, closing, overlapping, inner)
            case p.Until():
                return
            case p.Within(_, _, start) if start:
                return
            case _:
                inside = overlapping or isinstance(node, p.Always | p.Never | p.Eventually)
                for index, part in enumerate(p.children(node)):
                    yield from found(part, (*path, index), inside)

    return list(found(specification.property, (), overlapping=False))


def obligations(specification: PropertySpecification, source: Source) -> list[str]:
    """The parts of a property that can stay open at the end of a run, each once, as written."""

    def found(node: p.Property, path: Path) -> Iterator[Path]:
        match node:
            case p.Eventually() | p.Until():
                yield path
            case p.Within(_, body) if any(found(body, (*path, 0))):
                yield path
            case p.Never() | p.Not() | p.Within():
                return
            case _:
                for index, part in enumerate(parts(node)):
                    if isinstance(part, p.Property) and not (isinstance(node, p.Implies) and index == 0):
                        yield from found(part, (*path, index))

    texts = (_text(specification, source, path) for path in found(specification.property, ()))
    return list(dict.fromkeys(texts))


def _text(specification: PropertySpecification, source: Source, path: Path) -> str:
    """A part of a property as written; the whole property where the place of the part is not known."""
    span = specification.spans.get(path)
    return specification.text if span is None else specification.excerpt(source, span)
