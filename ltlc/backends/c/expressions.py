"""Expressions and conditions of a specification as C; they agree with `ltlc.specification.evaluation`."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from ltlc.backends.c.code import filled, flat, lines, literal
from ltlc.backends.c.functions import of_array
from ltlc.backends.c.names import local_names
from ltlc.backends.c.types import BOOL, DOUBLE, FLOAT, TEXT, CType, type_of
from ltlc.backends.python.code import INDENT, Call, Chain, Code, Infix, Prefix, Text
from ltlc.backends.python.expressions import excludes_nan, is_constant, is_finite, is_zero
from ltlc.backends.python.names import input_name
from ltlc.backends.python.statements import If, conjunction, disjunction
from ltlc.semantics import ltl
from ltlc.specification import expressions as e
from ltlc.specification.atoms import Comparison, Condition, Count, IsTrue, Relation, Same, operands
from ltlc.specification.evaluation import evaluate, number
from ltlc.specification.numbers import numbers_of
from ltlc.specification.wire import SINGLES, as_double

_NEGATIONS = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!="}
_FUNCTIONS = {e.Function.MIN: "least", e.Function.MAX: "greatest"}
_OF_COMPONENTS = {e.Function.ROLL: "roll", e.Function.PITCH: "pitch", e.Function.YAW: "yaw", e.Function.ANGLE: "angle"}
_FOLDS = {e.Function.MIN: "smallest", e.Function.MAX: "largest", e.Function.SUM: "sum"}


class NotInCError(Exception):
    """Something that cannot be written in C yet; the text says what."""


@dataclass(frozen=True, slots=True)
class Named:
    """What an input is called where it is used, and its type."""

    text: str
    type: CType


@dataclass
class Helpers:
    """What expressions call: the names of functions, and those of counts of elements with their text.

    Types have names that begin with `prefix`.
    """

    prefix: str
    called: set[str] = field(default_factory=set)
    arrays: dict[CType, None] = field(default_factory=dict)
    counts: dict[tuple[Count, bool], tuple[str, str]] = field(default_factory=dict)

    def type_text(self, type_: CType) -> str:
        """How a type is written."""
        if not type_.is_array:
            return type_.name
        self.arrays[type_.element] = None
        return f"{self.prefix}_{type_.plural}"

    def declared(self, type_: CType, name: str) -> str:
        """A declaration of `name`."""
        text = self.type_text(type_)
        return f"{text}{'' if text.endswith('*') else ' '}{name}"


@dataclass
class Coder:
    """Writes expressions over what is called as in `names`; what they call is entered in `helpers`."""

    names: Mapping[e.Expression, Named]
    helpers: Helpers

    def _typed(self, expression: e.Expression) -> tuple[Code, CType]:
        """Code for the value of `expression`, which reads something, and the type of that code."""
        if expression in self.names:
            return Text(self.names[expression].text), self.names[expression].type
        match expression:
            case e.Slice(array, start, stop):
                code, type_ = self._typed(array)
                ends = [Text("0" if start is None else str(start)), Text("INT64_MAX" if stop is None else str(stop))]
                self.helpers.type_text(type_)
                return self._call(of_array("slice", type_.element), code, *ends), type_
            case e.Negative(operand) | e.Call(e.Function.ABS, (operand,)):
                code, type_ = (self.double(operand), DOUBLE) if is_constant(operand) else self._typed(operand)
                type_ = FLOAT if type_ == FLOAT else DOUBLE
                code = code if type_ == FLOAT else self.double(operand)
                if isinstance(expression, e.Negative):
                    return Prefix("-", code), type_
                return self._call("fabsf" if type_ == FLOAT else "fabs", code), type_
            case Count():
                return self._count(expression, is_any=False), DOUBLE
            case e.Arithmetic(operator, left, right):
                return _infix(operator.value, self.double(left), self.double(right)), DOUBLE
            case e.Call(e.Function.LEN, (array,)):
                return Prefix("(double)", Text(f"{flat(self._typed(array)[0])}.length")), DOUBLE
            case e.Call(function, (array,)) if expression.array is not None:
                code, type_ = self._typed(array)
                return self._call(of_array(_FOLDS[function], type_.element), code), DOUBLE
            case e.Call(function, arguments):
                return self._numbers(function, [self.double(argument) for argument in arguments]), DOUBLE
        raise TypeError(f"not an expression over the inputs: {expression!r}")

    def _numbers(self, function: e.Function, arguments: list[Code]) -> Code:
        """A function of numbers."""
        if function is e.Function.SQRT:
            return self._call("sqrt", *arguments)
        if function in _FUNCTIONS:
            code, *rest = arguments
            for argument in rest:
                code = self._call(_FUNCTIONS[function], code, argument)
            return code
        components = Text(f"(const double[]){{{', '.join(map(flat, arguments))}}}")
        if function is e.Function.NORM:
            return self._call("norm", components, Text(str(len(arguments))))
        return self._call(_OF_COMPONENTS[function], components)

    def double(self, expression: e.Expression) -> Code:
        """Code for the double nearest to the value of `expression`."""
        if is_constant(expression):
            value = evaluate(expression, {})
            assert isinstance(value, float | int)
            return self.constant(as_double(value))
        code, type_ = self._typed(expression)
        return code if type_ == DOUBLE else Prefix("(double)", code)

    def value(self, expression: e.Expression, type_: CType) -> Code:
        """Code for the value of `expression`, which has this type."""
        if is_constant(expression):
            constant = evaluate(expression, {})
            assert not isinstance(constant, tuple)
            return self.constant(constant)
        return self.double(expression) if type_ == DOUBLE else self._typed(expression)[0]

    def _call(self, function: str, *arguments: Code) -> Code:
        self.helpers.called.add(function)
        return Call(function, arguments)

    def constant(self, value: float | bool | str) -> Code:
        """Code for a constant; the same double, boolean or string."""
        if isinstance(value, bool):
            return Text("true" if value else "false")
        if isinstance(value, str):
            if "\0" in value:
                raise NotInCError("a string with the character NUL, which ends strings in C")
            return Text(literal(value))
        value = as_double(value)
        if math.isfinite(value):
            return Text(repr(value))
        self.helpers.called.add("math.h")
        return Text({math.inf: "(double)INFINITY", -math.inf: "-(double)INFINITY"}.get(value, "(double)NAN"))

    def condition(self, condition: Condition, holds: bool = True) -> Code:
        """Code that is true where `condition` holds, or, with `holds` false, where it does not."""
        match condition:
            case IsTrue(operand):
                return self._truth(operand, holds)
            case Same(operand, e.Boolean(value)) | Same(e.Boolean(value), operand):
                return self._truth(operand, holds == value)
            case Same(left, right):
                return self._same(left, right, holds)
            case Comparison(Count() as count, Relation.AT_LEAST | Relation.LESS as relation, e.Number(1.0), 0.0):
                return _negated_unless((relation is Relation.AT_LEAST) == holds, self._count(count, is_any=True))
            case Comparison(left, Relation.EQUAL, right, margin) if margin != 0:
                return _negated_unless(holds, self._close(left, right, margin))
            case Comparison(left, relation, right, margin) if margin != 0:
                return Chain((self.double(left), self._shifted(right, margin)), (_operator(relation, holds),))
            case Comparison(left, relation, right) if is_constant(left):
                return self._compared(right, _operator(relation.flipped, holds), left)
            case Comparison(left, relation, right):
                return self._compared(left, _operator(relation, holds), right)

    def _truth(self, operand: e.Expression, holds: bool) -> Code:
        return _negated_unless(holds, self.value(operand, BOOL))

    def _same(self, left: e.Expression, right: e.Expression, holds: bool) -> Code:
        type_ = TEXT if any(self._is_text(side) for side in (left, right)) else BOOL
        sides = [self.value(side, type_) for side in (left, right)]
        if type_ == TEXT:
            return _negated_unless(holds, self._call("same_text", *sides))
        if sides[0] == sides[1]:
            return self.constant(holds)
        return Chain((sides[0], sides[1]), ("==" if holds else "!=",))

    def _is_text(self, side: e.Expression) -> bool:
        return isinstance(side, e.String) if is_constant(side) else self._typed(side)[1] == TEXT

    def _shifted(self, right: e.Expression, margin: float) -> Code:
        if is_constant(right):
            return self.constant(number(right, {}) + margin)
        return _infix("+" if margin > 0 else "-", self.double(right), Text(repr(abs(margin))))

    def _close(self, left: e.Expression, right: e.Expression, margin: float) -> Code:
        """The sides differ by at most `margin`, or are the same, be it infinite."""
        if is_zero(left) or is_zero(right):
            value = self.double(right if is_zero(left) else left)
            return Chain((Text(repr(-margin)), value, Text(repr(margin))), ("<=", "<="))
        sides = self.double(left), self.double(right)
        close = Chain((self._call("fabs", _infix("-", *sides)), Text(repr(margin))), ("<=",))
        return close if is_finite(left) or is_finite(right) else disjunction([Chain(sides, ("==",)), close])

    def _compared(self, left: e.Expression, operator: str, right: e.Expression) -> Code:
        """`left operator right`, exactly; `left` is no constant, unless both are."""
        if is_constant(left):
            return Chain((self.double(left), self.double(right)), (operator,))
        for side in (left, right):
            if not isinstance(side, e.Read | e.Element | e.Number) and numbers_of(side).is_wide:
                raise NotInCError("a comparison with `-`, `abs`, `min` or `max` of 64-bit integers, which is exact")
        code, type_ = self._typed(left)
        if is_constant(right):
            return self._with_constant(code, type_, operator, evaluate(right, {}))
        other, other_type = self._typed(right)
        if code == other and type_.integers is not None:
            return self.constant("=" in operator and operator != "!=")
        if type_ == other_type and type_ in (FLOAT, DOUBLE):
            return Chain((code, other), (operator,))
        if type_.integers is None and other_type.integers is None:
            return Chain((self.double(left), self.double(right)), (operator,))
        if type_.integers is None:
            mirrored = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}.get(operator, operator)
            return self._with_integer(other, other_type, mirrored, code, type_)
        return self._with_integer(code, type_, operator, other, other_type)

    def _with_integer(self, integer: Code, type_: CType, operator: str, other: Code, other_type: CType) -> Code:
        """An integer compared with another number, in a type that has both, or by a function."""
        if not type_.is_wide and not other_type.is_wide:
            both = Prefix("(double)", integer), other if other_type == DOUBLE else Prefix("(double)", other)
            return Chain(both, (operator,))
        if other_type.integers is None:
            function = "order_unsigned" if type_.name == "uint64_t" else "order_signed"
            wide, double = _cast("uint64_t" if type_.name == "uint64_t" else "int64_t", integer), _cast("double", other)
            return Chain((self._call(function, wide, double), Text("0.0")), (operator,))
        types = {type_.name, other_type.name}
        if "uint64_t" not in types or all(name.startswith("u") for name in types):
            common = "uint64_t" if "uint64_t" in types else "int64_t"
            return Chain((_cast(common, integer), _cast(common, other)), (operator,))
        if type_.name == "uint64_t":
            mirrored = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}.get(operator, operator)
            return self._with_integer(other, other_type, mirrored, integer, type_)
        return Chain((self._call("order_integers", _cast("int64_t", integer), other), Text("0.0")), (operator,))

    def _with_constant(self, code: Code, type_: CType, operator: str, value: object) -> Code:
        assert isinstance(value, float | int)
        if type_.integers is not None:
            return _with_bound(code, type_, operator, value)
        if type_ == FLOAT and SINGLES.nearest(value) == value and math.isfinite(value):
            return Chain((code, Text(f"{as_double(value)!r}f")), (operator,))
        left = code if type_ == DOUBLE else Prefix("(double)", code)
        return Chain((left, self.constant(as_double(value))), (operator,))

    def predicate(self, formula: ltl.Formula, conditions: Mapping[str, Condition], holds: bool = True) -> Code:
        """Code that is true where the state predicate `formula` over atoms with these conditions holds, or does not."""
        match formula:
            case ltl.Truth():
                return self.constant(holds)
            case ltl.Atom(name):
                return self.condition(conditions[name], holds)
            case ltl.Not(operand):
                return self.predicate(operand, conditions, not holds)
            case ltl.And(left, right) | ltl.Or(left, right):
                sides = [self.predicate(side, conditions, holds) for side in (left, right)]
                return conjunction(sides) if isinstance(formula, ltl.And) == holds else disjunction(sides)
        raise TypeError(f"not a state predicate: {formula}")

    def _count(self, count: Count, is_any: bool) -> Code:
        """A call of the function that counts elements or, if `is_any`, says whether there is one that counts."""
        reads = list(dict.fromkeys(e.reads(count)))
        own = self.helpers.counts
        if (count, is_any) not in own:
            name = f"{'any' if is_any else 'count'}_{len(own) + 1}"
            own[count, is_any] = name, ""
            own[count, is_any] = name, _counting(name, count, is_any, reads, self.helpers)
        arguments = (self.value(read, type_of(read.signal)) for read in reads)
        return Call(own[count, is_any][0], tuple(arguments))


def _counting(name: str, count: Count, is_any: bool, reads: list[e.Read], helpers: Helpers) -> str:
    """A function that goes through the elements."""
    local = local_names()
    named: dict[e.Expression, Named] = {r: Named(local.unique(input_name(r)), _read_type(r)) for r in reads}
    parameters = [helpers.declared(n.type, n.text) for n in named.values()]
    coder = Coder(named, helpers)
    arrays = []
    before: list[str] = []
    inside: list[str] = []
    for element in count.elements:
        code, type_ = coder._typed(element.array)
        array = local.unique("elements")
        before.append(f"const {helpers.type_text(type_)} {array} = {flat(code)};")
        arrays.append(array)
        each = local.unique(f"each_{named[next(e.reads(element))].text}")
        named[element] = Named(each, type_.element)
        constant = "" if type_.element == TEXT else "const "
        inside.append(f"{constant}{helpers.declared(type_.element, each)} = {array}.elements[i];")
    conditions = dict(count.conditions)
    guard = [coder.predicate(count.predicate, conditions)]
    for side in dict.fromkeys(s for c in conditions.values() if isinstance(c, Comparison) for s in operands(c)):
        if side not in count.singles and not excludes_nan(count.predicate, conditions, side):
            helpers.called.add("math.h")
            guard.insert(0, Chain((coder.double(side), Text("(double)INFINITY")), ("<=",)))
    found = "return true" if is_any else "found += 1.0"
    body = lines([If(conjunction(guard), (found,))], INDENT * 2)
    text = "\n".join(body)
    unused = [f"(void){n.text};" for n in named.values() if not _mentions(n.text, [*before, *inside, text])]
    inside = [line for line in inside if _mentions(line.split(" = ")[0].split()[-1].lstrip("*"), [text])]
    unused = [line for line in unused if not line.startswith("(void)each_")]
    test = conjunction([Chain((Text("i"), Text(f"{array}.length")), ("<",)) for array in arrays])
    head = f"static {'bool' if is_any else 'double'} {name}("
    return "\n".join(
        [
            f"/* {'Whether an element satisfies' if is_any else 'How many elements satisfy'} a predicate. */",
            *filled(head, [f"{p}," for p in parameters[:-1]] + parameters[-1:], ")", INDENT * 2),
            "{",
            *(INDENT + line for line in [*before, *unused]),
            *([] if is_any else [f"{INDENT}double found = 0.0;"]),
            f"{INDENT}for (size_t i = 0; {flat(test)}; i++) {{",
            *(INDENT * 2 + line for line in inside),
            *body,
            f"{INDENT}}}",
            f"{INDENT}return {'false' if is_any else 'found'};",
            "}\n",
        ]
    )


def _mentions(name: str, texts: list[str]) -> bool:
    return any(re.search(rf"\b{re.escape(name)}\b", text) for text in texts)


def _read_type(read: e.Read) -> CType:
    match read:
        case e.New():
            return BOOL
        case e.Slope():
            return DOUBLE
        case _:
            return type_of(read.signal)


def _operator(relation: Relation, holds: bool) -> str:
    return relation.value if holds else _NEGATIONS[relation.value]


def _negated_unless(holds: bool, code: Code) -> Code:
    return code if holds else Prefix("not ", code)


def _cast(type_: str, code: Code) -> Code:
    return Prefix(f"({type_})", code)


def _infix(operator: str, left: Code, right: Code) -> Code:
    """`left operator right`; what groups to the left already becomes one tree."""
    if isinstance(left, Infix) and left.operator == operator:
        return Infix(operator, (*left.operands, right))
    return Infix(operator, (left, right))


def _with_bound(code: Code, type_: CType, operator: str, value: float) -> Code:
    """An integer compared with a constant: with an integer of its type, or decided."""
    numbers = type_.integers
    assert numbers is not None
    least, most = int(numbers.least), int(numbers.most)
    if operator in ("==", "!="):
        if not numbers.has(value):
            return Text("true" if operator == "!=" else "false")
        return Chain((code, Text(_integer(int(value), type_))), (operator,))
    if operator in ("<", "<="):
        bound = least - 1 if value < least else most if value > most else _last(value, operator == "<")
        if bound >= most or bound < least:
            return Text("true" if bound >= most else "false")
    else:
        bound = most + 1 if value > most else least if value < least else -_last(-value, operator == ">")
        if bound <= least or bound > most:
            return Text("true" if bound <= least else "false")
    is_whole = value == int(value)
    shown = int(value) if is_whole else bound
    return Chain((code, Text(_integer(shown, type_))), (operator if is_whole else f"{operator[0]}=",))


def _last(value: float, strictly: bool) -> int:
    """The last integer that is at most `value`, or less."""
    return math.ceil(value) - 1 if strictly else math.floor(value)


def _integer(value: int, type_: CType) -> str:
    """A constant of a type of integers."""
    bits = type_.name.removeprefix("u").removeprefix("int").removesuffix("_t")
    if type_.name.startswith("u"):
        return f"UINT64_C({value})" if bits == "64" else f"{value}u" if bits == "32" else str(value)
    if value == -(2 ** (int(bits) - 1)) and bits in ("32", "64"):
        return f"INT{bits}_MIN"
    return f"INT64_C({value})" if bits == "64" else str(value)
