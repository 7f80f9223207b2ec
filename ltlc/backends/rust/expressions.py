"""Typed expressions as Rust; the code agrees with `ltlc.specification.evaluation`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from ltlc.backends.names import Names, variable
from ltlc.backends.operators import flat
from ltlc.backends.rust.names import RESERVED
from ltlc.backends.spelling import NotInTargetError, Speller, Target
from ltlc.backends.trees import Call, Chain, Code, Text
from ltlc.program.expressions import Count, Each, Expression, Literal, Slice, reads_of
from ltlc.program.functions import (
    ROWS,
    AtMostInfinite,
    Components,
    Folded,
    Function,
    Infix,
    OfDoubles,
    Prefix,
    Primitive,
    Spelling,
    Types,
)
from ltlc.program.machine import Instead
from ltlc.program.types import DOUBLE, SINGLE, Scalar, Type

P = Primitive


def _always(spelling: Spelling) -> Callable[[Types], Spelling]:
    return lambda types: spelling


def _of_doubles(spelling: Prefix | Function | Folded) -> Callable[[Types], Spelling]:
    """There are no integers of any size."""
    return lambda types: OfDoubles(spelling) if any(t.scalar.is_wide for t in types) else spelling


def _absolute(types: Types) -> Spelling:
    return _of_doubles(Function("absolute_single" if types[0] == SINGLE else "absolute"))(types)


SPELLINGS: Mapping[Primitive, Callable[[Types], Spelling | None]] = {
    P.NEGATE: _of_doubles(Prefix("-")),
    P.ABS: _absolute,
    P.ADD: _always(Infix("+")),
    P.SUBTRACT: _always(Infix("-")),
    P.TIMES: _always(Infix("*")),
    P.OVER: _always(Infix("/")),
    **{primitive: ROWS[primitive].c for primitive in (P.FLOOR, P.CEIL, P.SIGN, P.MOD, P.ANGLE_BETWEEN, P.GAP)},
    P.INSIDE: _always(Components("inside")),
    P.LEAST: _of_doubles(Folded("least")),
    P.GREATEST: _of_doubles(Folded("greatest")),
    P.SMALLEST: _of_doubles(Function("smallest")),
    P.LARGEST: _of_doubles(Function("largest")),
    P.NEAREST: _always(Function("nearest")),
    P.MEDIAN: _always(Function("median")),
    P.COMPLETE: _always(Function("complete")),
    P.LENGTH: _always(Function("length")),
    P.TO_DOUBLE: _always(Function("double")),
    P.TO_SIGNED: _always(Function("i64::from")),
    P.TO_UNSIGNED: _always(Function("u64::from")),
    P.LESS: ROWS[P.LESS].c,
    P.AT_MOST: ROWS[P.AT_MOST].c,
    P.EQUAL: ROWS[P.EQUAL].c,
    P.SAME: _always(Infix("==", "!=")),
    P.NOT: _always(Prefix("not ")),
    P.AND: _always(Infix("and")),
    P.OR: _always(Infix("or")),
    P.MEASURED: _always(AtMostInfinite()),
}
"""The column of the table of functions for Rust; what is not in it `core` has no function for."""

_NAMES = {Scalar.BOOL: "bool", Scalar.SINGLE: "f32", Scalar.DOUBLE: "f64"}


def type_text(type_: Type, lifetime: str = "'a ") -> str:
    """How a type is written; what lies elsewhere lives as long as `lifetime`."""
    scalar = type_.scalar
    name = _NAMES.get(scalar) or f"{'u' if scalar.is_unsigned else 'i'}{scalar.bits}"
    name = f"&{lifetime}str" if scalar is Scalar.TEXT else name
    return f"&{lifetime}[{name}]" if type_.is_array else name


def is_borrowed(type_: Type) -> bool:
    """Whether values lie elsewhere."""
    return type_.is_array or type_.scalar is Scalar.TEXT


def default(type_: Type) -> str:
    """The value of a type where none has come."""
    if type_.is_array:
        return "&[]"
    match type_.scalar:
        case Scalar.BOOL:
            return "false"
        case Scalar.TEXT:
            return '""'
        case Scalar.SINGLE | Scalar.DOUBLE:
            return "0.0"
        case _:
            return "0"


def instead_text(value: Instead, type_: Type) -> str:
    """What stands in for a value of a type, as a literal."""
    if isinstance(value, tuple):
        return f"&[{', '.join(instead_text(each, type_.element) for each in value)}]"
    match type_.scalar:
        case Scalar.BOOL:
            return "true" if value else "false"
        case Scalar.TEXT:
            return text_literal(str(value))
        case Scalar.SINGLE | Scalar.DOUBLE:
            return repr(float(value))
        case _:
            return str(int(value))


def rust_speller(names: Mapping[Expression, str]) -> Speller:
    """What writes expressions over what is called as in `names`."""
    return Speller(names, Rust())


class Rust(Target):
    """How Rust writes what the table of functions leaves to the target."""

    def spelling(self, primitive: Primitive, types: Types) -> Spelling | None:
        """By the table. Raises NotInTargetError where it has no row."""
        if primitive not in SPELLINGS:
            raise NotInTargetError(f"the {primitive.value}, for which `core` has no function")
        return SPELLINGS[primitive](types)

    def literal(self, speller: Speller, literal_: Literal) -> Code:
        """The same value of its type. Raises NotInTargetError."""
        value, type_ = literal_.value, literal_.type
        match value:
            case bool():
                return Text("true" if value else "false")
            case str():
                return Text(text_literal(value))
            case int() if type_.scalar is Scalar.INTEGER:
                raise NotInTargetError("an integer that no type of Rust has")
            case int():
                return Text(f"{value}{type_text(type_)}")
            case float() if math.isfinite(value):
                return Text(f"{value!r}{type_text(type_)}" if type_ == SINGLE else repr(value))
            case _:
                name = {math.inf: "f64::INFINITY", -math.inf: "-f64::INFINITY"}.get(value, "f64::NAN")
                return Text(name.replace("f64", type_text(type_)))

    def slice(self, speller: Speller, slice_: Slice) -> Code:
        """A call."""
        ends = [slice_.start or 0, "i64::MAX" if slice_.stop is None else slice_.stop]
        return Call("slice", (speller.code(slice_.array), *(Text(str(end)) for end in ends)))

    def count(self, speller: Speller, count: Count) -> Code:
        """`any`, or `count` of what is left by `filter`, of an iterator over the elements. Raises NotInTargetError."""
        if len(count.lists) > 1:
            raise NotInTargetError("elements of several lists combined, `over`")
        local = Names(RESERVED | frozenset(speller.names.values()))
        names: dict[Expression, str] = {
            Each(array): local.unique(f"each_{variable(next(reads_of(array)).signal)}") for array in count.arrays
        }
        guard = flat(rust_speller({**speller.names, **names}).code(count.guard))
        first, *others = (flat(speller.code(array)) for array in count.arrays)
        given, *more = (f"&{name}" for name in names.values())
        items = f"{first}.iter()"
        for other, name in zip(others, more, strict=True):
            items, given = f"{items}.zip({other}.iter())", f"({given}, {name})"
        if count.is_any:
            return Text(f"{items}.any(|{given}| {guard})")
        return Call("double", (Text(f"{items}.filter(|&{given}| {guard}).count()"),))

    def at_most_infinite(self, speller: Speller, argument: Expression) -> Code:
        """As a double."""
        code = speller.code(argument)
        double = code if argument.type == DOUBLE else Call("double", (code,))
        return Chain((double, Text("f64::INFINITY")), ("<=",))

    def components(self, arguments: Sequence[Code]) -> tuple[Code, ...]:
        """An array."""
        return (Text(f"[{', '.join(map(flat, arguments))}]"),)


def text_literal(text: str) -> str:
    """A string, in ASCII. Raises NotInTargetError."""
    if "\0" in text:
        raise NotInTargetError("a string with the character NUL")
    return '"' + "".join(c if " " <= c <= "~" and c not in '"\\' else f"\\u{{{ord(c):x}}}" for c in text) + '"'
