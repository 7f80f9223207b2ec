"""What can be written at a place, by what the grammar expects there and the names that the file has."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from ltlc.base.codes import CODES
from ltlc.base.source import Span
from ltlc.frontend.language.define import SETTINGS
from ltlc.frontend.language.primitives import MODELLED
from ltlc.frontend.language.signals import SIMULATORS, SOURCES
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.lexer import CONTEXTUAL, FUNCTIONS, KEYWORDS, QUANTIFIERS
from ltlc.frontend.syntax.parse import Expectation, expected_after
from ltlc.interfaces.editor.document import Document
from ltlc.interfaces.editor.keywords import KEYS, MEANINGS
from ltlc.interfaces.editor.members import Suggestion, fields_after, members
from ltlc.interfaces.editor.words import WordKind

_WORD = re.compile(r"\w*\Z")
_CHUNK = re.compile(r"[^\s#;,=()]*\Z")
_DOTTED = re.compile(r"((?:[\w/]|\{\w+\})+(?:\.(?:\w|\{\w+\})+|\[[^\]\n]*\])*)\.\w*\Z")
_EACH = re.compile(r"\beach[ \t]+(\w+)[ \t]+of\b\s*(\w+)")
_HEAD = re.compile(r"(?:^|:)[ \t]*each[ \t]+(?:(\w+)[ \t]+)?\Z", re.MULTILINE)
_GUARD = re.compile(r"^[ \t]*guard[ \t]+(?:(\S+)[ \t]+(to[ \t]+)?)?\Z", re.MULTILINE)
_IN_MESSAGE = re.compile(r"\bmessage[ \t]+(\w+)[ \t]*\{(?:[^{}]*,)?\s*((?:\w+\.)*)\Z")
_COUNTED = re.compile(r"\bonce\b[^\n,]*[ \t]\d+[ \t]+\Z")
_FORALL = re.compile(r"\bforall\b([\w\s,]+)\bin\s*\{([\w\s,]*)\}")
_COMMENT = re.compile(r'(?:[^"#\n]|"(?:[^"\\\n]|\\.)*")*#(.*)')
_SUPPRESSION = re.compile(r"\s*ltlc:\s*(?:ignore-file|ignore)\s")

LONGEST = 1000
"""So many characters a name has at most, with what stands before its dots."""

_CONTINUING = frozenset({"and", "or", "implies", "since", "within", "for", "in"})
"""The keywords that continue what is complete."""


class Completions(NamedTuple):
    """What may be written in place of a span."""

    span: Span
    suggestions: tuple[Suggestion, ...] = ()


def completions(document: Document, offset: int) -> Completions:
    """What may be written before `offset`, in place of the beginning of a word that stands there."""
    before = document.text[:offset]
    line = before[before.rfind("\n") + 1 :]
    if comment := _COMMENT.match(line):
        return _at(before, _WORD, _codes() if _SUPPRESSION.match(comment[1]) else ())
    chunk = _begun(before, _CHUNK)
    expected = expected_after(before.removesuffix(chunk))
    if "TYPE" in expected.terminals:
        return _at(before, _WORD if "." in chunk else _CHUNK, _types(document, expected, chunk))
    if "TOPIC" in expected.terminals and ("NUMBER" not in expected.terminals or chunk.startswith(("/", "~"))):
        return _at(before, _CHUNK, [*_topics(document), *_keywords(expected.terminals)])
    word = _begun(before, _WORD)
    if guard := _at_end(before.removesuffix(chunk), _GUARD):
        return _at(before, _CHUNK, _words_of("to") if guard[1] and not guard[2] else _topics(document))
    if inside := _at_end(before.removesuffix(word), _IN_MESSAGE):
        return _at(before, _WORD, _fields(document, inside[1], inside[2]))
    expected = expected if word == chunk else expected_after(before.removesuffix(word))
    variables = _variables(before[expected.start :])
    if dotted := _at_end(before, _DOTTED):
        return _at(before, _WORD, members(document, dotted[1], variables))
    if head := _at_end(before.removesuffix(word), _HEAD):
        return _at(before, _WORD, _names(document) if head[1] == "new" else _words_of("of" if head[1] else "new"))
    if _at_end(before.removesuffix(word), _COUNTED):
        return _at(before, _WORD, _words_of("times"))
    if "and" in expected.terminals and line.removesuffix(word).strip():
        return _at(before, _WORD, _keywords(expected.terminals & _CONTINUING))
    return _at(before, _WORD, _words(document, expected, variables))


def _begun(before: str, pattern: re.Pattern[str]) -> str:
    """What `pattern`, which matches nothing too, matches at the end of `before`."""
    match = _at_end(before, pattern)
    return match.group() if match else ""


def _at_end(before: str, pattern: re.Pattern[str]) -> re.Match[str] | None:
    """What `pattern` finds at the end of `before`, of which it sees no more than the longest that is offered anything.

    It tries each place, and goes from there as far as words do.
    """
    return pattern.search(before, max(0, len(before) - LONGEST))


def _at(before: str, pattern: re.Pattern[str], found: Iterable[Suggestion]) -> Completions:
    """`found`, each once, in place of what `pattern` matches at the end of `before`."""
    span = Span(len(before) - len(_begun(before, pattern)), len(before))
    return Completions(span, tuple({suggestion.text: suggestion for suggestion in found}.values()))


def _codes() -> Iterator[Suggestion]:
    return (Suggestion(code, "code", known.title) for code, known in CODES.items())


def _topics(document: Document) -> Iterator[Suggestion]:
    return (Suggestion(word.text, "topic") for word in document.words if word.kind is WordKind.TOPIC)


def _fields(document: Document, message: str, path: str) -> Iterator[Suggestion]:
    """The fields behind `path` of what the guard sends that may send `message`."""
    checker = document.reading.checker
    for guard in (command for command in document.tree.commands if isinstance(command, syntax.Guard)):
        out = f"/{guard.out.text.removeprefix('/')}"
        if message in (name.text for name in guard.fallbacks) and out in checker.names.topics:
            yield from fields_after(f"{checker.names.topics[out][0]}.{path}", checker.types)


def _types(document: Document, expected: Expectation, written: str) -> Iterator[Suggestion]:
    """Message types, of which only some tell where an object is; after a dot, the fields of the message there."""
    types = document.reading.checker.types
    if "." in written:
        yield from fields_after(written.rpartition(".")[0], types)
        return
    is_object = [token.terminal for token in expected.tokens[:1]] == ["object"]
    for full in SOURCES if is_object else types.messages:
        package, _, short = full.rpartition("/")
        is_unique = len(types.find(short)) == 1 and "/" not in written
        yield Suggestion(short if is_unique else f"{package.removesuffix('/msg')}/{short}", "type", full)


def _variables(command: str) -> Mapping[str, str]:
    """The variables of the `forall` and `each` in the text of a command, each with what it stands for."""
    found: dict[str, str] = {}
    for match in _FORALL.finditer(command):
        name = match[2].partition(",")[0].strip()
        found |= {variable.strip(): f"a variable of `forall`: {name}" for variable in match[1].split(",")}
    return found | {match[1]: f"a value of `{match[2]}`" for match in _EACH.finditer(command)}


def _words(document: Document, expected: Expectation, variables: Mapping[str, str]) -> Iterator[Suggestion]:
    """Keywords, names, functions and settings, whichever can stand there."""
    before = [token.text for token in expected.tokens]
    if before == ["_simulator_", "="]:
        yield from (Suggestion(name, "constant", topic) for name, (topic, _) in SIMULATORS.items())
        return
    if "ATTRIBUTES" in [token.terminal for token in expected.tokens]:
        is_key = expected.tokens[-1].terminal in ("ATTRIBUTES", ",")
        yield from (Suggestion(key, "attribute", known.says) for key, known in KEYS.items() if is_key)
        return
    yield from _keywords(expected.terminals)
    if "SETTING" in expected.terminals:
        yield from (Suggestion(name, "setting", MEANINGS[name].form) for name in SETTINGS)
    if "NUMBER" in expected.terminals:
        yield from (Suggestion(name, "variable", of) for name, of in variables.items())
        yield from _names(document)
        if before[-1:] in (["=="], ["!="]):
            yield from _with_constants(document)
        functions = (*FUNCTIONS, *(QUANTIFIERS if "QUANTIFIER" in expected.terminals else ()))
        yield from (Suggestion(name, "function", MEANINGS[name].form) for name in functions)
    elif before[:1] == ["guard"] and before[-1] in ("else", ","):
        messages = (command for command in document.tree.commands if isinstance(command, syntax.Message))
        yield from (Suggestion(command.name.text, "message") for command in messages)
    elif "of" in before and before[-1] in ("of", ","):
        yield from _names(document)
    elif before[:1] == ["forall"] and "{" in before:
        yield from (Suggestion(name, "object") for name in document.things())
    elif before[:1] == ["model"] and ":" in before:
        yield from (Suggestion(name, "attribute", "what primitives compare with the ground truth") for name in MODELLED)
    if "@" in before[-4:] and before[-1:] == [","]:
        yield Suggestion("opening", "keyword", MEANINGS["opening"].form)


def _with_constants(document: Document) -> Iterator[Suggestion]:
    """The types of messages that define constants."""
    messages = document.reading.checker.types.messages
    return (Suggestion(full.rpartition("/")[2], "type", full) for full, of in messages.items() if of.constants)


def _keywords(terminals: frozenset[str]) -> Iterator[Suggestion]:
    offered = {"within" if terminal == "WITHIN_FIRST" else terminal for terminal in terminals}
    return _words_of(*sorted(offered & (KEYWORDS | CONTEXTUAL)))


def _words_of(*words: str) -> Iterator[Suggestion]:
    """Words of the language."""
    return (Suggestion(word, "keyword", MEANINGS[word].form if word in MEANINGS else "") for word in words)


def _names(document: Document) -> Iterator[Suggestion]:
    yield from (Suggestion(name, "object", "object") for name in document.things())
    for kind, word in document.reading.checker.names.definitions:
        yield Suggestion(word.text, kind.value, kind.value)
