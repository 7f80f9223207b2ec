"""Guards, and the messages that they may send: topics, types and constants are looked up and checked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.base.diagnostics import Diagnostic, Help, Label
from ltlc.base.fixes import respell, write, writing
from ltlc.base.source import Span
from ltlc.frontend.language.define import topic_name
from ltlc.frontend.language.evaluate import value
from ltlc.frontend.language.names import Checker
from ltlc.frontend.language.references import constant_beside, is_short_constant
from ltlc.frontend.language.signals import from_field
from ltlc.frontend.language.types import field_of, numbers_of_type, value_kind, values_in
from ltlc.frontend.language.values import Scalar, Text, Truth, expressions
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.lexer import skip_blank
from ltlc.inputs.messages.definitions import FieldType
from ltlc.inputs.messages.texts import text_of
from ltlc.specification.expressions import Boolean, Current, Field, Number, PathStep, Signal, String
from ltlc.specification.guards import Constant, Fallback, FieldPath, Guard
from ltlc.specification.specification import PropertySpecification, topics
from ltlc.specification.text import number_text
from ltlc.specification.wire import Kind, Numbers

_NOUNS = {"number": "a number", "boolean": "a boolean", "string": "a string"}


def guards(checker: Checker, tree: syntax.SyntaxTree, stated: Sequence[PropertySpecification]) -> tuple[Guard, ...]:
    """The guards of a file whose properties without errors are `stated`; those with errors are reported and omitted."""
    commands = [command for command in tree.commands if isinstance(command, syntax.Guard)]
    given = {command.name.text: command for command in tree.commands if isinstance(command, syntax.Setting)}
    if not commands:
        if "_lead_" in given and tree.lost is None:
            checker.report("LTL104", given["_lead_"].name.span, "`_lead_` is not used: the file has no guard")
        return ()
    if "_rate_" in given:
        _report_rate(checker, given["_rate_"])
    messages: dict[str, syntax.Message] = {}
    for command in tree.commands:
        if isinstance(command, syntax.Message):
            messages.setdefault(command.name.text, command)
    ends: dict[str, syntax.Word] = {}
    found = [_guard(checker, command, messages, ends) for command in commands]
    for command in tree.commands:
        if isinstance(command, syntax.PropertyCommand) and command.label is not None:
            _check_label(checker, command.label)
    sound = tuple(guard for guard in found if guard is not None)
    for guard in sound:
        _check_properties(checker, guard, stated)
    _check_chains(checker, commands, ends)
    return sound


def read_as_commands(checker: Checker, found: Sequence[Guard], used: set[str]) -> Iterator[str]:
    """The names declared on what a guard takes in whose fields are `used` of what it lets through.

    In a table, they are the columns with the commands.
    """
    for guard in found:
        let_through = {path for name in used for path in _paths(checker, name, guard.out)}
        yield from (n for n in checker.names.declarations if not let_through.isdisjoint(_paths(checker, n, guard.raw)))


def _paths(checker: Checker, name: str, topic: str) -> set[tuple[PathStep, ...]]:
    """The paths of the fields of a topic that a declared name reads."""
    definitions = (signal.definition for signal in _signals(checker, name))
    return {of.path for of in definitions if isinstance(of, Field) and of.topic == topic}


def _signals(checker: Checker, name: str) -> Iterator[Signal]:
    """The signals that a declared name is made of."""
    declared = checker.names.declarations.get(name)
    parts = expressions(declared) if declared is not None else ()
    return (part.signal for part in parts if isinstance(part, Current))


_ASSUMING = ("assume", "assumes", "assumption")


def _check_label(checker: Checker, label: syntax.Word) -> None:
    """An assumption with a colon would be a property, which is kept."""
    if label.text.lower() in _ASSUMING:
        colon = Span(label.span.start, skip_blank(checker.source.text, label.span.end) + 1)
        message = f"`{label.text}` is a label here, and the property is not assumed"
        help = Help("an assumption is written without a colon", (writing(colon, "assume"),))
        checker.report("LTL114", label.span, message, help=help)


def _report_rate(checker: Checker, setting: syntax.Setting) -> None:
    message = "a file with a guard has no `_rate_`: a guard answers each message when it comes"
    checker.report("LTL114", setting.span, message, help="omit `_rate_`, or put the guard into a file of its own")


def _guard(
    checker: Checker, command: syntax.Guard, messages: dict[str, syntax.Message], ends: dict[str, syntax.Word]
) -> Guard | None:
    """The guard of `command`; `ends` gets what it sends on."""
    raw, out = topic_name(checker, command.raw), topic_name(checker, command.out)
    if raw is None or out is None:
        return None
    if raw == out:
        message = f"the guard would answer itself: commands come on `{raw}`, and leave on the same topic"
        help = f"for example `guard {raw}_raw to {out}`, with the controller remapped to `{raw}_raw`"
        checker.report("LTL114", command.out.span, message, help=help)
        return None
    first = ends.setdefault(out, command.out)
    if first is not command.out:
        message = f"two guards send on `{out}`"
        checker.report("LTL114", command.out.span, message, Label(first.span, "the first"))
        return None
    type_ = _type(checker, command, raw, out)
    fallbacks = [_fallback(checker, word, command, messages, type_) for word in command.fallbacks]
    if type_ is None or None in fallbacks:
        return None
    signals = (signal for name in checker.names.declarations for signal in _signals(checker, name))
    asked = tuple(s for s in signals if isinstance(s.definition, Field) and s.definition.topic == raw)
    found = tuple(each for each in fallbacks if each is not None)
    return Guard(raw, out, type_, found, command.span, asked, text_of(type_, checker.types.messages))


def _type(checker: Checker, command: syntax.Guard, raw: str, out: str) -> str | None:
    """The type of what a guard takes in and lets through, by the declarations; None if an error was reported."""
    declared = checker.names.topics
    if out not in declared:
        near = respell(command.out.span, out, declared, is_closed=True)
        help = near or f"declare a value in its messages, as in `decl speed {out} Twist.linear.x`"
        checker.report("LTL114", command.out.span, f"nothing is declared on `{out}`: its type is unknown", help=help)
        return None
    type_, place = declared[out]
    if raw in declared and declared[raw][0] != type_:
        other, elsewhere = declared[raw]
        message = f"the messages on `{raw}` and on `{out}` have different types: `{other}` and `{type_}`"
        labels = Label(elsewhere, f"`{raw}` here"), Label(place, f"`{out}` here")
        checker.report("LTL114", command.raw.span, message, *labels, help="a guard passes messages on as they are")
        return None
    return type_


def _fallback(
    checker: Checker,
    name: syntax.Word,
    guard: syntax.Guard,
    messages: dict[str, syntax.Message],
    type_: str | None,
) -> Fallback | None:
    """The message that a guard may send, by its name."""
    twice = next((word for word in guard.fallbacks if word.text == name.text), name)
    if twice is not name:
        checker.report("LTL114", name.span, f"`{name.text}` is a fallback twice", Label(twice.span, "the first"))
        return None
    if name.text not in messages:
        if name.text in checker.lost:
            return None
        help = respell(name.span, name.text, messages) or f"define it, as in `message {name.text} {{}}`"
        checker.report("LTL101", name.span, f"there is no message `{name.text}`", help=help)
        return None
    if type_ is None:
        return None
    values: dict[FieldPath, Constant] = {}
    places: dict[FieldPath, Span] = {}
    command = messages[name.text]
    for each in command.constants:
        found = _constant(checker, each, type_)
        if found is None:
            continue
        path, constant = found
        if path in values:
            message = f"`{checker.written(each.path)}` is given twice"
            checker.report("LTL241", each.path.span, message, Label(places[path], "the first"))
        values[path] = constant
        places.setdefault(path, each.path.span)
    return Fallback(name.text, values, command.span) if len(values) == len(command.constants) else None


def _constant(checker: Checker, node: syntax.Constant, message: str) -> tuple[FieldPath, Constant] | None:
    """The field of a message that `node` gives a value, and that value; None if an error was reported."""
    type_ = FieldType(message)
    path: FieldPath = ()
    for step in (node.path.name, *node.path.steps):
        if not isinstance(step, syntax.Word):
            text = "a message gives no value to elements of arrays: they are empty, or zero"
            checker.report("LTL241", step.span, text, help="omit it")
            return None
        found = field_of(checker.source, step, type_, checker.types)
        if isinstance(found, Diagnostic):
            checker.diagnostics.append(found)
            return None
        path, type_ = (*path, step.text), found[1]
    kind = value_kind(type_, checker.types)
    if kind not in _NOUNS:
        _report_no_single_value(checker, node, type_)
        return None
    field = Field("", message, path, numbers_of_type(type_, checker.types))
    constant = _value(checker, node, kind, field)
    return None if constant is None else (path, constant)


def _report_no_single_value(checker: Checker, node: syntax.Constant, type_: FieldType) -> None:
    written = checker.written(node.path)
    if type_.is_list:
        omit = "omit it: an array that is not named is empty, or zero"
        checker.report("LTL241", node.path.span, f"`{written}` is an array: a message gives arrays no value", help=omit)
        return
    inside = values_in(type_.base, checker.types) if type_.base in checker.types.messages else []
    fixes = [writing(node.path.span, f"{written}.{path}") for path in inside[:3]]
    message = f"`{written}` is `{type_}`, not a single value"
    checker.report("LTL241", node.path.span, message, help=write(*fixes) if fixes else "")


def _value(checker: Checker, node: syntax.Constant, kind: str, field: Field) -> Constant | None:
    """The constant that `node` gives to `field`; None if an error was reported."""
    written, target = node.value, checker.written(node.path)
    if isinstance(written, syntax.Reference) and is_short_constant(checker, written):
        found = constant_beside(checker, written, from_field(target, kind, field))
    else:
        found = value(checker, written)
    match found:
        case None:
            return None
        case Scalar(Number(number)) if kind == "number":
            return _number(checker, node, number, field.numbers)
        case Truth(Boolean() as constant) if kind == "boolean":
            return constant
        case Text(String() as constant) if kind == "string":
            return constant
        case Scalar(Number()) | Truth(Boolean()) | Text(String()):
            given = f"`{target}` is {_NOUNS[kind]}, but `{checker.written(written)}` is {found.noun}"
            checker.report("LTL241", written.span, given)
        case _:
            message = f"`{checker.written(written)}` is not a constant: a message is always the same"
            checker.report("LTL215", written.span, message)
    return None


def _number(checker: Checker, node: syntax.Constant, number: float, numbers: Numbers) -> Constant | None:
    """A number that the field can have: rounded to binary32 where it is one."""
    nearest = numbers.nearest(number) if numbers.kind is not Kind.INTEGER else number
    if numbers.has(nearest):
        return Number(nearest, single=numbers.kind is Kind.SINGLE)
    whole = "a whole number " if numbers.kind is Kind.INTEGER else ""
    bounds = f"{whole}from {number_text(numbers.least)} to {number_text(numbers.most)}"
    target = checker.written(node.path)
    checker.report(
        "LTL241", node.value.span, f"`{checker.written(node.value)}` is out of range: `{target}` is {bounds}"
    )
    return None


def _check_properties(checker: Checker, guard: Guard, stated: Sequence[PropertySpecification]) -> None:
    """A guard keeps at least one property, and neither keeps nor relies on one of `each`."""
    kept = [each for each in stated if not each.is_assumed and guard.out in topics(each)]
    for each in [*kept, *(each for each in stated if each.is_assumed)]:
        if each.slicing is not None:
            message = f"a guard cannot {'rely on' if each.is_assumed else 'keep'} a property of `each`"
            help = "state it without `each`, or put it into another file, where it is only monitored"
            checker.report("LTL114", each.span, message, Label(guard.span, "the guard"), help=help)
    if kept or checker.has_failed:
        return
    message = f"the guard keeps nothing: no property reads `{guard.out}`"
    help = f"properties speak of what the guard lets through: `{guard.out}`"
    checker.report("LTL115", guard.span, message, help=help)


def _check_chains(checker: Checker, commands: Sequence[syntax.Guard], ends: dict[str, syntax.Word]) -> None:
    """What one guard of a file sends is not what another one takes in."""
    for command in commands:
        raw = command.raw.text if command.raw.text[0] in "/~" else f"/{command.raw.text}"
        if raw in ends and ends[raw] is not command.out:
            message = f"`{raw}` is what another guard of this file sends"
            help = "write the two guards into files of their own, or as one"
            checker.report("LTL114", command.raw.span, message, Label(ends[raw].span, "sent here"), help=help)
