"""Emitted C as Rust: the same functions, with the same statements in the same order.

A function that is given a pointer to a struct is a method of that. Counters wrap, as they do in C.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from pycparser import c_ast
from pycparser.c_ast import Decl, FuncDef, Node

from ltlc.backends.braces import Braces
from ltlc.backends.operators import filled, flat, layout
from ltlc.backends.rust.code import comment
from ltlc.backends.rust.names import spelled
from ltlc.backends.rust.trees import Trees
from ltlc.backends.rust.types import Types
from ltlc.backends.statements import Do, If, Statement
from ltlc.backends.trees import INDENT, Call, Chain, Code, Infix, Prefix, Text
from ltlc.semantics.verdicts import Verdict

_LINES = Braces("", " {", "// {}").lines
_OPERATORS = {"&&": "and", "||": "or"}
_CONSTANTS = {"true": "true", "false": "false", "INFINITY": "f64::INFINITY", "NAN": "f64::NAN"}
_CONSTANTS |= {"INT64_MAX": "i64::MAX", "INT64_MIN": "i64::MIN", "INT32_MIN": "i32::MIN", "UINT32_MAX": "u32::MAX"}
_CONSTANTS["NULL"] = "None"
_BORROWED = {"occurred": ("&mut ", "&mut "), "recent": ("&",)}
"""What stands before the first arguments of functions that are given members."""


def verdict_name(verdict: Verdict) -> str:
    """The variant of `Verdict`."""
    return "".join(word.capitalize() for word in verdict.name.split("_"))


@dataclass(frozen=True)
class Printer:
    """Prints the functions of a file; samples have what is called as in `fields`, by what C calls it or its flag."""

    trees: Trees
    types: Types
    fields: Mapping[str, str]

    def function(self, name: str) -> list[str]:
        """A function, as a method where it is one."""
        node, owner = self.trees.functions[name], self.trees.owner(name)
        described = self.trees.about(name)
        indent = INDENT if owner else ""
        return [
            *(comment("///", *described, indent=indent) if described else []),
            *self._head(node, name, owner, indent),
            *_Body(self, owner, name in self.trees.optional).lines(node),
            f"{indent}}}",
        ]

    def beginning(self, struct: str) -> list[str] | None:
        """What makes a struct ready, all of which is 0 before, if something does; it is called `new`."""
        name = f"{self.trees.files.prefix}_{'' if struct == 'monitors' else f'{struct}_'}init"
        if name not in self.trees.functions:
            return None
        function = self.trees.functions[name]
        _, *items = function.body.block_items
        given = function.decl.type.args.params[0].name
        return _Body(self, None, places={given: "new"}).statements(items, INDENT * 2)

    def _head(self, node: FuncDef, name: str, owner: str | None, indent: str) -> list[str]:
        first, *rest = node.decl.type.args.params
        of = "" if "static" in node.decl.storage else "pub "
        given = rest if owner else [first, *rest]
        kept = {*_kept(node)} if owner and self.types.borrows(owner) else set[str]()
        pieces = [f"{spelled(each.name)}: {self._parameter(name, each, kept)}" for each in given]
        if owner:
            pieces.insert(0, "&self" if "const" in first.type.type.quals else "&mut self")
        pieces = [f"{piece}," for piece in pieces[:-1]] + pieces[-1:]
        result = node.decl.type.type
        returned = f" -> {self._returned(result)}" if self._returned(result) else ""
        return filled(f"{indent}{of}fn {self.called(name)}(", pieces, f"){returned} {{", indent + INDENT * 2)

    def _returned(self, result: Node) -> str:
        """The type of what a function returns; where that may be NULL, it is an option."""
        if isinstance(result, c_ast.PtrDecl):
            return f"Option<{self.types.text(result)}>"
        return "" if result.type.names == ["void"] else self.types.text(result)

    def _parameter(self, function: str, given: Decl, kept: set[str]) -> str:
        """Its type; what is kept of what lies elsewhere has to live as long."""
        if given.name == "samples":
            samples = f"&Samples{self.types.lifetime('samples')}"
            return f"Option<{samples}>" if function in self.trees.optional else samples
        return self.types.text(given, "'a " if given.name in kept else "")

    def called(self, name: str) -> str:
        """What a function is called in Rust: one of a property or a table without the name of that."""
        owner = self.trees.owner(name)
        called = name if "static" in self.trees.functions[name].decl.storage else self.trees.short(name)
        return called if owner == "monitors" else called.removeprefix(f"{owner}_")


def _kept(node: Node) -> Iterator[str]:
    """The names whose values become those of members or of variables, as they are."""
    match node:
        case Decl(init=value) | c_ast.Assignment(rvalue=value):
            yield from _bare(value)
        case _:
            pass
    for _, part in node.children():
        yield from _kept(part)


def _bare(value: Node | None) -> Iterator[str]:
    match value:
        case c_ast.ID(name=name):
            yield name
        case c_ast.TernaryOp(iftrue=one, iffalse=other):
            yield from (*_bare(one), *_bare(other))
        case _:
            pass


@dataclass
class _Body:
    """The body of a function of the struct `owner`, which may be given no samples if that `is_optional`.

    `places` are what pointers lead to.
    """

    printer: Printer
    owner: str | None
    is_optional: bool = False
    places: dict[str, str] = field(default_factory=dict)

    def lines(self, function: FuncDef) -> list[str]:
        """Its statements; the last one may be the value of the function."""
        items = function.body.block_items or []
        if self.owner:
            self.places[function.decl.type.args.params[0].name] = "self"
        indent = INDENT * (2 if self.owner else 1)
        match items[-1:]:
            case [c_ast.Return(expr=Node() as value)] if not isinstance(value, c_ast.TernaryOp):
                return [*self.statements(items[:-1], indent), *layout(indent, self.value(value), "")]
            case _:
                return self.statements(items, indent)

    def statements(self, items: Sequence[Node], indent: str) -> list[str]:
        """Statements as text."""
        found = []
        for item in items:
            match item:
                case c_ast.While(cond=cond, stmt=inner):
                    found += layout(f"{indent}while ", self.value(cond), " {")
                    found += [*self.statements(inner.block_items, indent + INDENT), f"{indent}}}"]
                case c_ast.For(init=c_ast.DeclList(decls=[index]), cond=cond, next=next_, stmt=inner):
                    found.append(f"{indent}let mut {spelled(index.name)} = 0;")
                    found += layout(f"{indent}while ", self.value(cond), " {")
                    found += [*self.statements([*inner.block_items, next_], indent + INDENT), f"{indent}}}"]
                case _:
                    found += _LINES(self._statement(item), indent)
        return found

    def _block(self, node: Node | None) -> tuple[Statement, ...]:
        match node:
            case None:
                return ()
            case c_ast.Compound(block_items=items):
                return tuple(each for item in items for each in self._statement(item))
            case _:
                return tuple(self._statement(node))

    def _statement(self, node: Node) -> Iterator[Statement]:
        match node:
            case Decl(name=name, type=c_ast.PtrDecl(), init=c_ast.UnaryOp(op="&", expr=place)):
                self.places[name] = self.place(place)
            case Decl(name=name, init=value):
                mutable = "" if "const" in node.quals else "mut "
                yield Do(f"let {mutable}{spelled(name)} = ", self.value(value))
            case c_ast.If(cond=c_ast.BinaryOp(op="!=", left=c_ast.ID(name="samples")), iftrue=then, iffalse=otherwise):
                given = replace(self, is_optional=False)
                yield If(Text("let Some(samples) = samples"), given._block(then), self._block(otherwise))
            case c_ast.If(cond=cond, iftrue=then, iffalse=otherwise):
                remark = self.printer.trees.remark(then.coord.line)
                yield If(self.code(cond), self._block(then), self._block(otherwise), remark)
            case c_ast.Assignment(op="+=", lvalue=c_ast.StructRef(field=c_ast.ID(name="together")) as place):
                more = Call("wrapping_add", (self.value(node.rvalue),))
                yield f"{self.place(place)} = {self.place(place)}.{flat(more)}"
            case c_ast.Assignment(lvalue=c_ast.StructRef(name=c_ast.StructRef(field=c_ast.ID(name="latest"))) as place):
                if place.field.name in self.printer.trees.files.samples.fields.values():
                    yield f"{self.place(place)} = {self.place(node.rvalue)}"  # a flag stands for that it comes
            case c_ast.Assignment(op="*=", lvalue=place, rvalue=value):
                yield Do(f"{self.place(place)} = ", Call(f"{self.place(place)}.wrapping_mul", (self.value(value),)))
            case c_ast.Assignment(op=operator, lvalue=place, rvalue=value):
                yield Do(f"{self.place(place)} {operator} ", self.value(value))
            case c_ast.UnaryOp(op="p++", expr=c_ast.ID(name=name)):
                yield f"{spelled(name)} += 1"
            case c_ast.UnaryOp(op="p++", expr=place):
                yield f"{self.place(place)} = {self.place(place)}.wrapping_add(1)"
            case c_ast.Return(expr=None):
                yield "return"
            case c_ast.Return(expr=value):
                yield Do("return ", self.value(value))
            case c_ast.Cast(expr=c_ast.ID()):
                pass
            case c_ast.Cast(expr=call):
                yield Do("", self.code(call))
            case c_ast.FuncCall(name=c_ast.ID(name=name), args=args) if (
                name == f"{self.printer.trees.files.prefix}_init"
            ):
                yield f"{self.place(args.exprs[0].expr)} = Monitors::new()"
            case c_ast.FuncCall():
                yield Do("", self.code(node))
            case _:
                raise TypeError(node)

    def place(self, node: Node) -> str:
        """A variable, or a member or an element of something."""
        match node:
            case c_ast.ID(name=name):
                return self.places.get(name) or spelled(name)
            case c_ast.StructRef(name=c_ast.ID(name="samples"), field=c_ast.ID(name=name)):
                return f"samples.{self.printer.fields[name]}"
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
                return Text(f"{operand} as {self.printer.types.text(type_.type)}")
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
        own = f"{self.printer.trees.files.prefix.upper()}_"
        if not name.startswith(own):
            return _CONSTANTS.get(name)
        short = name.removeprefix(own)
        if short in Verdict.__members__:
            return f"Verdict::{verdict_name(Verdict[short])}"
        return short if short in ("NEVER", *self.printer.trees.sizes) else None

    def _of_samples(self, name: str) -> str:
        """What asks a field of samples whether there is a value, or for that; news is what it is."""
        if name not in self.printer.trees.files.samples.fields.values():
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
        trees = self.printer.trees
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
        return Call(f"{of}.{self.printer.called(name)}", tuple(given))

    def _samples(self, called: str) -> Code:
        """The samples, as what a function is given."""
        is_wrapped = called in self.printer.trees.optional and not self.is_optional
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
