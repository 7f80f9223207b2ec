"""What is wrong where the parser cannot go on, said as a person would: the usual mistakes, a function for each."""

from __future__ import annotations

import re
from collections.abc import Callable, Set
from dataclasses import dataclass

from ltlc.codes import diagnostic
from ltlc.diagnostics import Diagnostic, Label
from ltlc.source import Source, Span
from ltlc.syntax.lexer import END, KEYWORDS, Token

FORMS = {
    "always": "always PROPERTY",
    "never": "never PROPERTY",
    "eventually": "eventually PROPERTY",
    "after": "after EVENT, PROPERTY",
    "until": "until EVENT, PROPERTY",
    "after_until": "after_until EVENT, EVENT, PROPERTY",
    "decl": "decl NAME TOPIC TYPE.FIELD",
    "model": "model NAME: ATTRIBUTE TOPIC TYPE.FIELD ;",
    "object": "object NAME TOPIC TYPE` or `object NAME at (x, y, z)",
    "@": "@{SIGNAL, -SAMPLES}",
}
"""How the constructions are written that begin with a keyword."""

_RELATIONS = frozenset({"==", "!=", "<", "<=", ">", ">="})
_CLOSING = {"(": ")", "{": "}", "[": "]"}
_VALUE_ENDS = frozenset({"NAME", "NUMBER", "STRING", "true", "false", ")", "}", "]"})
_SPLIT = re.compile(
    r"(?:(?<=\.)(?:localization|velocity|orientation)[ \t]+error|(?<=\.)velocity[ \t]+angular"
    r"|(?<=\.)orientation[ \t]+between|\bafter[ \t]+until)\b"
)


@dataclass(frozen=True, slots=True)
class Situation:
    """Where the parser stands: `token` does not fit, `previous` did, `expected` would.

    `read` are the tokens of the current command that no part has taken up that was complete before `token`; `waiting`
    those that are left when all is completed that can be, such as open parentheses.
    """

    source: Source
    token: Token
    previous: Token | None
    expected: Set[str]
    read: tuple[Token, ...]
    waiting: tuple[Token, ...]

    @property
    def begins_value(self) -> bool:
        """Whether a value may stand here."""
        return "NUMBER" in self.expected

    @property
    def found(self) -> str:
        """What stands here, in words."""
        if self.token.terminal == END:
            return "the end of the file"
        return f"`{self.source.text[self.token.span.start : self.token.span.end]}`"

    @property
    def place(self) -> Span:
        """The token; at the end of the file the last character of the text before it."""
        if self.token.terminal == END and self.previous is not None:
            return Span(self.previous.span.end - 1, self.previous.span.end)
        return self.token.span

    def report(self, code: str, message: str, *secondary: Label, label: str = "", help: str = "") -> Diagnostic:
        """A diagnostic about the token."""
        return diagnostic(code, self.source, self.place, message, label=label, secondary=secondary, help=help)


def explain(situation: Situation) -> Diagnostic:
    """The mistake at the token of `situation`."""
    for mistake in _MISTAKES:
        found = mistake(situation)
        if found is not None:
            return found
    expected = expectation(situation.expected)
    message = f"{situation.found} cannot stand here"
    if situation.expected:
        return situation.report("LTL001", message, label=f"here {expected} can stand")
    return situation.report("LTL001", message, label="the property ends before this")


def _single_equals(at: Situation) -> Diagnostic | None:
    if at.token.terminal != "=" or at.previous is None or at.previous.terminal not in _VALUE_ENDS:
        return None
    return at.report("LTL003", "`=` names things; values are compared with `==`", help="write `==`")


def _keyword_as_name(at: Situation) -> Diagnostic | None:
    wants_name = "NAME" in at.expected and not at.begins_value
    if not wants_name or at.token.terminal not in KEYWORDS or ";" in at.expected:
        return None
    return at.report(
        "LTL008", f"{at.found} is a keyword and cannot be a name", help=f"`my_{at.token.text}` could be one"
    )


def _chained_comparison(at: Situation) -> Diagnostic | None:
    if at.token.terminal not in _RELATIONS or not at.read or at.read[-1].terminal not in _RELATIONS:
        return None
    first = Label(at.read[-1].span, "the comparison is complete here")
    help = "compare twice: `a < b and b < c`"
    return at.report("LTL013", f"comparisons do not chain: {at.found} follows a comparison", first, help=help)


def _missing_value(at: Situation) -> Diagnostic | None:
    if not at.begins_value or at.previous is None or "decl" in at.expected:
        return None
    before = f"`{at.source.text[at.previous.span.start : at.previous.span.end]}`"
    form = _form(at)
    what = "a property" if at.previous.terminal in FORMS or "always" in at.expected else "a value"
    message = f"after {before} {what} has to follow, not {at.found}"
    if at.token.terminal == END:
        message = f"{what} has to follow {before}, but the file ends"
    return at.report("LTL006", message, help=f"the form is `{form}`" if form else "")


def _missing_comma(at: Situation) -> Diagnostic | None:
    opener = _open_keyword(at)
    if "," not in at.expected or opener is None:
        return None
    form, label = FORMS[opener.terminal], Label(opener.span, "this needs it")
    if at.token.terminal == END or at.token.terminal in ("decl", "model", "object", "SETTING", ")", ":", "="):
        message = f"`{opener.text}` lacks an argument before {at.found}"
        return at.report("LTL006", message, label, help=f"the form is `{form}`")
    message = f"a comma is missing before {at.found}: the arguments of `{opener.text}` stand apart"
    return at.report("LTL002", message, label, label="expected `,` before this", help=f"the form is `{form}`")


def _unclosed(at: Situation) -> Diagnostic | None:
    opener = next((t for t in reversed(at.waiting) if t.terminal in _CLOSING), None)
    if opener is None or _CLOSING[opener.terminal] not in at.expected:
        return None
    closing = _CLOSING[opener.terminal]
    message = f"`{opener.terminal}` is not closed before {at.found}"
    help = f"a `{closing}` or a `,` is missing" if "," in at.expected else f"a `{closing}` is missing"
    return at.report("LTL005", message, Label(opener.span, "opened here"), help=help)


def _missing_semicolon(at: Situation) -> Diagnostic | None:
    if ";" not in at.expected:
        return None
    model = next(t for t in at.waiting if t.terminal == "model")
    message = f"the model has to end with `;` before {at.found}"
    return at.report(
        "LTL007", message, Label(model.span, "the model begins here"), help="write `;` after its last attribute"
    )


def _incomplete_command(at: Situation) -> Diagnostic | None:
    opener = next((t for t in at.waiting if t.terminal in ("decl", "model", "object", "SETTING")), None)
    if opener is None or (at.begins_value and opener.terminal != "object"):
        return None
    form = FORMS.get(opener.terminal, f"{opener.text} = VALUE")
    needed = "a coordinate" if at.begins_value else expectation(at.expected - {"+", "-"})
    message = f"{needed} has to stand here, not {at.found}"
    if at.token.terminal == END:
        message = f"{needed} has to follow, but the file ends"
    return at.report("LTL006", message, Label(opener.span), help=f"the form is `{form}`")


def _stray_closing(at: Situation) -> Diagnostic | None:
    opening = {v: k for k, v in _CLOSING.items()}.get(at.token.terminal)
    if opening is None:
        return None
    return at.report("LTL001", f"{at.found} closes nothing", help=f"no `{opening}` is open here")


_MISTAKES: tuple[Callable[[Situation], Diagnostic | None], ...] = (
    _single_equals,
    _keyword_as_name,
    _chained_comparison,
    _missing_semicolon,
    _incomplete_command,
    _missing_value,
    _missing_comma,
    _unclosed,
    _stray_closing,
)


def _open_keyword(at: Situation) -> Token | None:
    """The innermost keyword that waits for a comma."""
    openers = ("after", "until", "after_until", "@")
    for token in reversed(at.waiting):
        if token.terminal in openers:
            return token
        if token.terminal == "(":
            return None
    return None


def _form(at: Situation) -> str:
    """The form of the construction that begins with the last token, if it has one."""
    opener = _open_keyword(at)
    if at.previous is not None and at.previous.terminal in FORMS:
        return FORMS[at.previous.terminal]
    return FORMS[opener.terminal] if opener is not None else ""


def expectation(expected: Set[str]) -> str:
    """What can stand at a place, in words."""
    words = []
    if "decl" in expected:
        words.append("a new command")
    if "NUMBER" in expected:
        words.append("a property or a value" if "always" in expected else "a value")
    elif "NAME" in expected and "decl" not in expected:
        words.append("a name")
    names = {
        "TOPIC": "a topic",
        "TYPE": "a message type",
        "==": "a comparison",
        "and": "`and`, `or`",
        "+": "arithmetic",
    }
    words.extend(text for terminal, text in names.items() if terminal in expected)
    words.extend(f"`{t}`" for t in (")", "}", "]", ",", ":", ";", "=", "at") if t in expected)
    return " or ".join(words) if words else "nothing more"


def token_problem(source: Source, token: Token) -> Diagnostic:
    """What is wrong with a token that is understood, or with a character that cannot be."""
    written = source.text[token.span.start : token.span.end]
    match token.problem:
        case "LTL004":
            message = f"`{written}` is written `{token.advice}` here"
            return diagnostic("LTL004", source, token.span, message, help=f"write `{token.advice}`")
        case "LTL009":
            message = f"`{written}` is reserved for a later version of the language"
            return diagnostic("LTL009", source, token.span, message, help="choose another name")
        case "LTL012" if token.advice == "close":
            message = "the string does not end on its line"
            return diagnostic(
                "LTL012", source, token.span, message, help='close it with `"`; a line break is written `\\n`'
            )
        case "LTL012":
            message = f"`{token.advice}` is not an escape"
            return diagnostic("LTL012", source, token.span, message, help='the escapes are `\\n \\t \\" \\\\`')
        case "LTL014":
            help = f"write `{token.advice}`" if token.advice else "numbers look like `2`, `0.05` or `1e-3`"
            return diagnostic("LTL014", source, token.span, f"`{written}` is not a number", help=help)
    return _strange(source, token, written)


def _strange(source: Source, token: Token, written: str) -> Diagnostic:
    if token.terminal == "NAME":
        help = "a name has the letters a to z and A to Z, digits and `_`"
        return diagnostic("LTL011", source, token.span, f"`{written}` has a letter that names cannot have", help=help)
    shown = f"`{written}`" if written.isprintable() or len(written) > 1 else f"the character U+{ord(written):04X}"
    return diagnostic("LTL011", source, token.span, f"{shown} is not a part of the language")


def too_deep(source: Source, span: Span, limit: int) -> Diagnostic:
    """The place from which on a property is nested deeper than `limit`."""
    help = "a property of several simpler ones says more when it fails"
    return diagnostic("LTL015", source, span, f"the property is nested more than {limit} deep", help=help)


def _outside_text(text: str, start: int) -> bool:
    """Whether `start` is in a comment or a string."""
    line = text[text.rfind("\n", 0, start) + 1 : start]
    return "#" in line or line.count('"') % 2 == 1


def _split_words(text: str) -> list[re.Match[str]]:
    return [match for match in _SPLIT.finditer(text) if not _outside_text(text, match.start())]


def joined(text: str) -> str:
    """`text` with words that are written in two joined; every other character keeps its place."""
    for match in _split_words(text):
        word = "_".join(match.group().split())
        text = text[: match.start()] + word.ljust(len(match.group())) + text[match.end() :]
    return text


def split_words(source: Source) -> list[Diagnostic]:
    """The words of the language that are written in two."""
    found = []
    for match in _split_words(source.text):
        word = "_".join(match.group().split())
        message = f"`{word}` is one word, with an underscore"
        found.append(diagnostic("LTL010", source, Span(*match.span()), message, help=f"write `{word}`"))
    return found
