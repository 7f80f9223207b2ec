"""Typed expressions as C; the code agrees with `ltlc.specification.evaluation`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import field

from ltlc.backends.c.code import lines, literal, mentions, unused
from ltlc.backends.c.functions import of_array
from ltlc.backends.c.names import local_names
from ltlc.backends.c.types import plural, type_name
from ltlc.backends.names import input_name
from ltlc.backends.operators import filled, flat
from ltlc.backends.spelling import NotInTargetError, Speller, Target
from ltlc.backends.statements import If, conjunction
from ltlc.backends.trees import INDENT, Call, Chain, Code, Prefix, Text
from ltlc.dataclass import dataclass
from ltlc.program.expressions import Count, Each, Expression, Literal, Read, Slice, reads_of
from ltlc.program.functions import ROWS, Primitive, Spelling, Types
from ltlc.program.types import DOUBLE, Scalar, Type


@dataclass
class C(Target):
    """How C writes what the table of functions leaves to the target; what it needs for that is collected.

    `arrays` are the types of elements of arrays, `counts` the functions that count elements, with their text. Names of
    types begin with `prefix`.
    """

    prefix: str
    arrays: dict[Type, None] = field(default_factory=dict)
    counts: dict[Count, tuple[str, str]] = field(default_factory=dict)

    def speller(self, names: Mapping[Expression, str]) -> Speller:
        """What writes expressions over what is called as in `names`."""
        return Speller(names, self)

    def type_text(self, type_: Type) -> str:
        """How a type is written."""
        if not type_.is_array:
            return type_name(type_.scalar)
        self.arrays[type_.element] = None
        return f"{self.prefix}_{plural(type_)}"

    def declared(self, type_: Type, name: str) -> str:
        """A declaration of `name`."""
        text = self.type_text(type_)
        return f"{text}{'' if text.endswith('*') else ' '}{name}"

    def spelling(self, primitive: Primitive, types: Types) -> Spelling | None:
        """By the table."""
        return ROWS[primitive].c(types)

    def literal(self, speller: Speller, literal_: Literal) -> Code:
        """The same value of its type. Raises NotInTargetError."""
        value, scalar = literal_.value, literal_.type.scalar
        match value:
            case bool():
                return Text("true" if value else "false")
            case str():
                if "\0" in value:
                    raise NotInTargetError("a string with the character NUL, which ends strings in C")
                return Text(literal(value))
            case int():
                return Text(_integer(value, scalar))
            case float() if math.isfinite(value):
                return Text(f"{value!r}{'f' if scalar is Scalar.SINGLE else ''}")
            case _:
                return Text({math.inf: "(double)INFINITY", -math.inf: "-(double)INFINITY"}.get(value, "(double)NAN"))

    def slice(self, speller: Speller, slice_: Slice) -> Code:
        """A call."""
        ends = [slice_.start or 0, "INT64_MAX" if slice_.stop is None else slice_.stop]
        self.type_text(slice_.type)
        return Call(of_array("slice", slice_.type), (speller.code(slice_.array), *(Text(str(end)) for end in ends)))

    def count(self, speller: Speller, count: Count) -> Code:
        """A call of a function of its own."""
        reads = list(dict.fromkeys(reads_of(count)))
        if count not in self.counts:
            name = f"{'any' if count.is_any else 'count'}_{len(self.counts) + 1}"
            self.counts[count] = name, self._counting(name, count, reads)
        return Call(self.counts[count][0], tuple(map(speller.code, reads)))

    def at_most_infinite(self, speller: Speller, argument: Expression) -> Code:
        """As a double."""
        code = speller.code(argument)
        double = code if argument.type == DOUBLE else Prefix("(double)", code)
        return Chain((double, Text("(double)INFINITY")), ("<=",))

    def of_array(self, function: str, array: Expression) -> str:
        """One for each type of elements."""
        self.type_text(array.type)
        return of_array(function, array.type)

    def components(self, arguments: Sequence[Code]) -> tuple[Code, ...]:
        """An array."""
        return (Text(f"(const double[]){{{', '.join(map(flat, arguments))}}}"),)

    def member(self, name: str, array: Code) -> Code:
        """Made a double."""
        return Prefix("(double)", Text(f"{flat(array)}.{name}"))

    def _counting(self, name: str, count: Count, reads: Sequence[Read]) -> str:
        """A function that goes through the elements."""
        local = local_names()
        named: dict[Read, str] = {read: local.unique(input_name(read)) for read in reads}
        parameters = [self.declared(read.type, text) for read, text in named.items()]
        before: list[str] = []
        loops: list[tuple[str, list[str]]] = []
        names: dict[Expression, str] = dict(named.items())
        speller = self.speller(names)
        for arrays in count.lists:
            index = local.unique("i") if loops else "i"
            tests, inside = [], []
            for each in map(Each, arrays):
                elements = local.unique("elements")
                before.append(f"const {self.type_text(each.array.type)} {elements} = {flat(speller.code(each.array))};")
                tests.append(Chain((Text(index), Text(f"{elements}.length")), ("<",)))
                names[each] = local.unique(f"each_{named[next(reads_of(each))]}")
                constant = "" if each.type.scalar is Scalar.TEXT else "const "
                inside.append(f"{constant}{self.declared(each.type, names[each])} = {elements}.elements[{index}];")
            loops.append((f"for (size_t {index} = 0; {flat(conjunction(tests))}; {index}++) {{", inside))
        found = "return true" if count.is_any else "found += 1.0"
        body = lines([If(speller.code(count.guard), (found,))], INDENT * (1 + len(loops)))
        text = "\n".join(body)
        aside = unused(named.values(), [*before, *(line for _, inside in loops for line in inside), text])
        for depth, (loop, inside) in reversed(list(enumerate(loops, 1))):
            asked = [line for line in inside if mentions(line.split(" = ")[0].split()[-1].lstrip("*"), [text])]
            body = [*(INDENT * (depth + 1) + line for line in asked), *body]
            body = [f"{INDENT * depth}{loop}", *body, f"{INDENT * depth}}}"]
        head = f"static {'bool' if count.is_any else 'double'} {name}("
        return "\n".join(
            [
                f"/* {'Whether an element satisfies' if count.is_any else 'How many elements satisfy'} a predicate. */",
                *filled(head, [f"{p}," for p in parameters[:-1]] + parameters[-1:], ")", INDENT * 2),
                "{",
                *(INDENT + line for line in before),
                *aside,
                *([] if count.is_any else [f"{INDENT}double found = 0.0;"]),
                *body,
                f"{INDENT}return {'false' if count.is_any else 'found'};",
                "}\n",
            ]
        )


def _integer(value: int, scalar: Scalar) -> str:
    """A constant of a type of integers. Raises NotInTargetError."""
    if scalar is Scalar.INTEGER:
        raise NotInTargetError("an integer that no C type can represent")
    if scalar.is_unsigned:
        return f"UINT64_C({value})" if scalar.bits == 64 else f"{value}u" if scalar.bits == 32 else str(value)
    if value == -(2 ** (scalar.bits - 1)) and scalar.bits in (32, 64):
        return f"INT{scalar.bits}_MIN"
    return f"INT64_C({value})" if scalar.bits == 64 else str(value)
