"""Functions of emitted C in plain form: what they say, whatever a language with the same statements calls it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from pycparser import c_ast
from pycparser.c_ast import Decl, FuncDef, Node

from ltlc.assurance.reading.c.definitions import Definitions, parameters, statements, type_text
from ltlc.assurance.reading.c.front import not_understood
from ltlc.assurance.reading.plain import Tree, joined


class Plain:
    """The structs and functions of a file; a function that is given a pointer to a struct is a method of that."""

    def __init__(self, definitions: Definitions) -> None:
        sizes = definitions.types.get(f"{definitions.prefix}_size")
        self._sizes = sizes.values.enumerators if sizes else ()
        self.functions, self._prefix = definitions.functions, f"{definitions.prefix}_"
        self.structs = {
            self.short(name): struct
            for name, struct in definitions.types.items()
            if isinstance(struct, c_ast.Struct) and struct.decls[0].name != "elements"
        }

    def short(self, name: str) -> str:
        """A name without the prefix of public ones."""
        return name.removeprefix(self._prefix)

    def owner(self, name: str) -> str | None:
        """The struct that a function is given before all else; None if it is given none."""
        given = parameters(self.functions[name])[:1] if name in self.functions else []
        short = self.short(type_text(given[0]).removesuffix(" *")) if given else ""
        return short if short in self.structs else None

    def method(self, name: str) -> str:
        """What a function is called: one of a property or a table without the name of that, and without the prefix."""
        owner = self.owner(name)
        called = name if "static" in self.functions[name].decl.storage else self.short(name)
        return called if owner == "monitors" else called.removeprefix(f"{owner}_")

    def sizes(self) -> dict[str, str]:
        """How many of something there are at most, by the names of constants."""
        return {self.constant(each.name): each.value.value for each in self._sizes}

    def begins(self, struct: str) -> FuncDef | None:
        """The function that makes a struct ready."""
        return self.functions.get(f"{self._prefix}{'' if struct == 'monitors' else f'{struct}_'}init")

    def is_method(self, name: str) -> bool:
        """Whether it is one."""
        return self.owner(name) is not None

    def sampled(self, name: str) -> Tree:
        """What is asked of samples by a name in C."""
        members = self.structs["samples"].decls
        values = [each.name for each in members if each.bitsize is None]
        flags = dict(zip((each.name for each in members if each.bitsize is not None), values, strict=False))
        if name in values:
            return "unwrap_or_default", name
        return ("is_some", flags[name]) if name in flags else (".", "samples", name)

    def kept_by(self) -> dict[str, str]:
        """For each property the member of monitors that keeps its samples, as what counts its steps says."""
        (switch,) = statements(self.functions[f"{self._prefix}steps_of"])
        *cases, _ = (case.stmts[0].expr for case in switch.stmt.block_items)
        return {each.right.name.field.name: each.left.left.name.field.name for each in cases}

    def body(self, function: FuncDef) -> tuple[Tree, ...]:
        """What a function does; what makes a struct ready begins with one of which all is 0."""
        given, items = parameters(function), statements(function)
        if function in map(self.begins, self.structs):
            new: Tree = ("let", "new", "Self::NEW")
            return new, *_Body(self, {given[0].name: "new"}).block(items[1:]), ("return", "new")
        return _Body(self, {given[0].name: "self"} if self.is_method(function.decl.name) else {}).block(items)

    def constant(self, name: str) -> str:
        """A name without the prefix of constants."""
        return name.removeprefix(self._prefix.upper())


class _Body:
    """The statements of a function; `places` are what pointers lead to."""

    def __init__(self, file: Plain, places: dict[str, Tree]) -> None:
        self.file, self.places = file, places

    def block(self, items: Sequence[Node]) -> tuple[Tree, ...]:
        """Statements."""
        return tuple(found for item in items for found in self._statement(item))

    def _statement(self, node: Node) -> Iterator[Tree]:
        match node:
            case Decl(name=name, type=c_ast.PtrDecl(), init=c_ast.UnaryOp(op="&", expr=place)):
                self.places[name] = self.tree(place)
            case Decl(name=name, init=value):
                yield "let", name, self.tree(value)
            case c_ast.If(cond=cond, iftrue=then, iffalse=otherwise):
                yield "if", self.tree(cond), self._inner(then), self._inner(otherwise)
            case c_ast.While(cond=cond, stmt=inner):
                yield "while", self.tree(cond), self._inner(inner)
            case c_ast.For(init=c_ast.DeclList(decls=[index]), cond=cond, next=next_, stmt=inner):
                yield from self._statement(index)
                yield "while", self.tree(cond), (*self._inner(inner), *self._statement(next_))
            case c_ast.Assignment(lvalue=c_ast.StructRef(name=c_ast.StructRef(field=c_ast.ID(name="latest"))) as place):
                match node.rvalue:
                    case c_ast.ID(name="true"):
                        pass  # a value is there that has come
                    case c_ast.StructRef(name=c_ast.ID(name="samples"), field=field):
                        yield "=", self.tree(place), (".", "samples", field.name)
                    case _:
                        raise not_understood(node)
            case c_ast.Assignment(op="=" | "+=" | "-=" | "*=" | "^=" as operator, lvalue=place, rvalue=value):
                yield operator, self.tree(place), self.tree(value)
            case c_ast.UnaryOp(op="p++", expr=place):
                yield "+=", self.tree(place), "1"
            case c_ast.Return(expr=value):
                yield "return", "" if value is None else self.tree(value)
            case c_ast.FuncCall(name=c_ast.ID(name=name), args=args) if self.file.short(name) == "init":
                yield "=", self.tree(args.exprs[0]), ("call", "Monitors::new")
            case c_ast.FuncCall():
                yield "do", self.tree(node)
            case c_ast.Cast(expr=c_ast.FuncCall() as call):
                yield "do", self.tree(call)
            case _:
                raise not_understood(node)

    def _inner(self, node: Node | None) -> tuple[Tree, ...]:
        match node:
            case None:
                return ()
            case c_ast.Compound(block_items=items):
                return self.block(items or [])
            case _:
                return self.block([node])

    def tree(self, node: Node) -> Tree:
        """An expression."""
        match node:
            case c_ast.Constant(type="string", value=text):
                return "text", re.sub(rb"\\([0-7]{3}|.)", _byte, text[1:-1].encode()).decode()
            case c_ast.Constant(value=value):
                return str(value).rstrip("u")
            case c_ast.ID(name=name):
                return self.places.get(name, self.file.constant(name))
            case c_ast.StructRef(name=c_ast.ID(name="samples"), field=field):
                return self.file.sampled(field.name)
            case c_ast.StructRef(name=inner, field=field):
                return ".", self.tree(inner), field.name
            case c_ast.ArrayRef(name=c_ast.StructRef(name=array, field=c_ast.ID(name="elements")), subscript=index):
                return "[]", self.tree(array), self.tree(index)
            case c_ast.ArrayRef(name=array, subscript=index):
                return "[]", self.tree(array), self.tree(index)
            case c_ast.UnaryOp(op="!", expr=c_ast.FuncCall(name=c_ast.ID(name="same_text"), args=args)):
                return joined("!=", *map(self.tree, args.exprs))
            case c_ast.UnaryOp(op="&" | "*", expr=inner):
                return self.tree(inner)
            case c_ast.UnaryOp(op="!" | "-" as operator, expr=inner):
                return operator, self.tree(inner)
            case c_ast.Cast(expr=c_ast.ID(name="INFINITY" | "NAN") as constant):
                return self.tree(constant)
            case c_ast.Cast(to_type=type_, expr=inner):
                return "cast", type_text(type_), self.tree(inner)
            case c_ast.BinaryOp(op=operator, left=left, right=right):
                return joined(operator, self.tree(left), self.tree(right))
            case c_ast.TernaryOp(cond=guard, iftrue=then, iffalse=otherwise):
                return "?", *map(self.tree, (guard, then, otherwise))
            case c_ast.CompoundLiteral(init=items):
                return "{}", *map(self.tree, items.exprs)
            case c_ast.FuncCall(name=c_ast.ID(name="INT64_C" | "UINT64_C"), args=args):
                return self.tree(args.exprs[0])
            case c_ast.FuncCall(name=c_ast.ID(name="same_text"), args=args):
                return joined("==", *map(self.tree, args.exprs))
            case c_ast.FuncCall(name=c_ast.ID(name=name), args=args):
                method = f".{self.file.method(name)}" if self.file.is_method(name) else name
                return "call", method, *map(self.tree, args.exprs)
            case _:
                raise not_understood(node)


def _byte(escaped: re.Match[bytes]) -> bytes:
    return bytes([int(escaped[1], 8)]) if len(escaped[1]) == 3 else escaped[1]
