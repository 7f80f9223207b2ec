"""Emitted C as Rust: the same functions, with the same statements in the same order.

A function that is given a pointer to a struct is a method of that. Counters wrap, as they do in C.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from pycparser import c_ast
from pycparser.c_ast import Decl, FuncDef, Node

from ltlc.backends.operators import filled, flat, layout
from ltlc.backends.rust.code import comment, lines
from ltlc.backends.rust.expressions import Expressions
from ltlc.backends.rust.names import spelled
from ltlc.backends.rust.trees import Trees
from ltlc.backends.rust.types import Types
from ltlc.backends.statements import Do, If, Statement
from ltlc.backends.trees import INDENT, Call, Text
from ltlc.dataclass import dataclass


@dataclass(frozen=True)
class Printer:
    """Prints the functions of a file; samples have what is called as in `fields`, by what C calls it or its flag."""

    trees: Trees
    types: Types
    fields: Mapping[str, str]

    def function(self, name: str) -> list[str]:
        """A function, as a method where it is one."""
        node, owner = self.trees.functions[name], self.trees.owner(name)
        first = node.decl.type.args.params[0].name
        described = self.trees.about(name)
        indent = INDENT if owner else ""
        return [
            *(comment("///", *described, indent=indent) if described else []),
            *self._head(node, name, owner, indent),
            *self._body(name in self.trees.optional, {first: "self"} if owner else {}).lines(node, f"{indent}{INDENT}"),
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
        return self._body(False, {given: "new"}).statements(items, INDENT * 2)

    def _body(self, is_optional: bool, places: dict[str, str]) -> _Body:
        return _Body(self.trees, self.types, self.fields, is_optional, places)

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
        return filled(f"{indent}{of}fn {self.trees.called(name)}(", pieces, f"){returned} {{", indent + INDENT * 2)

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


class _Body(Expressions):
    """The body of a function."""

    def lines(self, function: FuncDef, indent: str) -> list[str]:
        """Its statements; the last one may be the value of the function."""
        items = function.body.block_items or []
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
                    found += lines(self._statement(item), indent)
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
                remark = self.trees.remark(then.coord.line)
                yield If(self.code(cond), self._block(then), self._block(otherwise), remark)
            case c_ast.Assignment(op="+=", lvalue=c_ast.StructRef(field=c_ast.ID(name="together")) as place):
                more = Call("wrapping_add", (self.value(node.rvalue),))
                yield f"{self.place(place)} = {self.place(place)}.{flat(more)}"
            case c_ast.Assignment(lvalue=c_ast.StructRef(name=c_ast.StructRef(field=c_ast.ID(name="latest"))) as place):
                if place.field.name in self.trees.files.samples.fields.values():
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
            case c_ast.FuncCall(name=c_ast.ID(name=name), args=args) if name == f"{self.trees.files.prefix}_init":
                yield f"{self.place(args.exprs[0].expr)} = Monitors::new()"
            case c_ast.FuncCall():
                yield Do("", self.code(node))
            case _:
                raise TypeError(node)
