"""From text to the syntax tree, by the LALR(1) automaton of `grammar.lark`; all syntax errors of a file are collected.

After an error the parser goes on at the next place that looks like the beginning of a command.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import field
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Help
from ltlc.base.fixes import uncertain, writing
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.syntax import build, misspelled
from ltlc.frontend.syntax import tree as syntax
from ltlc.frontend.syntax.lexer import END, TEMPORAL, Token, next_token, skip_blank

MAX_ERRORS = 50
"""After so many syntax errors the rest of a file is not looked at: it is not a specification."""

MAX_DEPTH = 200
"""How deeply a property may be nested; the passes that follow are recursive."""

_COMMAND_KEYWORDS = frozenset(
    {"decl", "model", "object", "zone", "guard", "message", "assume", "forall", "SETTING", "ATTRIBUTES"}
)

_COMMAS = {"after": 1, "until": 1, "after_until": 2, "WITHIN_FIRST": 1}
"""How many commas a keyword has after it."""


@dataclass(frozen=True)
class Automaton:
    """The tables of an LALR(1) parser, as `generate.tables` describes them."""

    rules: list[tuple[str, int, str | None]]
    states: list[dict[str, int]]

    @classmethod
    @cache
    def load(cls) -> Automaton:
        """The automaton of the language, read once."""
        data = json.loads((Path(__file__).parent / "tables.json").read_bytes())
        return cls([tuple(rule) for rule in data["rules"]], data["states"])


@dataclass
class Stack:
    """What the parser has read of the current command: states, and the part and the span that led to each."""

    states: list[int] = field(default_factory=lambda: [0])
    parts: list[Any] = field(default_factory=list)
    spans: list[Span] = field(default_factory=list)

    def push(self, state: int, part: Any, span: Span) -> None:
        """Go to `state` with `part`."""
        self.states.append(state)
        self.parts.append(part)
        self.spans.append(span)

    def pop(self, length: int) -> list[Any]:
        """Take the last `length` parts off."""
        if not length:
            return []
        parts = self.parts[-length:]
        del self.states[-length:], self.parts[-length:], self.spans[-length:]
        return parts


def parse(source: Source) -> tuple[syntax.SyntaxTree, list[Diagnostic]]:
    """The commands of `source` that can be parsed, and what is wrong with the others."""
    tree, _, diagnostics = parse_with_tokens(source)
    return tree, diagnostics


def parse_with_tokens(source: Source) -> tuple[syntax.SyntaxTree, list[Token], list[Diagnostic]]:
    """As `parse`, with the tokens that were taken: without diagnostics, those of the commands, one after the other."""
    parser = _Parser(source, Automaton.load())
    tree, diagnostics = parser.run()
    return tree, parser.taken, diagnostics


@dataclass(frozen=True, slots=True)
class Expectation:
    """What can stand at a place: terminals, and the tokens before it of the command there, which begins at `start`.

    Tokens that a completed part has taken up are omitted.
    """

    terminals: frozenset[str]
    tokens: tuple[Token, ...]
    start: int


def expected_after(text: str) -> Expectation:
    """What can stand at the end of `text`, of which only the last command counts; nothing within a string."""
    parser = _Foreseeing(Source("", text + _NOTHING), Automaton.load())
    parser.run()
    return parser.expectation


class _Parser:
    """One parse of one text; the state of the automaton is its only memory."""

    def __init__(self, source: Source, automaton: Automaton, text: str | None = None) -> None:
        """Parse `text`, which is that of `source`, some of it blank."""
        self.source = source
        self.text = misspelled.joined(source.text) if text is None else text
        self.automaton = automaton
        self.stack = Stack()
        self.diagnostics: list[Diagnostic] = misspelled.split_words(source)
        self.lost: list[str] = []
        self.taken: list[Token] = []
        self.previous: Token | None = None

    def run(self) -> tuple[syntax.SyntaxTree, list[Diagnostic]]:
        """Take token after token; the bottom of the stack are the commands that are complete."""
        self._reduce_before(END)
        offset = 0
        while True:
            token = self._token(offset)
            if not self._reduce_before(token.terminal):
                end = self._answer(token)
                if end is not None:
                    offset = end
                    continue
                self._report(token)
                if token.terminal == END or len(self.diagnostics) >= MAX_ERRORS:
                    self.lost.append(self.text[self.stack.spans[-1].end :])
                    break
                offset = self._resynchronise(token)
                continue
            if token.terminal == END:
                break
            self._shift(token)
            offset = token.span.end
        return self._tree(), self.diagnostics

    def _token(self, offset: int) -> Token:
        """The token at `offset`; one that is written wrongly but can be understood is reported and taken."""
        token = next_token(self.text, offset, self.automaton.states[self.stack.states[-1]])
        if token.problem and token.terminal != "?":
            self.diagnostics.append(misspelled.token_problem(self.source, token))
        return token._replace(terminal="WITHIN_FIRST") if token.terminal == "within" and self._begins(token) else token

    def _begins(self, within: Token) -> bool:
        """Whether `within` begins a property, in which a comma follows its time; else it begins a bound."""
        if "within" not in self.automaton.states[self.stack.states[-1]]:
            return True
        depth, missing = 0, 0
        for terminal in (token.terminal for token in self._tokens()):
            depth += (terminal in ("(", "{")) - (terminal in (")", "}"))
            if depth == 0:
                missing += _COMMAS.get(terminal, 0) - (terminal == ",")
        duration = next_token(self.text, within.span.end, ())
        closing = self.text.find("]", duration.span.end) if duration.text == "[" else -1
        comma = next_token(self.text, closing + 1 or duration.span.end, ()).terminal == ","
        return comma and depth == missing == 0

    def _reduce_before(self, terminal: str) -> bool:
        """Complete the rules that end before `terminal`; whether it can then be taken."""
        while True:
            action = self.automaton.states[self.stack.states[-1]].get(terminal)
            if action is None:
                return False
            if action >= 0:
                return True
            rule = -1 - action
            if self.automaton.rules[rule][0] == "start":
                return True
            self._reduce(rule)

    def _shift(self, token: Token) -> None:
        self.stack.push(self.automaton.states[self.stack.states[-1]][token.terminal], token, token.span)
        self.taken.append(token)
        self.previous = token

    def _reduce(self, rule: int) -> None:
        """Replace the parts of `rule` on the stack by what its function makes of them."""
        symbol, length, function = self.automaton.rules[rule]
        spans = self.stack.spans[-length:] if length else []
        span = spans[0].to(spans[-1]) if spans else Span(0, 0)
        parts = self.stack.pop(length)
        part = getattr(build, function)(span, *parts) if function else parts[0]
        self.stack.push(self.automaton.states[self.stack.states[-1]][symbol], part, span)

    def _answer(self, token: Token) -> int | None:
        """Say how the line of `token`, or of the token before, is written, if it is in the words of others; its end."""
        if len(self.diagnostics) >= MAX_ERRORS:
            return None
        places = [token.span.start] if token.terminal != END else []
        for place in [*places, *([self.previous.span.start] if self.previous else [])]:
            line = _line_at(self.text, place)
            found = self._foreign(line)
            if found is None:
                continue
            commands: list[syntax.Command] = self.stack.parts[0]
            self.stack.parts[0] = [command for command in commands if command.span.start < line.start]
            self.stack.pop(len(self.stack.parts) - 1)
            self.previous = None
            self._tell(line, found)
            return line.end
        return None

    def _tell(self, line: Span, found: Diagnostic) -> None:
        """Report what is `found` of a whole line instead of what was found in it."""
        kept = [d for d in self.diagnostics if d.primary is None or not line.start <= d.primary.span.start <= line.end]
        self.diagnostics = [*kept, found]
        self.lost.append(self.text[line.start : line.end])

    def _report(self, token: Token) -> None:
        """Say what is wrong at `token`, in the state that the automaton reaches without looking ahead."""
        if token.problem and token.terminal == "?":
            self.diagnostics.append(misspelled.token_problem(self.source, token))
        elif token.problem:
            self.diagnostics[-1] = uncertain(self.diagnostics[-1])  # what is probably meant cannot stand here
        if token.problem:
            return
        from ltlc.frontend.syntax import mistakes  # here, and below, what a text without mistakes does not need

        read = self._tokens()
        self._settle()
        situation = mistakes.Situation(
            self.source,
            token,
            self.previous,
            {symbol for symbol, action in self.automaton.states[self.stack.states[-1]].items() if action >= 0},
            read,
            self._tokens(),
        )
        self.diagnostics.append(mistakes.explain(situation))

    def _tokens(self) -> tuple[Token, ...]:
        """The tokens of the current command that no completed part has taken up."""
        return tuple(part for part in self.stack.parts if isinstance(part, Token))

    def _settle(self) -> None:
        """Complete what can be completed in one way only, whatever follows: `after x y` is wrong after the event."""
        while True:
            rules = {-1 - action for action in self.automaton.states[self.stack.states[-1]].values() if action < 0}
            if len(rules) != 1:
                return
            rule = rules.pop()
            if self.automaton.rules[rule][0] in ("start", "commands", "command"):
                return
            self._reduce(rule)

    def _resynchronise(self, token: Token) -> int:
        """Give up the current command; the offset at which the next one seems to begin."""
        start = self.stack.spans[1].start if len(self.stack.spans) > 1 else token.span.start
        self.stack.pop(len(self.stack.parts) - 1)
        if self.previous is None or not self._begins_command(token):
            token = next_token(self.text, token.span.end, ())
        while token.terminal != END and not self._begins_command(token):
            token = next_token(self.text, token.span.end, ())
        self.previous = None
        self.lost.append(self.text[start : token.span.start])
        return token.span.start

    def _begins_command(self, token: Token) -> bool:
        """Whether a command may begin at `token`: by a keyword, a label, an association, or a keyword on a new line."""
        if token.terminal in _COMMAND_KEYWORDS:
            return True
        if token.terminal == "NAME":
            after = skip_blank(self.text, token.span.end)
            return self.text.startswith((":", "="), after) and not self.text.startswith("==", after)
        line_start = self.text.rfind("\n", 0, token.span.start) + 1
        return token.terminal in TEMPORAL and not self.text[line_start : token.span.start].strip()

    def _tree(self) -> syntax.SyntaxTree:
        """The commands that are complete and not nested too deeply for the passes that follow."""
        commands = self._understood(self.stack.parts[0])
        shallow: list[syntax.Command] = []
        for command in commands:
            too_deep = next((node for node, depth in syntax.walk(command) if depth > MAX_DEPTH), None)
            if too_deep is None:
                shallow.append(command)
            else:
                from ltlc.frontend.syntax import mistakes

                self.diagnostics.append(mistakes.too_deep(self.source, too_deep.span, MAX_DEPTH))
                self.lost.append(self.text[command.span.start : command.span.end])
        return syntax.SyntaxTree(tuple(shallow), "\n".join(self.lost) if self.lost else None)

    def _foreign(self, line: Span) -> Diagnostic | None:
        """How a line is written that is in the words of others, if it is one."""
        from ltlc.frontend.syntax import phrases

        written = self.source.text[line.start : line.end]
        found = phrases.meant(written, self.text, self._is_command)
        if found is None:
            return None
        message = f"`{written}` is not written like this here"
        fix = writing(line, found.text)
        differs = f"; note: {'; '.join(found.differs)}" if found.differs else ""
        return diagnostic("LTL021", self.source, line, message, help=Help(f"{fix.title}{differs}", (fix,)))

    def _is_command(self, text: str) -> bool:
        """Whether `text` is one command in the words of the language."""
        tree, diagnostics = _Trying(Source("", text), self.automaton).run()
        return not diagnostics and len(tree.commands) == 1

    def _understood(self, commands: list[syntax.Command]) -> list[syntax.Command]:
        """`commands` without those on lines in another language's words that happen to parse; these are reported.

        Their properties run on, or divide by a topic.
        """
        lines = {
            _line_at(self.text, second.span.start)
            for first, second in pairwise(commands)
            if syntax.runs_on(self.text, first, second)
        }
        divisions = (c for c in commands if misspelled.UNFINISHED.search(self.text, c.span.start, c.span.end))
        lines |= {_line_at(self.text, command.span.start) for command in divisions}
        lines |= {_line_at(self.text, match.end()) for match in _BEGINS_WITH_TOPIC.finditer(self.text)}
        foreigners = {line: found for line in lines if (found := self._foreign(line))}
        if any(c.span.start < line.start < c.span.end for c in commands for line in foreigners):
            return self._without(foreigners)
        for line, found in foreigners.items():
            self._tell(line, found)
        return [c for c in commands if not any(line.start <= c.span.start <= line.end for line in foreigners)]

    def _without(self, foreigners: Mapping[Span, Diagnostic]) -> list[syntax.Command]:
        """The commands of the text without lines of which one was taken for the rest of a command before it."""
        text = self.text
        for line in foreigners:
            text = text[: line.start] + " " * (line.end - line.start) + text[line.end :]
        parser = _Parser(self.source, self.automaton, text)
        tree, diagnostics = parser.run()
        self.taken, self.diagnostics = parser.taken, [*diagnostics, *foreigners.values()]
        self.lost = [*parser.lost, *(self.text[line.start : line.end] for line in foreigners)]
        return list(tree.commands)


_BEGINS_WITH_TOPIC = re.compile(r"^[ \t]*(?=/\w)", re.MULTILINE)
"""The beginning of a line that would be taken for the rest of a division."""


def _line_at(text: str, place: int) -> Span:
    """The line at `place`, without blanks before it and without a comment."""
    start, end = text.rfind("\n", 0, place) + 1, text.find("\n", place)
    line = text[start : len(text) if end < 0 else end].partition("#")[0]
    return Span(start + len(line) - len(line.lstrip()), start + len(line.rstrip()))


_NOTHING = "\0"
"""A character that no token begins with, which the parser stops at before it completes anything."""


class _Trying(_Parser):
    """A parse of a text that is not looked at for the words of others."""

    def _answer(self, token: Token) -> int | None:
        return None

    def _understood(self, commands: list[syntax.Command]) -> list[syntax.Command]:
        return commands


class _Foreseeing(_Trying):
    """A parse of a text with `_NOTHING` at its end, which notes what could stand there."""

    expectation = Expectation(frozenset(), (), 0)

    def _report(self, token: Token) -> None:
        if token.span.end == len(self.text):
            terminals = frozenset(self.automaton.states[self.stack.states[-1]])
            start = self.stack.spans[1].start if len(self.stack.spans) > 1 else token.span.start
            self.expectation = Expectation(terminals, self._tokens(), start)
        super()._report(token)
