"""Values: every expression of the language is given its type and written out over signals."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from ltlc.base.diagnostics import Help, Label
from ltlc.base.fixes import respell, write, writing
from ltlc.frontend.language.built import Context
from ltlc.frontend.language.durations import nanoseconds
from ltlc.frontend.language.elements import counted, holding
from ltlc.frontend.language.names import Checker, Sort
from ltlc.frontend.language.references import (
    constant_beside,
    ground_truth,
    is_short_constant,
    is_unknown,
    kind,
    member,
    message_constant,
    messages,
    no_field,
    referent,
    unknown,
)
from ltlc.frontend.language.values import (
    AgeOf,
    Array,
    Duration,
    Message,
    Scalar,
    SignalOf,
    Text,
    Truth,
    Value,
    Vector,
    Zone,
    alone,
    arithmetic,
    beside,
    call,
    expressions,
    negative,
    sampled,
    signal_alone,
    signal_or_computed,
)
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.lexer import FUNCTIONS, KEYWORDS
from ltlc.specification.expressions import (
    Boolean,
    Call,
    Current,
    Expression,
    New,
    Number,
    Opening,
    Operator,
    Past,
    Recent,
    Signal,
    String,
    ValueType,
    reads,
)
from ltlc.specification.functions import INSIDE, WRITTEN, Function
from ltlc.specification.numbers import numbers_of
from ltlc.specification.specification import gone_name, topics_of
from ltlc.specification.text import predicate_text, text
from ltlc.specification.wire import as_double, double_or_integer

LARGEST = 2.0**64
"""No integer in a message is larger."""

MAX_HISTORY = 99_999
"""How many samples back a specification can look: they are all kept in memory."""


def _never_has_a_value(expression: Expression) -> bool:
    """Whether it has none, whatever it is computed from."""
    match expression:
        case Number(constant):
            return math.isnan(constant)
        case Call(Function.MOD, (_, Number(0.0))):
            return True
        case _:
            return False


def value(checker: Checker, node: syntax.Node) -> Value | None:
    """The value of `node`, of an array where that is wanted each element; None if an error was reported."""
    found = whole(checker, node)
    return found.element if checker.elementwise and isinstance(found, Array) else found


def whole(checker: Checker, node: syntax.Node) -> Value | None:
    """The value of `node`, an orientation by itself being its yaw; None if an error was reported."""
    found = _value(checker, node)
    if found is None:
        return None
    if isinstance(found, Message):
        no_field(checker, node.span, found)
        return None
    if any(map(_never_has_a_value, expressions(found))):
        message = f"`{checker.written(node)}` has no value: it is not a number"
        checker.report("LTL213", node.span, message)
        return None
    return alone(found)


def compared(checker: Checker, left: syntax.Node, right: syntax.Node) -> tuple[Value | None, Value | None]:
    """The values of two sides that are compared: a constant of a message is looked up where the other side is from."""
    if isinstance(left, syntax.Reference) and is_short_constant(checker, left):
        other = value(checker, right)
        return constant_beside(checker, left, other), other
    found = value(checker, left)
    if isinstance(right, syntax.Reference) and is_short_constant(checker, right):
        return found, constant_beside(checker, right, found)
    return found, value(checker, right)


def _value(checker: Checker, node: syntax.Node) -> Value | None:
    match node:
        case syntax.NumberLiteral():
            return Scalar(Number(_number(node.text)))
        case syntax.DurationLiteral():
            duration = nanoseconds(checker, node)
            return None if duration is None else Duration(duration)
        case syntax.Parameter():
            message = "`?` has no value yet: it stands for one to be found from recordings"
            checker.report(
                "LTL840", node.span, message, help="`ltlc mine PROPS RECORDING…` finds it; otherwise write a value"
            )
            return None
        case syntax.News(_, signal):
            heard = heard_of(checker, signal, "new")
            return None if heard is None else Truth(New(heard))
        case syntax.Gone(_, key):
            return _gone(checker, node, key)
        case syntax.StringLiteral(_, content):
            return Text(String(content))
        case syntax.BooleanLiteral(_, truth):
            return Truth(Boolean(truth))
        case syntax.Reference():
            return referent(checker, node)
        case syntax.Selection(_, base, steps):
            return member(checker, steps, _value(checker, base))
        case syntax.MessageConstant():
            return message_constant(checker, node)
        case syntax.Call():
            return _call(checker, node)
        case syntax.Quantified(_, quantifier) if quantifier.text == "count":
            count = counted(checker, node, Context(polarity=0))
            return None if count is None else Scalar(count)
        case syntax.History():
            return _history(checker, node)
        case syntax.Recent():
            return _recent(checker, node)
        case syntax.Latch():
            return _latch(checker, node)
        case syntax.Minus():
            return _minus(checker, node)
        case syntax.Arithmetic():
            return _arithmetic(checker, node)
        case _:
            pass
    _report_property(checker, node)
    return None


def _report_property(checker: Checker, node: syntax.Node) -> None:
    checker.report("LTL206", node.span, f"`{checker.written(node)}` is a property, but a value is needed here")


def of_zone(checker: Checker, node: syntax.Call, function: Function) -> Call | None:
    """A function of a point, or its x and y, and of a zone, whose corners are the last arguments."""
    last = node.arguments[-1] if len(node.arguments) > 1 else None
    if isinstance(last, syntax.Reference) and is_unknown(checker, last):
        unknown(checker, last, defined=f"`zone {last.name.text} = [(x, y), …]` defines a zone by its corners")
        return None
    found = [value(checker, argument) for argument in node.arguments]
    match found:
        case [Vector((x, y, _)), Zone(name, corners)] | [Scalar(x), Scalar(y), Zone(name, corners)]:
            numbers = (Number(coordinate) for corner in corners for coordinate in corner)
            return Call(function, (x, y, *numbers), name)
        case _ if None not in found:
            given = ", ".join(each.noun for each in found if each is not None)
            message = f"`{function.value}` takes {function.takes.words}, not {given}"
            help = "`zone NAME = [(x, y), …]` defines a zone by its corners"
            checker.report("LTL207", node.span, message, help=help)
        case _:
            pass
    return None


def _gone(checker: Checker, node: syntax.Node, key: syntax.Node) -> Value | None:
    """Whether an id was missing in the last array of ids, of which a slice has a signal."""
    found = checker.names.declarations.get(gone_name(checker.written(key)))
    if found is None:
        message = f"`{checker.written(key)}` is not an array that is a key of this property"
        help = "in `each g of goal: P`, `gone goal` means that the last message has no element with the id g"
        checker.report("LTL113", node.span, message, help=help)
    return found


def _number(text: str) -> float:
    """The double nearest to what `text` writes; integers that no double equals stay exact if messages can have them."""
    double = float(text)
    return double_or_integer(int(text)) if text.isdigit() and double <= LARGEST else double


def literal(checker: Checker, node: syntax.Node) -> float | None:
    """The number that `node` is without any name in it; None if an error was reported.

    Settings and places hold for the whole file, wherever they stand: nothing is defined before them.
    """
    named = next((part for part, _ in syntax.walk(node) if isinstance(part, syntax.Reference)), None)
    if named is not None:
        checker.report("LTL215", named.span, f"`{checker.written(named)}` is a name, but a number is needed here")
        return None
    return constant(checker, node)


def constant(checker: Checker, node: syntax.Node) -> float | None:
    """The number that `node` is; None if an error was reported."""
    found = value(checker, node)
    if found is None:
        return None
    if isinstance(found, Scalar) and isinstance(found.expression, Number):
        return as_double(found.expression.value)
    help = "write the number itself" if isinstance(found, Duration) else ""
    checker.report("LTL215", node.span, f"`{checker.written(node)}` is not a constant number", help=help)
    return None


_OF_EACH = "inside `any(…)`, `all(…)` and `count(…)` this applies to each element"


_CHANGES = dict.fromkeys(
    ("derivative", "deriv", "diff", "gradient", "slope", "der", "d"),
    ("({0} - @{{{0}, -1}})", "the change since the previous sample; `X.velocity` is the change per second"),
)
_PREVIOUS = dict.fromkeys(("previous", "prev", "pre", "lag"), ("@{{{0}, -1}}", "the sample before the latest"))
_AVERAGES = dict.fromkeys(("average", "avg"), ("mean({0})", "of the elements of an array"))
_OTHERS = {**_CHANGES, **_PREVIOUS, **_AVERAGES}
"""What others call functions of a signal, how these are written, and what that is."""

_RATE = "compare a rate with one in Hz, by `>=` or `<`, as in `rate(v) >= 10 Hz over 1 s`"


def _call(checker: Checker, node: syntax.Call) -> Value | None:
    name = node.function.text
    if name not in FUNCTIONS:
        if name in _OTHERS and len(node.arguments) == 1:
            form, meaning = _OTHERS[name]
            fix = writing(node.span, form.format(checker.written(node.arguments[0])))
            written = Help(f"{fix.title}, {meaning}", (fix,))
            checker.report("LTL107", node.function.span, f"there is no function `{name}`", help=written)
            return None
        place, listed = node.function.span, "the functions are " + ", ".join(f"`{f}`" for f in FUNCTIONS)
        help = _RATE if name == "rate" else respell(place, name, FUNCTIONS, is_closed=True)
        help = help or respell(place, name, KEYWORDS) or listed
        checker.report("LTL107", place, f"there is no function `{name}`", help=help)
        return None
    if name == "age":
        return _age(checker, node)
    if name == "norm":
        return _norm(checker, node)
    function = WRITTEN[name]
    if name == INSIDE:
        _report_property(checker, node)
        return None
    if function.takes.zone:
        found = of_zone(checker, node, function)
        return None if found is None else Scalar(found)
    if function.takes.among:
        return _among(checker, node, function)
    if function.takes.array and len(node.arguments) == 1:
        array = whole(checker, node.arguments[0])
        if isinstance(array, Array) and (function is Function.LEN or array.elements is ValueType.NUMBER):
            return Scalar(call(function, expressions(array)))
    arguments = [value(checker, argument) for argument in node.arguments]
    known = [argument for argument in arguments if argument is not None]
    return None if len(known) < len(arguments) else _apply(checker, node, function, known)


def _of_samples(checker: Checker, name: str, argument: syntax.Node) -> Help:
    """How `name` is taken of the last samples of a number."""
    if isinstance(argument, syntax.History) and argument.otherwise is None:  # `@{v, -9}` for `@{v, -9:}`
        form = f"@{{{checker.written(argument.signal)}, {checker.written(argument.offset)}:}}"
        return Help(f"write `{name}({form})` for all samples since that one", (writing(argument.span, form),))
    form = f"@{{{checker.written(argument)}, -9:}}"
    return Help(f"write `{name}({form})` for its last 10 samples", (writing(argument.span, form),))


def _among(checker: Checker, node: syntax.Call, function: Function) -> Value | None:
    """A function of a number and of an array of numbers, which is not taken for its elements."""
    *others, last = node.arguments
    found = [*(value(checker, other) for other in others), whole(checker, last)]
    match found:
        case [Scalar(sought), Array(array, ValueType.NUMBER)]:
            return Scalar(Call(function, (sought, array)))
        case _ if None not in found:
            given = ", ".join(each.noun for each in found if each is not None)
            checker.report("LTL207", node.span, f"`{function.value}` takes {function.takes.words}, not {given}")
        case _:
            pass
    return None


def _norm(checker: Checker, node: syntax.Call) -> Value | None:
    """`norm(v)`, the length of a vector."""
    first, *others = (value(checker, argument) for argument in node.arguments)
    if isinstance(first, Vector) and not others:
        return Scalar(call(Function.NORM, first.components))
    if first is not None:
        wrong = (
            f"not {len(node.arguments)}" if others else f"but `{checker.written(node.arguments[0])}` is {first.noun}"
        )
        help = "for numbers, use `hypot(x, y)` or `hypot(x, y, z)`"
        checker.report("LTL207", node.span, f"`norm` takes one vector, {wrong}", help=help)
    return None


def _age(checker: Checker, node: syntax.Call) -> Value | None:
    """`age(s)`, which is compared with durations."""
    if len(node.arguments) > 1:
        checker.report("LTL207", node.span, f"`age` takes one signal, not {len(node.arguments)}")
        return None
    heard = heard_of(checker, node.arguments[0], "age")
    return None if heard is None else AgeOf(heard)


def heard_of(checker: Checker, node: syntax.Node, word: str) -> Signal | None:
    """The signal whose messages `new`, `age` or `rate` is of: one that comes from one topic, or an object that does."""
    found = ground_truth(checker, node) or messages(checker, node) or value(checker, node)
    if found is None:
        return None
    parts = expressions(found)
    signals = [part.signal for part in parts if isinstance(part, Current)]
    topics = tuple(dict.fromkeys(topic for signal in signals for topic in topics_of(signal)))
    if len(topics) == 1 and len(signals) == len(parts):
        return signals[0]
    what = (
        f"comes from {', '.join(topics)}" if len(signals) == len(parts) and topics else f"is {found.noun}, not a signal"
    )
    message = f"`{word}` needs the messages of one topic, but `{checker.written(node)}` {what}"
    checker.report("LTL219", node.span, message, help="name a declared signal, an object, or an attribute of a model")
    return None


def _apply(checker: Checker, node: syntax.Call, function: Function, arguments: list[Value]) -> Value | None:
    """A function of numbers."""
    name, takes = function.value, function.takes
    if not takes.least:
        (argument,) = node.arguments if len(node.arguments) == 1 else (None,)
        is_number = argument is not None and isinstance(arguments[0], Scalar)
        help = _of_samples(checker, name, argument) if is_number and argument is not None else ""
        checker.report("LTL207", node.span, f"`{name}` takes {takes.words}", help=help)
        return None
    wrong = next((i for i, argument in enumerate(arguments) if not isinstance(argument, Scalar)), None)
    if wrong is not None:
        message = f"`{name}` takes numbers, but `{checker.written(node.arguments[wrong])}` is {arguments[wrong].noun}"
        checker.report("LTL207", node.arguments[wrong].span, message, help="" if takes.array else _OF_EACH)
        return None
    if len(arguments) < takes.least or (takes.most is not None and len(arguments) > takes.most):
        help = _of_samples(checker, name, node.arguments[0]) if takes.array and len(arguments) == 1 else ""
        checker.report("LTL207", node.span, f"`{name}` takes {takes.words}, not {len(arguments)}", help=help)
        return None
    parts = [e for argument in arguments for e in expressions(argument)]
    measured = tuple(part for part in parts if not isinstance(part, Number))
    if takes.most is None and measured:
        parts = [beside(part, Call(function, measured)) for part in parts]
    return Scalar(call(function, parts))


def _history(checker: Checker, node: syntax.History) -> Value | None:
    if isinstance(node.offset, syntax.Reference) and checker.written(node.offset) == "opening":
        return _sampled(checker, node.signal, Opening, "opening", signal_alone)
    samples = _offset(checker, node.offset)
    if samples is None:
        _with_samples(checker, node.signal)
        return None
    sample: Callable[[Signal], Expression] = partial(Past, samples=samples) if samples else Current
    which = checker.written(node.offset)
    if node.otherwise is None:
        return _sampled(checker, node.signal, sample, which, signal_or_computed)
    otherwise = value(checker, node.otherwise)
    found = _sampled(checker, node.signal, sample, which, signal_or_computed)
    return None if otherwise is None or found is None else _with_otherwise(checker, node, found, otherwise)


def _with_otherwise(checker: Checker, node: syntax.History, found: Value, otherwise: Value) -> Value | None:
    """A sample `found` of a signal that is the constant `otherwise` until there is one: the latest of a signal."""
    assert node.otherwise is not None
    written = checker.written(node.otherwise)
    match found, otherwise:
        case Scalar(Past() | Current() as sample), Scalar(Number() as given):
            constant: Expression = beside(given, sample)
        case Truth(Past() | Current() as sample), Truth(Boolean() as constant):
            pass
        case Text(Past() | Current() as sample), Text(String() as constant):
            pass
        case _:
            message = f"`{written}` must be a constant like `{checker.written(node.signal)}`, which is {found.noun}"
            help = "only a number, a boolean or a string can have an initial value, which must be a literal"
            checker.report("LTL211", node.otherwise.span, message, help=help)
            return None
    assert isinstance(constant, Number | Boolean | String)
    if isinstance(constant, Number) and not numbers_of(sample).has(constant.value):
        message = f"`{checker.written(node.signal)}` is never `{written}`: its type has no such value"
        checker.report("LTL211", node.otherwise.span, message)
        return None
    samples = f"-{sample.samples}" if isinstance(sample, Past) else "0"
    name = f"@{{{sample.signal.name}, {samples} else {text(constant)}}}"
    return replace(found, expression=Current(Signal(name, sample.signal.type, sample, otherwise=constant)))


def _recent(checker: Checker, node: syntax.Recent) -> Value | None:
    """The last samples of a number, a boolean or a string, as an array."""
    samples = _offset(checker, node.offset)
    if samples == 0:
        written = checker.written(node.signal)
        message = f"`{checker.written(node)}` has only one sample, the latest: write `{written}`"
        checker.report("LTL211", node.offset.span, message, help=f"`@{{{written}, -9:}}` are the last ten samples")
    if not samples:
        _with_samples(checker, node.signal)
        return None
    found = _sampled(checker, node.signal, partial(Recent, samples=samples), f"-{samples}:", signal_or_computed)
    match found:
        case Scalar(Recent(signal) as recent) | Truth(Recent(signal) as recent) | Text(Recent(signal) as recent):
            return Array(recent, signal.type)
        case None:
            return None
        case _:
            noun, of_each = found.noun, "name its components, `.x`" if isinstance(found, Vector) else "name an element"
            message = f"`{checker.written(node.signal)}` is {noun}, and there are no arrays of these"
            checker.report("LTL210", node.signal.span, message, help=of_each)
            return None


def _latch(checker: Checker, node: syntax.Latch) -> Value | None:
    """The value of a signal where a state predicate held last: the latest sample of a signal that has no others."""
    when = holding(checker, node.condition)
    if when is None:
        _with_samples(checker, node.signal)
        return None
    which = f"when {predicate_text(when.predicate)}"

    def latched(signal: Signal) -> Current:
        return Current(Signal(f"@{{{signal.name}, {which}}}", signal.type, Current(signal), when))

    return _sampled(checker, node.signal, latched, which, signal_or_computed)


def _sampled(
    checker: Checker,
    node: syntax.Node,
    sample: Callable[[Signal], Expression],
    which: str,
    signal_of: SignalOf,
) -> Value | None:
    """The `sample` of a signal that is wanted, in words: `which`."""
    found = _with_samples(checker, node)
    if found is None:
        return None
    past = sampled(found, sample, which, signal_of)
    if past is None:
        message = f"`{checker.written(node)}` has no samples: it is neither a signal nor computed from current values"
        read = {type(each) for part in expressions(found) for each in reads(part)}
        help = "look back once, from each signal: `@{x, -2}` for `@{@{x, -1}, -1}`" if Past in read else ""
        if New in read:
            help = "`once new … within 1 s` asks whether a message came in the last second"
        if signal_of is signal_alone:
            message = f"`{checker.written(node)}` is not a signal: only signals have a value at an opening"
            help = "use `opening` with each of its signals"
        checker.report("LTL210", node.span, message, help=help)
    return past


def _with_samples(checker: Checker, node: syntax.Node) -> Value | None:
    """The value whose samples are wanted, of a state predicate whether it holds; None if an error was reported."""
    if kind(checker, node) != Sort.STATE:
        return whole(checker, node)
    predicate = holding(checker, node)
    return None if predicate is None else Truth(predicate)


def _offset(checker: Checker, node: syntax.Node) -> int | None:
    """How many samples back: the offset is an integer literal, 0 or with a minus."""
    written = checker.written(node)
    match node:
        case syntax.Minus(_, syntax.NumberLiteral(_, text)) if text.isdigit() and len(text) > len(str(MAX_HISTORY)):
            message = f"history goes back at most {MAX_HISTORY} samples"
            checker.report("LTL211", node.span, message)
        case syntax.Minus(_, syntax.NumberLiteral(_, text)) if text.isdigit():
            return int(text)
        case syntax.NumberLiteral(_, text) if not text.strip("0"):
            return 0
        case syntax.NumberLiteral(_, text) if text.isdigit():
            message = f"`{text}` is in the future: history only looks back"
            checker.report("LTL211", node.span, message, help=write(writing(node.span, f"-{text}")))
        case _:
            message = f"`{written}` is not an integer: history counts samples"
            checker.report("LTL211", node.span, message, help="`@{speed, -1}` is the sample before the latest")
    return None


def _minus(checker: Checker, node: syntax.Minus) -> Value | None:
    operand = value(checker, node.operand)
    match operand:
        case None:
            return None
        case Scalar(expression):
            return Scalar(negative(expression))
        case Vector((x, y, z), written):
            return Vector((negative(x), negative(y), negative(z)), f"-{_grouped(written)}")
        case _:
            pass
    checker.report(
        "LTL205", node.span, f"`-` needs a number or a vector, but `{checker.written(node.operand)}` is {operand.noun}"
    )
    return None


def _arithmetic(checker: Checker, node: syntax.Arithmetic) -> Value | None:
    left, right = value(checker, node.left), value(checker, node.right)
    operator = Operator(node.operator.text)
    match left, right:
        case (None, _) | (_, None):
            return None
        case Scalar(a), Scalar(b):
            return Scalar(arithmetic(operator, a, b))
        case Vector(a3, text), Vector(b3, other) if operator in (Operator.PLUS, Operator.MINUS):
            x, y, z = (arithmetic(operator, a, b) for a, b in zip(a3, b3, strict=True))
            return Vector((x, y, z), f"{text} {operator.value} {_grouped(other)}")
    _mismatch(checker, node, left, right)
    return None


def _grouped(text: str) -> str:
    return f"({text})" if " " in text and not text.startswith("@{") else text


def _mismatch(checker: Checker, node: syntax.Arithmetic, left: Value | None, right: Value | None) -> None:
    assert left is not None
    assert right is not None
    needs = "numbers or vectors" if node.operator.text in "+-" else "numbers"
    message = f"`{node.operator.text}` needs {needs}, not {left.noun} and {right.noun}"
    places = (Label(node.left.span, left.noun), Label(node.right.span, right.noun))
    help = _OF_EACH if isinstance(left, Array) or isinstance(right, Array) else ""
    checker.report("LTL205", node.operator.span, message, *places, help=help)
