"""What is written wrongly in a word or two, and can be understood all the same, or cannot be a part of the language."""

from __future__ import annotations

import re

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Help
from ltlc.base.fixes import write, writing
from ltlc.base.source import Source, Span
from ltlc.frontend.syntax.lexer import FOREIGN_PREFIXES, QUANTITIES, Token

_SPLIT = re.compile(
    r"(?:(?<=\.)(?:localization|velocity|orientation)[ \t]+error|(?<=\.)velocity[ \t]+angular"
    r"|(?<=\.)orientation[ \t]+between|\bafter[ \t]+until)\b"
)

UNFINISHED = re.compile(r"\b(?:no|some|new)\s*/")
"""What HPL has in front of a topic, and would be a division."""

_NEXT = "`@{p, -1}` is the previous sample, as in `always (@{p, -1} implies q)`; if you meant a name, choose another"

_LOOSE = frozenset({"<->", "<=>", "↔", "⇔", "<>", "iff", "xor"})
"""Relations of predicates that in other languages bind less than `==` and `!=` do here, and what may be one."""


def token_problem(source: Source, token: Token) -> Diagnostic:
    """What is wrong with a token that is understood, or with a character that cannot be."""
    written = source.text[token.span.start : token.span.end]
    match token.problem:
        case "LTL004":
            message = f"`{written}` is written `{token.advice}` here"
            return diagnostic("LTL004", source, token.span, message, help=_foreign(source.text, token))
        case "LTL020":
            unit, factor = QUANTITIES[token.advice]
            message = f"`{written}` has a unit, but only durations and angles (`deg`, `rad`) have units"
            fix = writing(token.span, f"{float(token.text) * factor:.6g}")
            help = Help(f"{fix.title} ({unit}): values are in the units of their messages", (fix,))
            return diagnostic("LTL020", source, token.span, message, help=help)
        case "LTL841":
            message = f"`{written}` has a unit, but a mined value brings its own"
            help = write(writing(token.span, "?", is_certain=True))
            return diagnostic("LTL841", source, token.span, message, help=help)
        case "LTL009":
            message = f"`{written}` is reserved for a later version of the language"
            return diagnostic("LTL009", source, token.span, message, help=_NEXT)
        case "LTL012" if token.advice == "close":
            message = "the string does not end on its line"
            return diagnostic(
                "LTL012", source, token.span, message, help='close it with `"`; a line break is written `\\n`'
            )
        case "LTL012":
            message = f"`{token.advice}` is not an escape"
            return diagnostic("LTL012", source, token.span, message, help='the escapes are `\\n \\t \\" \\\\`')
        case "LTL014":
            message = f"`{written}` is not a number"
            if not token.advice:
                return diagnostic(
                    "LTL014", source, token.span, message, help="numbers are written `2`, `0.05` or `1e-3`"
                )
            better = writing(token.span, token.advice, is_certain=True)
            return diagnostic("LTL014", source, token.span, message, help=write(better))
        case _:
            return _strange(source, token, written)


def _foreign(text: str, token: Token) -> str | Help:
    """How what is written as in other languages is written here.

    That is certain if it means the same there: prefixes such as `G` reach less far, and some relations of predicates
    bind less than ours. Of a word that the text gives a meaning, as in `Within = 2`, it is not.
    """
    written = text[token.span.start : token.span.end]
    if written in _LOOSE:
        return f"write `{token.advice}`, with parentheses around what it compares: `(p) {token.advice} (q)`"
    is_string = token.terminal == "STRING"
    if is_string and any(character in token.text for character in '"\\'):
        return f"write `{token.advice}`"
    is_certain = written not in FOREIGN_PREFIXES and not _is_defined(text, written)
    return write(writing(token.span, _apart(text, token.span, token.advice), is_certain=is_certain))


def _is_defined(text: str, written: str) -> bool:
    """Whether `text` uses what is written as a name or a label."""
    return written.isalpha() and re.search(rf"\b{written}[ \t]*(?::|=(?!=))", text) is not None


def _apart(text: str, span: Span, word: str) -> str:
    """`word` with blanks where in place of `span` it would touch what is not a bracket or a comma."""
    left = word[0].isalpha() and re.match(r"[^\s(,]", text[max(0, span.start - 1) : span.start])
    right = word[-1].isalpha() and re.compile(r"[^\s(),]").match(text, span.end)
    return f"{' ' if left else ''}{word}{' ' if right else ''}"


def _strange(source: Source, token: Token, written: str) -> Diagnostic:
    if token.terminal == "NAME":
        help = "a name consists of the letters a to z and A to Z, digits and `_`"
        return diagnostic(
            "LTL011", source, token.span, f"`{written}` contains a letter that is not allowed in names", help=help
        )
    shown = f"`{written}`" if written.isprintable() or len(written) > 1 else f"the character U+{ord(written):04X}"
    return diagnostic("LTL011", source, token.span, f"{shown} is not a valid character here")


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
        help = write(writing(Span(*match.span()), word, is_certain=True))
        found.append(diagnostic("LTL010", source, Span(*match.span()), message, help=help))
    return found
