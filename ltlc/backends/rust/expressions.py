"""Expressions of emitted C as Rust."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import field

from pycparser import c_ast
from pycparser.c_ast import Node

from ltlc.backends.operators import flat
from ltlc.backends.rust.names import spelled
from ltlc.backends.rust.trees import Trees
from ltlc.backends.rust.types import Types
from ltlc.backends.trees import Call, Chain, Code, Infix, Prefix, Text
from ltlc.dataclass import dataclass
from ltlc.semantics.verdicts import Verdict

_OPERATORS = {"&&": "and", "||": "or"}
_CONSTANTS = {"true": "true", "false": "false", "INFINITY": "f64::INFINITY", "NAN": "f64::NAN", "NULL": "None"}
_CONSTANTS |= {"INT64_MAX": "i64::MAX", "INT64_MIN": "i64::MIN", "INT32_MIN": "i32::MIN", "UINT32_MAX": "u32::MAX"}
_BORROWED = {"occurred": ("&mut ", "&mut "), "recent": ("&",)}
"""What stands before the first arguments of functions that are given members."""


def verdict_name(verdict: Verdict) -> str:
    """The variant of `Verdict`."""
    return "".join(word.capitalize() for word in verdict.name.split("_"))


@dataclass
class Expressions:
    """Expressions in a function, in which `places` are what pointers lead to.

    It may be given no samples if that `is_optional`. They have what is called as in `fields`, by what C calls it or its
    flag.
    """

    trees: Trees
    types: Types
    fields: Mapping[str, str]
    is_optional: bool = False
    places: dict[str, str] = field(default_factory=dict)

    def place(self, node: Node) -> str:
        """A variable, or a member or an element of something."""
        match node:
            case c_ast.ID(name=name):
                return self.places.get(name) or spelled(name)
            case c_ast.StructRef(name=c_ast.ID(name="samples"), field=c_ast.ID(name=name)):
                return f"samples.{self.fields[name]}"
            case c_ast.UnaryOp(op="*", expr=inner):
                return self.place(inner)
            case c_ast.StructRef(name=inner, field=c_ast.ID(name="elements")):
                return f"{self.place(inner)}.as_ptr()"
            case c_ast.StructRef(name=inner, field=c_ast.ID(name="length")):
                return f"{self.place(inner)}.len()"
            case c_ast.StructRef(name=inner, field=c_ast.ID(name=name)):
                return f"{self.place(inner)}.{spelled(name)}"
            case c_ast.ArrayRef(name=c_ast.StructRef(name=inner, field=c_ast.ID(name="elements")), subscript=index):
                return f"{self.place(inner)}[{self.place(index)}]"
            case c_ast.ArrayRef(name=inner, subscript=c_ast.BinaryOp() as index):
                return f"{self.place(inner)}[({flat(self.code(index))}) as usize]"
            case c_ast.ArrayRef(name=inner, subscript=index):
                return f"{self.place(inner)}[{flat(self.code(index))} as usize]"
            case c_ast.FuncCall():
                return flat(self.code(node))
            case _:
                raise TypeError(node)

    def value(self, node: Node) -> Code:
        """An expression that stands alone."""
        match node:
            case c_ast.TernaryOp(cond=cond, iftrue=then, iffalse=c_ast.ID(name="NULL")):
                return Text(f"if {flat(self.value(cond))} {{ Some({flat(self.value(then))}) }} else {{ None }}")
            case c_ast.TernaryOp(cond=cond, iftrue=then, iffalse=otherwise):
                sides = (flat(self.value(side)) for side in (cond, then, otherwise))
                return Text("if {} {{ {} }} else {{ {} }}".format(*sides))
            case c_ast.Cast(to_type=type_, expr=inner) if not _is_constant(inner):
                operand = flat(self.code(inner))
                operand = f"({operand})" if isinstance(inner, c_ast.BinaryOp) else operand
                return Text(f"{operand} as {self.types.text(type_.type)}")
            case _:
                return self.code(node)

    def code(self, node: Node) -> Code:
        """An expression that may stand in another."""
        match node:
            case c_ast.Constant(type="string", value=text):
                return Text(_text(text))
            case c_ast.Constant(type="float", value=value):
                return Text(f"{value.removesuffix('f')}f32")
            case c_ast.Constant(value=value):
                return Text(value.rstrip("u"))
            case c_ast.ID(name=name) if (constant := self._constant(name)) is not None:
                return Text(constant)
            case c_ast.StructRef(name=c_ast.ID(name="samples"), field=c_ast.ID(name=name)):
                return Text(self.place(node) + self._of_samples(name))
            case c_ast.ID() | c_ast.StructRef() | c_ast.ArrayRef() | c_ast.UnaryOp(op="*"):
                return Text(self.place(node))
            case c_ast.UnaryOp(op="!", expr=c_ast.FuncCall(name=c_ast.ID(name="same_text"), args=args)):
                return Chain(tuple(map(self.code, args.exprs)), ("!=",))
            case c_ast.UnaryOp(op="&", expr=c_ast.StructRef(field=c_ast.ID(name="latest")) as place):
                return Text(f"&{{ {self.place(place)} }}")  # a copy, for something else may change
            case c_ast.UnaryOp(op=operator, expr=inner):
                return Prefix("not " if operator == "!" else operator, self.code(inner))
            case c_ast.Cast(expr=inner) if _is_constant(inner):
                return self.code(inner)
            case c_ast.BinaryOp(op=operator, left=left, right=right):
                return self._operated(operator, self.code(left), self.code(right))
            case c_ast.TernaryOp() | c_ast.Cast():
                return Text(f"({flat(self.value(node))})")
            case c_ast.FuncCall(name=c_ast.ID(name=name), args=args):
                return self._called(name, args.exprs)
            case c_ast.CompoundLiteral(init=items):
                return Text(f"&[{', '.join(flat(self.value(each)) for each in items.exprs)}]")
            case _:
                raise TypeError(node)

    def _constant(self, name: str) -> str | None:
        own = f"{self.trees.files.prefix.upper()}_"
        if not name.startswith(own):
            return _CONSTANTS.get(name)
        short = name.removeprefix(own)
        if short in Verdict.__members__:
            return f"Verdict::{verdict_name(Verdict[short])}"
        return short if short in ("NEVER", *self.trees.sizes) else None

    def _of_samples(self, name: str) -> str:
        """What asks a field of samples whether there is a value, or for that; news is what it is."""
        if name not in self.trees.files.samples.fields.values():
            return ".is_some()" if name.startswith("has_") else ""
        return ".unwrap_or_default()"

    def _operated(self, operator: str, left: Code, right: Code) -> Code:
        match operator:
            case "%" | ">>":
                return Text(f"{_operand(left)} {operator} {_operand(right)}")
            case "&&" | "||" | "+" | "-" | "*" | "/":
                name = _OPERATORS.get(operator, operator)
                is_same = isinstance(left, Infix) and left.operator == name
                return Infix(name, (*left.operands, right) if is_same and isinstance(left, Infix) else (left, right))
            case "!=" | "==" if left == right:
                is_nan = Text(f"{flat(left)}.is_nan()")
                return is_nan if operator == "!=" else Prefix("not ", is_nan)
            case _:
                return Chain((left, right), (operator,))

    def _called(self, name: str, arguments: Sequence[Node]) -> Code:
        trees = self.trees
        if name in ("INT64_C", "UINT64_C"):
            return self.code(arguments[0])
        if name == "same_text":
            return Chain(tuple(map(self.code, arguments)), ("==",))
        if trees.owner(name) is None:
            before = (*_BORROWED.get(name.split("_")[0], ()), *("" for _ in arguments))
            given = [
                self.value(each.expr if isinstance(each, c_ast.UnaryOp) and each.op == "&" else each)
                for each in arguments
            ]
            return Call(name, tuple(Text(f"{b}{flat(g)}") if b else g for b, g in zip(before, given, strict=False)))
        first, *rest = arguments
        of = self.place(first.expr if isinstance(first, c_ast.UnaryOp) else first)
        given = [self._samples(name) if _is_samples(each) else self.value(each) for each in rest]
        return Call(f"{of}.{self.trees.called(name)}", tuple(given))

    def _samples(self, called: str) -> Code:
        """The samples, as what a function is given."""
        is_wrapped = called in self.trees.optional and not self.is_optional
        return Text("Some(samples)" if is_wrapped else "samples")


def _is_samples(node: Node) -> bool:
    return isinstance(node, c_ast.ID) and node.name == "samples"


def _operand(code: Code) -> str:
    """What stands beside an operator that binds tightly."""
    return f"({flat(code)})" if isinstance(code, Infix | Chain) else flat(code)


def _is_constant(node: Node) -> bool:
    return isinstance(node, c_ast.ID) and node.name in ("INFINITY", "NAN")


def _text(literal: str) -> str:
    """A string, in ASCII, of which C has the bytes in UTF-8."""
    found = re.sub(rb"\\([0-7]{3}|.)", _byte, literal[1:-1].encode()).decode()
    return '"' + "".join(c if " " <= c <= "~" and c not in '"\\' else f"\\u{{{ord(c):x}}}" for c in found) + '"'


def _byte(escaped: re.Match[bytes]) -> bytes:
    return bytes([int(escaped[1], 8)]) if len(escaped[1]) == 3 else escaped[1]
