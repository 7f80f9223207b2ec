"""From characters to tokens: what stands at a place of the text, given what the grammar can take there.

Topics and types are tokens only where the grammar expects them, so that `/odom` is not confused with a division.
"""

from __future__ import annotations

import math
import re
from collections.abc import Container
from typing import NamedTuple

from ltlc.base.source import Span
from ltlc.semantics.durations import UNITS
from ltlc.specification.functions import WRITTEN

_ANYTHING = re.compile("")

KEYWORDS = frozenset(
    [
        "decl",
        "model",
        "object",
        "at",
        "always",
        "never",
        "eventually",
        "after",
        "until",
        "after_until",
        "implies",
        "or",
        "and",
        "not",
        "once",
        "historically",
        "previously",
        "since",
        "within",
        "for",
        "forall",
        "in",
        "true",
        "false",
    ]
)
"""The words that are terminals of the grammar and cannot be names."""

PREFIXES = frozenset(["new", "gone", "initially", "when"])
"""The words that are terminals of the grammar where something follows that they can stand before, and else names."""

HEADS = {
    "each": re.compile(r"[ \t]+([^\W\d]\w*[ \t]+of\b|new[ \t]+[^\W\d])"),
    "of": _ANYTHING,
    "limit": _ANYTHING,
    "guard": re.compile(r"[ \t]+[~/{\w][^\s#;,=()]*[ \t]+to[ \t]+[~/{\w]"),
    "to": _ANYTHING,
    "message": re.compile(r"[ \t]+[^\W\d]\w*[ \t]*\{"),
    "assume": re.compile(r"[ \t]+(?!(?:and|or|implies|since|within|for|in)\b)[\"@({\w]"),
    "else": _ANYTHING,
    "over": re.compile(r"\s*\("),
    "rate": re.compile(r"[ \t]*\([^()\n]*\)[ \t]*(?:[<>]=?|[=!]=)[ \t]*[\d.]+(?:[eE][+-]?\d+)?[ \t]*Hz\b"),
}
"""The words that are terminals where the grammar takes them and this follows, and else names."""

FARTHEST = 80
"""The blanks at most between the words of the head of an `each new`."""

CONTEXTUAL = PREFIXES | {"zone", *HEADS}
"""The words that are terminals of the grammar only where their form needs them."""

TEMPORAL = frozenset({"always", "never", "eventually", "after", "until", "after_until", "initially"})
"""The keywords that begin a temporal property."""

PAST = frozenset({"once", "historically", "previously", "since"})
"""The keywords that look back."""

RESERVED = frozenset(["next"])
"""The words that are kept for later versions of the language."""

FUNCTIONS = (*WRITTEN, "norm", "age")
"""What can be called."""

QUANTIFIERS = ("any", "all", "count")
"""Quantifiers over the elements of arrays."""

FOREIGN = {
    "&&": "and",
    "&": "and",
    "∧": "and",
    "/\\": "and",
    "||": "or",
    "|": "or",
    "∨": "or",
    "\\/": "or",
    "!": "not",
    "¬": "not",
    "->": "implies",
    "=>": "implies",
    "→": "implies",
    "⇒": "implies",
    "<->": "==",
    "<=>": "==",
    "↔": "==",
    "⇔": "==",
    "===": "==",
    "≠": "!=",
    "<>": "!=",
    "≤": "<=",
    "=<": "<=",
    "≥": ">=",
    "−": "-",
    "×": "*",
    "·": "*",
    "÷": "/",
}
"""Operators of other languages and of mathematics, and how they are written here."""

FOREIGN_WORDS = {"iff": "==", "xor": "!="}
"""Words that other languages have for relations of predicates."""

FOREIGN_PREFIXES = {
    "F": "eventually",
    "G": "always",
    "H": "historically",
    "O": "once",
    "P": "once",
    "eventually_": "eventually",
    "always_": "always",
    "finally": "eventually",
    "globally": "always",
}
"""What the temporal operators of other languages are called here that stand before what they judge."""

QUANTITIES = {
    "m/s": ("m/s", 1.0),
    "m/s^2": ("m/s²", 1.0),
    "m": ("m", 1.0),
    "meters": ("m", 1.0),
    "cm": ("m", 0.01),
    "mm": ("m", 0.001),
    "km": ("m", 1000.0),
    "km/h": ("m/s", 1 / 3.6),
    "mm/s": ("m/s", 0.001),
    "cm/s": ("m/s", 0.01),
    "rad": ("rad", 1.0),
    "rad/s": ("rad/s", 1.0),
    "deg": ("rad", math.pi / 180),
    "degrees": ("rad", math.pi / 180),
    "°": ("rad", math.pi / 180),
    "deg/s": ("rad/s", math.pi / 180),
    "°/s": ("rad/s", math.pi / 180),
    "Hz": ("Hz", 1.0),
    "kg": ("kg", 1.0),
    "N": ("N", 1.0),
    "V": ("V", 1.0),
    "A": ("A", 1.0),
    "%": ("as a fraction", 0.01),
}
"""Units that a number may be given, with that of ROS (REP 103) and how many of it make one of them."""

FOREIGN_UNITS = {
    "nsec": "ns",
    "nanoseconds": "ns",
    "µs": "us",
    "usec": "us",
    "microseconds": "us",
    "msec": "ms",
    "millis": "ms",
    "milliseconds": "ms",
    "sec": "s",
    "secs": "s",
    "second": "s",
    "seconds": "s",
    "mins": "min",
    "minute": "min",
    "minutes": "min",
    "hour": "h",
    "hours": "h",
}
"""Other names of the units of durations."""

_FOREIGN_WORDS = KEYWORDS - {"decl", "model", "object", "at", "in"}
_QUOTES = {"'": "'", "“": "”", "”": "”", "„": "“", "‘": "’", "’": "’"}

SYMBOLS = ("**", "==", "!=", "<=", ">=", *"<>=(){}[],;:.@+-*/")

_ATTRIBUTES = re.compile(r"\[\s*[^\W\d]")
_BLANK = re.compile(r"(?:\s+|#[^\n]*)*")
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:[eE][+-]?\d+)?", re.ASCII)
_NUMBER_LIKE = re.compile(r"(?:\d|(?<![\w)\]}])\.\d)(?:[eE][+-]\d|[\w.])*")
_UNIT = re.compile(rf"[ \t]*({'|'.join([*UNITS, *FOREIGN_UNITS])})\b(?![ \t]*(?:[(:]|=(?!=)))")
_EACH_BEFORE = re.compile(r"\beach(?=[ \t]+$)")
_OPERAND = re.compile(
    r'["@({\d]|(?!(?:and|or|implies|since|within|for|in)\b)[^\W\d][\w./]*(?![\w./])(?!\s*(?::|=(?!=)))'
)
_QUANTITY = re.compile(
    rf"[ \t]*({'|'.join(sorted(map(re.escape, QUANTITIES), key=len, reverse=True))})(?![\w./])(?![ \t]*(?:[(:]|=(?!=)))"
)
_TIMES = re.compile(r"(\d[\w.]*)[ \t]+times\b(?![ \t]*(?:[(:]|=(?!=)))", re.ASCII)
_HERTZ = re.compile(r"(\d[\w.+-]*?)[ \t]*Hz[ \t]+over\b")
_ANGLE = re.compile(r"[ \t]*(deg|rad)(?![\w./])(?![ \t]*(?:[(:]|=(?!=)))")
_MESSAGE = re.compile(
    r"[A-Za-z]\w*/(?:msg|srv|action)/[A-Za-z]\w*|[a-z]\w*/[A-Z]\w*(?=\.[A-Z][A-Z0-9_]*(?![\w.]))", re.ASCII
)
_WORD = re.compile(r"[^\W\d]\w*")
_TEMPLATE = re.compile(r"(?:[A-Za-z]\w*)?(?:\{[A-Za-z]\w*\}\w*)+", re.ASCII)
_STRING = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
_TOPIC = re.compile(r"[~/{\w][^\s#;,=()]*")
_TYPE = re.compile(r"\w[\w/]*(?:\.\w*|\[[^\]\s]*\]?)*")
_ZONE = re.compile(r"[ \t]+[^\W\d]\w*[ \t]*=[ \t]*\[")
_SYMBOL = re.compile("|".join(re.escape(s) for s in sorted([*FOREIGN, *SYMBOLS], key=len, reverse=True)))
_ESCAPES = {"n": "\n", "t": "\t", '"': '"', "\\": "\\"}
_BAD_ESCAPE = re.compile(r"\\([^nt\"\\])")

END = "$END"


class Token(NamedTuple):
    """A terminal of the grammar at a place.

    `text` is as written, for a string its value. `problem` is the code of what is wrong with it, if something is, and
    `advice` how it should be written; the terminal is then what was probably meant, or `?` if that cannot be told.
    """

    terminal: str
    span: Span
    text: str
    problem: str = ""
    advice: str = ""


def next_token(text: str, offset: int, acceptable: Container[str]) -> Token:
    """The token at `offset` or after the white space and comments there; at the end of the text, `END`.

    `acceptable` are the terminals that the grammar can take; it matters for topics and types only.
    """
    start = skip_blank(text, offset)
    if start == len(text):
        return Token(END, Span(start, start), "")
    if "TOPIC" in acceptable and (topic := _topic(text, start, acceptable)):
        return topic
    if "TYPE" in acceptable and (match := _TYPE.match(text, start)) and match.group() not in KEYWORDS:
        return Token("TYPE", Span(start, match.end()), match.group())
    if "TEMPLATE" in acceptable and (template := _template(text, start)):
        return template
    return (
        _parameter(text, start)
        or _counted(text, start, acceptable)
        or _number(text, start)
        or _word(text, start, acceptable)
        or _string(text, start)
        or _attributes(text, start, acceptable)
        or _symbol(text, start)
    )


def skip_blank(text: str, offset: int) -> int:
    """The first place from `offset` on that is neither white space nor a comment."""
    match = _BLANK.match(text, offset)
    return match.end() if match else offset


def _topic(text: str, start: int, acceptable: Container[str]) -> Token | None:
    """A topic, if no keyword; where a value could stand too, after `_simulator_ =`, it begins with a slash or tilde."""
    match = _TOPIC.match(text, start)
    if match is None or ("NUMBER" in acceptable and text[start] not in "/~"):
        return None
    if match.group() in KEYWORDS:
        return None
    return Token("TOPIC", Span(start, match.end()), match.group())


def _parameter(text: str, start: int) -> Token | None:
    if text[start] != "?":
        return None
    unit = _UNIT.match(text, start + 1) or _QUANTITY.match(text, start + 1)
    if unit:
        return Token("PARAMETER", Span(start, unit.end()), "?", "LTL841")
    return Token("PARAMETER", Span(start, start + 1), "?")


def _counted(text: str, start: int, acceptable: Container[str]) -> Token | None:
    """A number with the word that follows it in a count, `3 times`, or in a rate, `10 Hz over`."""
    for terminal, form in (("TIMES", _TIMES), ("HERTZ", _HERTZ)):
        if terminal in acceptable and (match := form.match(text, start)):
            return Token(terminal, Span(*match.span()), match.group(1))
    return None


def _number(text: str, start: int) -> Token | None:
    like = _NUMBER_LIKE.match(text, start)
    if like is None:
        return None
    number = _NUMBER.match(text, start)
    unit = number and _UNIT.match(text, number.end())
    if number and unit:
        return _duration(number.group(), unit.group(1), Span(start, unit.end()))
    if number and (angle := _ANGLE.match(text, number.end())):
        return Token("NUMBER", Span(start, angle.end()), _in_radians(number.group(), angle.group(1)))
    if number and (quantity := _QUANTITY.match(text, number.end())):
        return Token("NUMBER", Span(start, quantity.end()), number.group(), "LTL020", quantity.group(1))
    if number is not None and number.end() == like.end():
        return Token("NUMBER", Span(start, number.end()), number.group())
    return Token("NUMBER", Span(start, like.end()), "0", "LTL014", _number_advice(like.group()))


def _in_radians(number: str, unit: str) -> str:
    """A number with a unit of angles as one of radians; never an integer, which could be an index."""
    angle = math.radians(float(number)) if unit == "deg" else float(number)
    return repr(angle) if math.isfinite(angle) else number


def _duration(number: str, unit: str, span: Span) -> Token:
    duration = f"{number} {FOREIGN_UNITS.get(unit, unit)}"
    return Token("DURATION", span, duration, *(("LTL004", duration) if unit in FOREIGN_UNITS else ()))


def _number_advice(text: str) -> str:
    """How a number that is written like `text` in other languages is written here, or nothing."""
    candidates = ("0" + text, text + "0", text.rstrip("fFdDlL"), text.replace("_", ""))
    return next((c for c in candidates if _NUMBER.fullmatch(c)), "")


def _template(text: str, start: int) -> Token | None:
    """A name with a variable of `forall` in it, which other letters touch; after a relation, braces hold a margin."""
    match = _TEMPLATE.match(text, start)
    if match is None or match.group().partition("{")[0] in KEYWORDS or text[start - 1 : start] in ("=", "<", ">"):
        return None
    if match.group().count("{") == 1 and match.group().startswith("{") and match.group().endswith("}"):
        return None
    return Token("TEMPLATE", Span(*match.span()), match.group())


def _word(text: str, start: int, acceptable: Container[str]) -> Token | None:
    message = _MESSAGE.match(text, start)
    if message is not None:
        return Token("MESSAGE_TYPE", Span(start, message.end()), message.group())
    match = _WORD.match(text, start)
    if match is None:
        return None
    word, span = match.group(), Span(start, match.end())
    if not word.isascii():
        return Token("NAME", span, word, "LTL011", "")
    if word == "zone" and _ZONE.match(text, span.end):
        return Token("zone", span, word)
    if word in KEYWORDS or (word in PREFIXES and word in acceptable and _is_prefix(text, span)):
        return Token(word, span, word)
    if word in HEADS and word in acceptable and HEADS[word].match(text, span.end):
        return Token(word, span, word)
    if word in FOREIGN_WORDS and FOREIGN_WORDS[word] in acceptable:
        return Token(FOREIGN_WORDS[word], span, word, "LTL004", FOREIGN_WORDS[word])
    if FOREIGN_PREFIXES.get(word) in acceptable and (text.startswith("(", span.end) or _has_operand(text, span.end)):
        return Token(FOREIGN_PREFIXES[word], span, word, "LTL004", FOREIGN_PREFIXES[word])
    if word in RESERVED:
        return Token("NAME", span, word, "LTL009")
    if word.lower() in _FOREIGN_WORDS and (word.isupper() or word.istitle()):
        return Token(word.lower(), span, word, "LTL004", word.lower())
    if word[0] == word[-1] == "_" and len(word) > 2:
        return Token("SETTING", span, word)
    if not _is_called(text, match):
        return Token("NAME", span, word)
    return Token("QUANTIFIER" if word in QUANTIFIERS else "FUNCTION", span, word)


def _is_prefix(text: str, span: Span) -> bool:
    """Whether the word at `span` stands before something; in the head of an `each new`, even before a colon."""
    head = _EACH_BEFORE.search(text, max(0, span.start - FARTHEST), span.start)
    return _has_operand(text, span.end) or (head is not None and HEADS["each"].match(text, head.end()) is not None)


def _has_operand(text: str, end: int) -> bool:
    """Whether something follows on the line that a prefix can stand before, rather than an operator or a command."""
    blank = len(text[end:]) - len(text[end:].lstrip(" \t"))
    return _OPERAND.match(text, end + blank) is not None


def _is_called(text: str, word: re.Match[str]) -> bool:
    """Whether `word` is applied to something: a parenthesis follows on the line, or at once if it is no function."""
    known = word.group() in FUNCTIONS + QUANTIFIERS
    return re.compile(r"[ \t]*\(" if known else r"\(").match(text, word.end()) is not None


def _string(text: str, start: int) -> Token | None:
    if text[start] in _QUOTES:
        return _foreign_string(text, start)
    if text[start] != '"':
        return None
    match = _STRING.match(text, start)
    if match is None:
        end = text.find("\n", start)
        return Token("STRING", Span(start, len(text) if end < 0 else end), "", "LTL012", "close")
    span, content = Span(start, match.end()), match.group(1)
    bad = _BAD_ESCAPE.search(re.sub(r"\\\\", "", content))
    if bad is not None:
        return Token("STRING", span, "", "LTL012", bad.group())
    return Token("STRING", span, re.sub(r"\\(.)", lambda escape: _ESCAPES[escape.group(1)], content))


def _foreign_string(text: str, start: int) -> Token:
    """A string in quotes that are not those of the language."""
    line_end = text.find("\n", start)
    end = text.find(_QUOTES[text[start]], start + 1, len(text) if line_end < 0 else line_end)
    if end < 0:
        return Token("?", Span(start, start + 1), text[start], "LTL011")
    content = text[start + 1 : end]
    return Token("STRING", Span(start, end + 1), content, "LTL004", f'"{content}"')


def _attributes(text: str, start: int, acceptable: Container[str]) -> Token | None:
    """The bracket that begins a line of attributes: where a word follows, or no index and no interval can stand."""
    begins_line = not text[text.rfind("\n", 0, start) + 1 : start].strip()
    begins_interval = "[" in acceptable and "." not in acceptable
    if text[start] != "[" or not begins_line or begins_interval:
        return None
    is_begun = _ATTRIBUTES.match(text, start) or ("ATTRIBUTES" in acceptable and "[" not in acceptable)
    return Token("ATTRIBUTES", Span(start, start + 1), "[") if is_begun else None


def _symbol(text: str, start: int) -> Token:
    match = _SYMBOL.match(text, start)
    if match is None or match.group() == "**":
        end = match.end() if match else start + 1
        return Token("?", Span(start, end), text[start:end], "LTL011")
    symbol, span = match.group(), Span(start, match.end())
    if symbol in FOREIGN:
        before_number = _NUMBER.match(text, skip_blank(text, span.end))
        meant = ">=" if symbol == "=>" and before_number else FOREIGN[symbol]
        return Token(meant, span, symbol, "LTL004", meant)
    return Token(symbol, span, symbol)
