"""The names in a text and what each stands for, from the syntax alone: what is renamed, found and coloured."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from enum import Enum

from ltlc.base.source import Span
from ltlc.dataclass import dataclass
from ltlc.frontend.language import forall
from ltlc.frontend.language.primitives import PRIMITIVES
from ltlc.frontend.syntax import tree as syntax

_VARIABLE = re.compile(r"\{(\w+)\}")


class WordKind(Enum):
    """What a word is the name of."""

    NAME = "name"
    """A declaration, an association, a model, an object or a message: they share one space of names."""
    VARIABLE = "variable"
    """A variable of a `forall`."""
    LABEL = "label"
    """A property."""
    ATTRIBUTE = "attribute"
    """An attribute that a model adds to the primitives."""
    MEMBER = "member"
    """A primitive, a component of a vector, an angle."""
    TEMPLATE = "template"
    """A name with a variable in it, `{r}_battery`."""
    SETTING = "setting"
    TOPIC = "topic"
    TYPE = "type"
    CONSTANT = "constant"
    FUNCTION = "function"
    KEY = "key"
    """An attribute of a requirement."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """What words have in common that mean the same.

    `scope` is the place of the `forall` of a variable, the name of the model of an attribute.
    """

    kind: WordKind
    name: str
    scope: Span | str | None = None


@dataclass(frozen=True, slots=True)
class Word:
    """A name at a place, with what it stands for, and whether it is defined here."""

    span: Span
    symbol: Symbol
    defines: bool = False

    @property
    def kind(self) -> WordKind:
        """What it is the name of."""
        return self.symbol.kind

    @property
    def text(self) -> str:
        """The name."""
        return self.symbol.name


Attributes = Mapping[str, Collection[str]]
"""For each model, the attributes that it adds to the primitives."""

Variables = Mapping[str, Span]
"""The variables of the `forall` around a place, with the places of these."""


def words(tree: syntax.SyntaxTree, is_constant: Callable[[syntax.Reference], bool]) -> list[Word]:
    """The names in `tree` in the order of the text; `is_constant`: whether a name is a constant of messages."""
    models = [command for command in tree.commands if isinstance(command, syntax.Model)]
    attributes = {m.name.text: {a.name.text for a in m.attributes} - set(PRIMITIVES) for m in models}
    finder = _Finder(attributes, is_constant)
    return sorted((w for command in tree.commands for w in finder.command(command)), key=lambda w: w.span)


def _word(kind: WordKind, word: syntax.Word, scope: Span | str | None = None, *, defines: bool = False) -> Word:
    return Word(word.span, Symbol(kind, word.text, scope), defines)


@dataclass(frozen=True, slots=True)
class _Finder:
    attributes: Attributes
    is_constant: Callable[[syntax.Reference], bool]

    def command(self, command: syntax.Node) -> Iterator[Word]:
        match command:
            case syntax.Declaration() | syntax.ObjectFromTopic():
                yield _word(WordKind.NAME, command.name, defines=True)
                yield from _source(command)
            case syntax.Model(_, name, attributes):
                yield _word(WordKind.NAME, name, defines=True)
                for attribute in attributes:
                    is_own = attribute.name.text in self.attributes[name.text]
                    kind = WordKind.ATTRIBUTE if is_own else WordKind.MEMBER
                    yield _word(kind, attribute.name, name.text if is_own else None, defines=is_own)
                    yield from _source(attribute)
            case syntax.ObjectAtPlace(_, name) | syntax.Zone(_, name) | syntax.Association(_, name):
                yield _word(WordKind.NAME, name, defines=True)
                yield from self._inside(command, {})
            case syntax.Guard(_, raw, out, fallbacks):
                yield from (_word(WordKind.TOPIC, topic) for topic in (raw, out))
                yield from (_word(WordKind.NAME, name) for name in fallbacks)
            case syntax.Message(_, name, constants):
                yield _word(WordKind.NAME, name, defines=True)
                for constant in constants:
                    path = (constant.path.name, *constant.path.steps)
                    yield from (_word(WordKind.MEMBER, step) for step in path if isinstance(step, syntax.Word))
                yield from self._inside(command, {})
            case syntax.Setting(_, name, value):
                yield _word(WordKind.SETTING, name)
                yield from self._setting(name, value)
            case syntax.PropertyCommand(_, label, property_, _, lines):
                yield from (_word(WordKind.KEY, entry.key) for line in lines for entry in line.entries)
                if label is not None:
                    yield _word(WordKind.LABEL, label, defines=True)
                yield from self._property(property_)
            case _:
                pass

    def _setting(self, name: syntax.Word, value: syntax.Node) -> Iterator[Word]:
        """The value of a setting; that of `_simulator_` is not a name in the file."""
        if isinstance(value, syntax.Word):
            yield _word(WordKind.TOPIC, value)
        elif name.text == "_simulator_" and isinstance(value, syntax.Reference):
            yield _word(WordKind.CONSTANT, value.name)
        else:
            yield from self._inside(value, {})

    def _property(self, node: syntax.Node) -> Iterator[Word]:
        variables: dict[str, Span] = {}
        while isinstance(node, syntax.Forall):
            for variable in node.variables:
                variables[variable.text] = node.span
                yield _word(WordKind.VARIABLE, variable, node.span, defines=True)
            for name in node.names:
                yield _word(WordKind.NAME, name)
            node = node.body
        if isinstance(node, syntax.EachOf):
            yield _word(WordKind.VARIABLE, node.variable, node.span, defines=True)
            variables[node.variable.text] = node.span
        yield from self._inside(node, variables)

    def _inside(self, node: syntax.Node, variables: Variables) -> Iterator[Word]:
        openings: set[Span] = set()
        for part, _ in syntax.walk(node):
            match part:
                case syntax.History(_, _, syntax.Reference(place, syntax.Word(_, "opening"), ())):
                    openings.add(place)
                case syntax.Reference() if part.span not in openings:
                    yield from self._reference(part, variables)
                case syntax.Selection(_, _, steps):
                    yield from (_word(WordKind.MEMBER, step) for step in steps if isinstance(step, syntax.Word))
                case syntax.MessageConstant(_, message, name):
                    yield _word(WordKind.TYPE, message)
                    yield _word(WordKind.CONSTANT, name)
                case syntax.Call(_, name) | syntax.Quantified(_, name):
                    yield _word(WordKind.FUNCTION, name)
                case _:
                    pass

    def _reference(self, node: syntax.Reference, variables: Variables) -> Iterator[Word]:
        steps = [step for step in node.steps if isinstance(step, syntax.Word)]
        if node.name.text not in variables and self.is_constant(node):
            yield _word(WordKind.TYPE, node.name)
            yield from (_word(WordKind.CONSTANT, step) for step in steps)
            return
        attribute = next((s for s in steps[:1] if s.text in self.attributes.get(node.name.text, ())), None)
        for word, is_thing in forall.words(node):
            if word is attribute:
                yield _word(WordKind.ATTRIBUTE, word, node.name.text)
            else:
                yield from _part(word, is_thing, variables)


def _source(command: syntax.Declaration | syntax.ObjectFromTopic) -> Iterator[Word]:
    yield _word(WordKind.TOPIC, command.topic)
    yield _word(WordKind.TYPE, command.type)


def _part(word: syntax.Word, is_thing: bool, variables: Variables) -> Iterator[Word]:
    """A word of a reference other than an attribute, and the variables in it."""
    if "{" in word.text:
        yield _word(WordKind.TEMPLATE, word)
        for match in _VARIABLE.finditer(word.text):
            name = syntax.Word(Span(word.span.start + match.start(1), word.span.start + match.end(1)), match[1])
            yield _word(WordKind.VARIABLE, name, variables.get(match[1]))
    elif is_thing and word.text in variables:
        yield _word(WordKind.VARIABLE, word, variables[word.text])
    else:
        yield _word(WordKind.NAME if is_thing else WordKind.MEMBER, word)
