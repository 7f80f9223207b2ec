"""A specification as it stands in an editor: whatever of it can be understood, whether it has errors or not."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.language import MAX_BYTES, ReadText, read
from ltlc.frontend.language.forall import written_out
from ltlc.frontend.language.names import Checker
from ltlc.frontend.language.references import is_short_constant, referent
from ltlc.frontend.language.values import Value
from ltlc.frontend.syntax import tree as syntax
from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.interfaces.editor.words import Symbol, Word, WordKind, words
from ltlc.semantics.encodings import EPISODE, Encoding
from ltlc.specification.specification import PropertySpecification


@dataclass(frozen=True)
class Document:
    """A text with what was read of it; `diagnostics` are those of the front end."""

    source: Source
    reading: ReadText
    diagnostics: tuple[Diagnostic, ...]

    @property
    def text(self) -> str:
        """The text."""
        return self.source.text

    @property
    def tree(self) -> syntax.SyntaxTree:
        """The commands that can be parsed, as the author wrote them."""
        return self.reading.tree

    @property
    def is_sound(self) -> bool:
        """Whether there is a specification that analyses can be asked about."""
        return not (self.reading.checker.has_failed or any(d.severity.value == "error" for d in self.diagnostics))

    @property
    def properties(self) -> tuple[PropertySpecification, ...]:
        """The properties that have no error."""
        return self.reading.sound.properties

    @property
    def checker(self) -> Checker:
        """What looks up names here; what it reports goes nowhere."""
        return replace(self.reading.checker, diagnostics=[], _reported=set())

    @cached_property
    def words(self) -> list[Word]:
        """The names of the text, with what they stand for, in its order."""
        return words(self.tree, lambda node: is_short_constant(self.reading.checker, node))

    def word_at(self, offset: int) -> Word | None:
        """The name that the character at `offset`, or the one before it, belongs to; the innermost if several do."""
        touching = [word for word in self.words if word.span.start <= offset <= word.span.end]
        return min(touching, key=lambda w: (w.span.end == offset, w.span.end - w.span.start), default=None)

    def occurrences(self, symbol: Symbol) -> list[Word]:
        """Where `symbol` is defined and used."""
        return [word for word in self.words if word.symbol == symbol]

    @cached_property
    def references(self) -> list[syntax.Reference]:
        """All references, those under `forall` once for each of its names."""
        whole = written_out(self.checker, self.tree)
        nodes = (node for command in whole.commands for node, _ in syntax.walk(command))
        return [node for node in nodes if isinstance(node, syntax.Reference)]

    def references_at(self, offset: int) -> list[syntax.Reference]:
        """The references around `offset`: several if they stand under a `forall`."""
        return [node for node in self.references if node.span.start <= offset <= node.span.end]

    def property_at(self, offset: int) -> PropertySpecification | None:
        """The property around `offset`; under a `forall`, its first one."""
        return next((p for p in self.properties if p.span.start <= offset <= p.span.end), None)

    def value(self, node: syntax.Reference) -> Value | None:
        """What `node` stands for, if it has a value."""
        return referent(self.checker, node)

    def is_thing(self, name: str) -> bool:
        """Whether `name` is that of an object or a model, declared or not."""
        names = self.reading.checker.names
        return any(name in known for known in (names.objects, names.models, names.undeclared))

    def things(self) -> list[str]:
        """The names of objects and models, declared or not."""
        return list(dict.fromkeys(w.text for w in self.words if w.kind is WordKind.NAME and self.is_thing(w.text)))


def document(source: Source, types: MessageTypes, encoding: Encoding = EPISODE) -> Document:
    """`source` as far as it can be understood; one that is too long as if it were empty."""
    if len(source.text) > MAX_BYTES:
        message = f"the text is longer than {MAX_BYTES} characters: it is not a specification"
        nothing = Source(source.name, "")
        too_long = diagnostic("LTL905", nothing, Span(0, 0), message)
        return Document(nothing, read(nothing, types, encoding), (too_long,))
    reading = read(source, types, encoding)
    return Document(source, reading, tuple(reading.diagnostics))
