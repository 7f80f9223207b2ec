"""Emitted Rust read back: it must be equivalent to emitted C, which is read as C.

All but the bodies of functions is compared token by token with what it has to be, lifetimes left out, which the
compiler sees to; the bodies are compared as trees with those of C.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from pycparser.c_ast import Decl, FuncDef, Node

from ltlc.assurance.reading.c.definitions import Definitions, parameters, shaped, type_text
from ltlc.assurance.reading.c.files import WrittenInC
from ltlc.assurance.reading.c.files import written as written_in_c
from ltlc.assurance.reading.c.front import PLURALS
from ltlc.assurance.reading.c.members import Property
from ltlc.assurance.reading.c.plain import Plain
from ltlc.assurance.reading.outcomes import Difference
from ltlc.assurance.reading.rust_text import Parser, tokens
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.backends.rust.functions import FUNCTIONS, ONLY_IN_C
from ltlc.runtime.times import NEVER
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict

_SCALARS = {f"{sign}int{bits}_t": f"{'u' if sign else 'i'}{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)}
_SCALARS |= {"bool": "bool", "char *": "&str", "float": "f32", "double": "f64", "size_t": "usize", "void": ""}


def written(
    text: str,
    header: str,
    source: str,
    properties: Sequence[Property],
    rate: float | None = None,
    timeout: Nanoseconds | None = None,
) -> Sequence[WrittenInC | Difference]:
    """What is written of each of `properties` in a file that has to say what a header and a source file say in C.

    `rate`, in Hz, and `timeout` are those of their specification.
    """
    parts = written_in_c(header, source, properties, rate, timeout, is_grouped=False)
    read = next((part.definitions for part in parts if isinstance(part, WrittenInC)), None)
    try:
        if read is not None:
            require_same(text, read, [each.specification.label for each in properties])
    except NotUnderstoodError as error:
        return [Difference(str(error))] * len(properties)
    return parts


def require_same(text: str, c: Definitions, labels: Sequence[str]) -> None:
    """Raise NotUnderstoodError unless a file says of the properties with these labels what one of C says of them."""
    with shaped():
        _File(text, c, labels).require_equal()


class _Body(tuple[str, FuncDef]):
    """What stands for the body of a function of C, in the midst of tokens."""


class _File:
    """A file, and the definitions in C of which it has to be the same. Raises NotUnderstoodError."""

    def __init__(self, text: str, c: Definitions, labels: Sequence[str]) -> None:
        self.found = [_plain_name(token) for token in _without_lifetimes([each.text for each in tokens(text)])]
        self.c, self.prefix = Plain(c), f"{c.prefix}_"
        self.structs = self.c.structs
        self.names = self._names(labels)
        self.kept = self.c.kept_by()
        self.optional = ("take", "go_on") if "take" in self.c.functions else ()
        self.properties = dict(zip(self.kept, self.names, strict=True))
        self.types = {each: self.properties.get(each) or each[0].upper() + each[1:] for each in self.structs}
        self.sizes = self.c.sizes()

    def _names(self, labels: Sequence[str]) -> list[str]:
        """What properties are called, each of which has to recall its label."""
        inner = self.found[self.found.index("Property") + 2 :] if "Property" in self.found else []
        names = [name for name in inner[: 2 * len(labels)] if name != ","]
        for name, label in zip(names, labels, strict=False):
            words = "".join(re.findall(r"[A-Za-z0-9]+", label)).lower()
            if not re.fullmatch(rf"(property)?{words}\d*", name.replace("_", "").lower()):
                raise NotUnderstoodError(f"`{name}` does not recall `{label}`")
        if len(set(names)) != len(labels):
            raise NotUnderstoodError("there are other properties")
        return names

    def require_equal(self) -> None:
        """All of it is what it has to be."""
        at = 0
        for right in self._right():
            if isinstance(right, str):
                if self.found[at : at + 1] != [right]:
                    raise NotUnderstoodError(f"`{' '.join(self.found[at : at + 5])}` stands where `{right}` should")
                at += 1
                continue
            name, function = right
            parser = Parser(self.found, at)
            if parser.block() != self.c.body(function):
                raise NotUnderstoodError(f"the function `{name}` does something else")
            at = parser.at
        if at < len(self.found):
            raise NotUnderstoodError(f"`{' '.join(self.found[at : at + 5])}` is more than there should be")

    def _right(self) -> Iterator[str | _Body]:
        """The tokens that there have to be; of functions that say what those of C do, these."""
        properties = self.names
        verdicts = (Verdict.NOT_STARTED, *(each for each in Verdict if each is not Verdict.NOT_STARTED))
        derive = "#[derive(Clone, Copy, Debug"
        named = "".join(f"{each.name.title().replace('_', '')}," for each in verdicts)
        sampled = self._sampled(self.structs["samples"].decls)
        fields = "".join(f"pub {name}: {type_}," for name, type_, _ in sampled)
        yield from _tokens(f"""
            #![allow(dead_code, non_camel_case_types, non_snake_case, unused_variables)]
            pub const NEVER: i64 = {NEVER};
            {"".join(f"pub const {name}: u32 = {count};" for name, count in self.sizes.items())}
            {derive}, PartialEq, Eq)] pub enum Verdict {{ {named} }}
            {derive}, PartialEq, Eq)] pub struct Judgement {{
                pub verdict: Verdict, pub since: i64, pub steps: u32, pub invalid: u32, }}
            {derive}, PartialEq, Eq)] pub enum Property {{ {"".join(f"{each}," for each in properties)} }}
            impl Property {{ pub const ALL: [Self; {len(properties)}] =
                [{"".join(f"Self::{each}," for each in properties)}]; }}
            {derive}, Default)] pub struct Samples {{ {fields} }}""")
        yield from _tokens("".join(text for name, text in FUNCTIONS.items() if name in self._called()))
        own = [name for name in self.c.functions if name not in (*FUNCTIONS, *ONLY_IN_C)]
        for name in own:
            if self.c.owner(name) is None:
                yield from self._function(name)
        for short, struct in self.structs.items():
            if short != "samples":
                is_read = short in _TABLES and short not in self.properties
                made, of = "pub " if short == "monitors" or is_read else "", "pub " if is_read else ""
                members = [(each.name, self._type(each), self._first(each)) for each in struct.decls]
                yield from _tokens(f"""
                    {derive})] {made}struct {self.types[short]} {{ {"".join(f"{of}{n}: {t}," for n, t, _ in members)} }}
                    impl {self.types[short]} {{ const NEW: Self = Self {{
                        {"".join(f"{n}: {f}," for n, _, f in members)} }};""")
                begun = self.c.begins(short)
                if begun is not None:
                    yield from _tokens("pub const fn new() -> Self")
                    yield _Body(("new", begun))
                yield from self._of_monitors() if short == "monitors" else ()
                for name in own:
                    if self.c.owner(name) == short:
                        yield from self._function(name)
                yield "}"
                if begun is not None:
                    yield from _tokens(
                        f"impl Default for {self.types[short]} {{ fn default() -> Self {{ Self::new() }} }}"
                    )

    def _called(self) -> set[str]:
        """The functions that files share and that this one has."""
        return {name for word, name in zip(self.found, self.found[1:], strict=False) if word == "fn"}

    def _of_monitors(self) -> Iterator[str | _Body]:
        """What asks monitors; without clocks, nothing depends on the time."""
        cases = "".join(
            f"""Property::{type_} => Judgement {{ verdict: self.{name}.verdict, since: self.{name}.since,
                steps: self.{kept}.together.wrapping_add(self.{name}.apart).wrapping_sub(self.{name}.invalid),
                invalid: self.{name}.invalid, }},"""
            for (name, type_), kept in zip(self.properties.items(), self.kept.values(), strict=True)
        )
        yield from _tokens(
            f"pub fn judgement(&self, property: Property) -> Judgement {{ match property {{ {cases} }} }}"
        )
        for name, text in _WITHOUT.items():
            if f"{self.prefix}{name}" not in self.c.functions:
                yield from _tokens(text)

    def _function(self, name: str) -> Iterator[str | _Body]:
        owner, function = self.c.owner(name), self.c.functions[name]
        short = self.c.short(name)
        apart = ("verdict_of", "steps_of", "invalid_of", "since_of", "left_out_of")
        if owner is not None and (short in apart or function == self.c.begins(owner)):
            return
        first, *rest = parameters(function)
        given = [f"{each.name}: {self._parameter(name, each)}" for each in (rest if owner else (first, *rest))]
        own = ["&self" if "const" in first.type.type.quals else "&mut self"] if owner else []
        public = "" if "static" in function.decl.storage else "pub "
        result = self._result(type_text(function.decl.type))
        yield from _tokens(
            f"{public}fn {self.c.method(name)}({', '.join([*own, *given])}) {f'-> {result}' if result else ''}"
        )
        yield _Body((name, function))

    def _parameter(self, function: str, node: Decl) -> str:
        """The type of what a function is given: of samples, which there may be or not, or of another struct."""
        type_ = self._type(node)
        borrowed = f"&{type_}" if type_ in self.types.values() else type_
        return f"Option<{borrowed}>" if node.name == "samples" and function in self.optional else borrowed

    def _result(self, type_: str) -> str:
        """The type of what a function returns, which is none where C has NULL."""
        short = self.c.short(type_.removesuffix(" *"))
        if short in self.types:
            return f"Option<&{self.types[short]}>"
        return "Verdict" if short == "verdict" else _SCALARS[type_]

    def _type(self, node: Node) -> str:
        """How a type is written."""
        return (
            "Verdict" if node.name == "verdict" else self._written(type_text(node).removesuffix(" *"), type_text(node))
        )

    def _written(self, bare: str, whole: str) -> str:
        short = self.c.short(bare)
        if array := re.fullmatch(r"(.*)\[(\w+)\]", whole):
            count = array[2] if array[2].isdigit() else f"{self.c.constant(array[2])} as usize"
            return f"[{self._written(array[1].removesuffix(' *'), array[1])}; {count}]"
        if short in PLURALS:
            return f"&[{_SCALARS[PLURALS[short]]}]"
        return self.types.get(short) or _SCALARS[whole]

    def _first(self, node: Node) -> str:
        """The value that is 0 in C."""
        type_ = self._type(node)
        if type_.startswith("["):
            inner, count = type_[1:-1].split("; ")
            return f"[{self._zero(inner)}; {count}]"
        return self._zero(type_)

    def _zero(self, type_: str) -> str:
        if type_ == self.types["samples"]:
            given = self._sampled(self.structs["samples"].decls)
            members = (f"{name}: {'false' if is_told else 'None'}" for name, _, is_told in given)
            return f"Samples {{ {', '.join(members)} }}"
        if type_ in self.types.values():
            return f"{type_}::NEW"
        simple = {"&str": '""', "bool": "false", "f32": "0.0", "f64": "0.0", "Verdict": "Verdict::NotStarted"}
        return "&[]" if type_.startswith("&[") else simple.get(type_, "0")

    def _sampled(self, members: Sequence[Decl]) -> Iterator[tuple[str, str, bool]]:
        """Each value that may come, and each message, with its type, and whether it is a message.

        A flag marks that a value comes.
        """
        values = [each for each in members if each.bitsize is None and each.name != "nothing"]
        told = [each for each in members if each.bitsize is not None][len(values) :]
        yield from ((each.name, f"Option<{self._type(each)}>", False) for each in values)
        yield from ((each.name, "bool", True) for each in told)


_TABLES = ("ids", "slice", "instances", "instance", "violation")
"""The structs of tables, whose members can be read."""

_WITHOUT = {
    "begin": "pub fn begin(&mut self, time: i64) -> bool { self.pass(time) }",
    "advance": "pub fn advance(&mut self, time: i64) -> bool { self.pass(time) }",
    "next_deadline": "pub fn next_deadline(&self) -> i64 { NEVER }",
}
"""What there is in Rust where C has no such function."""


def _tokens(text: str) -> Iterator[str]:
    yield from _without_lifetimes([each.text for each in tokens(text)])


def _without_lifetimes(found: Sequence[str]) -> Iterator[str]:
    """Tokens but for `'a` and, where nothing else is in brackets, `<'a>`."""
    at = 0
    while at < len(found):
        size = 4 if found[at : at + 4] == ["<", "'", "a", ">"] else 2 if found[at : at + 2] == ["'", "a"] else 0
        if not size:
            yield found[at]
        at += size or 1


def _plain_name(token: str) -> str:
    """A name that Rust reserves is that of C with `_` behind it."""
    return token.removesuffix("_") or token if token.isidentifier() else token
