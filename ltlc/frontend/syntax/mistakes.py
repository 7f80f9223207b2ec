"""What is wrong where the parser cannot go on, in plain words: a function for each usual mistake."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence, Set

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Fix, Help, Label
from ltlc.base.fixes import put, write, writing
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.frontend.syntax.lexer import END, KEYWORDS, TEMPORAL, Token, skip_blank

FORMS = {
    "always": "always PROPERTY",
    "never": "never PROPERTY",
    "eventually": "eventually PROPERTY",
    "after": "after EVENT, PROPERTY",
    "until": "until EVENT, PROPERTY",
    "after_until": "after_until EVENT, EVENT, PROPERTY",
    "initially": "initially PREDICATE",
    "WITHIN_FIRST": "within DURATION, PROPERTY",
    "once": "once PREDICATE",
    "historically": "historically PREDICATE",
    "previously": "previously PREDICATE",
    "since": "PREDICATE since PREDICATE",
    "in": "VALUE in {VALUE, VALUE}",
    "decl": "decl NAME TOPIC TYPE.FIELD",
    "model": "model NAME: ATTRIBUTE TOPIC TYPE.FIELD ;",
    "object": "object NAME TOPIC TYPE` or `object NAME at (x, y, z)",
    "zone": "zone NAME = [(x, y), (x, y), (x, y)]",
    "guard": "guard TOPIC to TOPIC else NAME, NAME",
    "message": "message NAME {FIELD.FIELD: VALUE, FIELD: VALUE}",
    "assume": "assume PROPERTY` or `assume LABEL: PROPERTY",
    "forall": "forall NAME in {NAME, NAME}: PROPERTY",
    "each": "each NAME of SIGNAL: PROPERTY` or `each new SIGNAL: PROPERTY",
    "@": "@{SIGNAL, -SAMPLES}",
}
"""How the constructions are written that begin with a keyword."""

_RELATIONS = frozenset({"==", "!=", "<", "<=", ">", ">="})
_UNQUOTED = re.compile(r"\w+(?:[-.:/]\w+)+")
_PLAIN_WORD = re.compile(r"[\w.]+")
_BLANKS = re.compile(r"[ \t]*")
_TOPIC_AND_PATH = re.compile(r"(/[\w/]+)(\.[\w.\[\]]+)?")
_IN_BRACES = re.compile(r"\{([A-Za-z]\w*)\}", re.ASCII)
_CLOSING = {"(": ")", "{": "}", "[": "]"}
_VALUE_BEGINS = frozenset({"NAME", "NUMBER", "STRING", "true", "false", "(", "FUNCTION", "QUANTIFIER"})
_DEFINING = ("decl", "model", "object", "zone", "guard", "message", "SETTING")
_COMMANDS = TEMPORAL | {*_DEFINING, "assume", "forall", "ATTRIBUTES", "WITHIN_FIRST", END}
_PLAIN_VALUE = re.compile(
    r"(?:^|[(,:]|(?<![=<>!])=|\b(?:and|or|implies|always|never|eventually|initially))\s*([\w.]+)\s*$",
    re.ASCII | re.MULTILINE,
)
_VALUE_ENDS = frozenset({"NAME", "NUMBER", "STRING", "true", "false", ")", "}", "]"})


_FORALL = re.compile(r"\bforall\b[^{}:#]*\{[^{}:#]*\}\s*:\s*\Z")
"""The head of a `forall` at the end of a text."""


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

    def report(self, code: str, message: str, *secondary: Label, label: str = "", help: str | Help = "") -> Diagnostic:
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
        return situation.report("LTL001", message, label=f"expected {expected}")
    return situation.report("LTL001", message, label="the property ends before this")


def _forall(at: Situation) -> Diagnostic | None:
    """What is wrong in the head of a `forall`, or that it stands where a part of a property has to."""
    if at.token.terminal == "forall" and "forall" not in at.expected:
        return at.report("LTL018", "`forall` begins a property", help=f"write `[LABEL:] {FORMS['forall']}`")
    head = [token.terminal for token in at.waiting]
    if "forall" not in head:
        return None
    read = head[len(head) - head[::-1].index("forall") :]
    if read[:2] == ["in", "{"] and "}" not in read:
        return _forall_names(at)
    if ":" not in read:
        message = f"{at.found} cannot stand here in a `forall`"
        if at.token.terminal == END:
            message = "a `forall` has begun, but the file ends"
        return at.report("LTL018", message, label=_next_in_forall(read), help=f"the form is `{FORMS['forall']}`")
    return None


def _attributes(at: Situation) -> Diagnostic | None:
    """What is wrong in the attributes of a requirement, or behind them."""
    form = 'the form is `[id "REQ-1", severity high]`, in front of a property'
    opener = next((token for token in at.waiting if token.terminal == "ATTRIBUTES"), None)
    if opener is None:
        is_behind = at.previous is not None and at.previous.terminal == "]" and "ATTRIBUTES" in at.expected
        message = f"attributes must be followed by a property, not {at.found}"
        return at.report("LTL006", message, help=form) if is_behind and "decl" not in at.expected else None
    word = at.previous and _UNQUOTED.match(at.source.text, at.previous.span.start)
    if word and at.token.span.start < word.end():
        key = "id " if word.start() == opener.span.end else ""
        help = write(writing(Span(*word.span()), f'{key}"{word.group()}"', is_certain=not key))
        return diagnostic("LTL001", at.source, Span(*word.span()), f"`{word.group()}` must be a string", help=help)
    if "]" in at.expected:
        return at.report("LTL005", f"`[` is not closed before {at.found}", Label(opener.span, "opened here"), help=form)
    return at.report("LTL006", f"{at.found} cannot stand in attributes", help=form)


def _id_as_label(at: Situation) -> Diagnostic | None:
    """`REQ-001: P`: the id of a requirement where a label stands."""
    line = at.source.text.rfind("\n", 0, at.token.span.start) + 1
    label = _UNQUOTED.match(at.source.text, line)
    if at.token.terminal != ":" or label is None or at.source.text[label.end() : at.token.span.start].strip():
        return None
    blank = _BLANKS.match(at.source.text, at.token.span.end)
    end = blank.end() if blank else at.token.span.end
    help = write(writing(Span(label.start(), end), f'[id "{label.group()}"]\n'))
    message = f"`{label.group()}` is not a label: labels have letters, digits and `_`; an id is an attribute"
    return diagnostic("LTL001", at.source, Span(*label.span()), message, help=help)


def _label_in_forall(at: Situation) -> Diagnostic | None:
    name, text = at.previous, at.source.text
    if at.token.terminal != ":" or name is None or name.terminal != "NAME":
        return None
    forall = _FORALL.search(text, 0, name.span.start)
    if forall is None:
        return None
    title = f"write `{name.text}: forall …`"
    after = at.token.span.end + len(text[at.token.span.end :]) - len(text[at.token.span.end :].lstrip(" \t"))
    label = Span(forall.start(), forall.start()), f"{name.text}: "
    fix = Fix(title, (label, (Span(name.span.start, after), "")), is_certain=True)
    return at.report("LTL018", "the label comes before `forall`", help=Help(title, (fix,)))


def _next_in_forall(read: Sequence[str]) -> str:
    if not read:
        return "expected variables separated by commas, then `in`"
    return f"expected `{'{' if read == ['in'] else ':'}` before this"


def _forall_names(at: Situation) -> Diagnostic | None:
    """What is wrong among the names over which a `forall` goes."""
    form = f"the form is `{FORMS['forall']}`"
    if at.token.terminal == "}" and at.previous and at.previous.terminal == "{":
        return at.report("LTL018", "the set is empty: `forall` would have no property", help=form)
    if at.token.terminal == "STRING" and at.token.text.isidentifier():
        help = write(writing(at.place, at.token.text, is_certain=True))
        return at.report("LTL018", f"{at.found} is a string, but a name is needed here", help=help)
    if at.token.terminal == "NAME":
        return at.report(
            "LTL002", f"a comma is missing before {at.found}", help=Help(form, (_after_previous(at, ","),))
        )
    if at.previous and at.previous.terminal == "NAME":
        return None
    return at.report("LTL018", f"expected a name here, not {at.found}", help=form)


def _braces(at: Situation) -> Diagnostic | None:
    name = _IN_BRACES.match(at.source.text, at.token.span.start)
    if not at.begins_value or name is None:
        return None
    whole = writing(Span(*name.span()), name[1])
    help = Help(f"for a whole name {whole.title}, for a part of a name write `{name[0]}_battery`", (whole,))
    return at.report(
        "LTL018", f"`{name[0]}` is not a value: braces insert the variable of a `forall` into a name", help=help
    )


def _after_previous(at: Situation, text: str, *, is_certain: bool = False) -> Fix:
    """The fix that puts `text` in where the last token before this one ends."""
    return put(at.place.start if at.previous is None else at.previous.span.end, text, is_certain=is_certain)


def _colon_in_message(at: Situation) -> Diagnostic | None:
    if at.token.terminal != "=" or ":" not in at.expected or not any(t.terminal == "message" for t in at.waiting):
        return None
    return at.report(
        "LTL001", "a field of a message gets its value by `:`", help=write(writing(at.place, ":", is_certain=True))
    )


def _single_equals(at: Situation) -> Diagnostic | None:
    if at.token.terminal != "=" or at.previous is None or at.previous.terminal not in _VALUE_ENDS:
        return None
    if "TOPIC" in at.expected:
        return None
    message = "`=` names things; values are compared with `==`"
    if at.source.text[at.token.span.end :].lstrip()[:1] in ("<", ">", "!"):
        return at.report("LTL003", message, help="write one of `==`, `!=`, `<`, `<=`, `>`, `>=`")
    is_compared = any(token.terminal in KEYWORDS | {"=", ":"} for token in at.read) and not _begins_line(at)
    help = write(writing(at.place, "==", is_certain=is_compared))  # else a name may be meant
    return at.report("LTL003", message, help=help)


def _begins_line(at: Situation) -> bool:
    """Whether the last token before this one is the first of its line."""
    before = at.source.text[: at.previous.span.start] if at.previous else ""
    return not before[before.rfind("\n") + 1 :].strip()


def _keyword_as_name(at: Situation) -> Diagnostic | None:
    if at.token.terminal in ("=", ":") and len(at.waiting) == 1 and at.previous and at.previous.text in KEYWORDS:
        return _no_name(at.source, at.previous)
    wants_name = "NAME" in at.expected and not at.begins_value
    after = at.source.text[at.token.span.end :].lstrip()
    wants_name = wants_name or (after.startswith(("=", ":")) and not after.startswith("=="))
    if not wants_name or at.token.terminal not in KEYWORDS or ";" in at.expected:
        return None
    return _no_name(at.source, at.token)


def _no_name(source: Source, keyword: Token) -> Diagnostic:
    fix = writing(keyword.span, f"my_{keyword.text}")
    message = f"`{keyword.text}` is a keyword and cannot be a name"
    return diagnostic(
        "LTL008", source, keyword.span, message, help=Help(f"use another, such as `my_{keyword.text}`", (fix,))
    )


def _chained_comparison(at: Situation) -> Diagnostic | None:
    if at.token.terminal not in _RELATIONS or not at.read or at.read[-1].terminal not in _RELATIONS:
        return None
    first = Label(at.read[-1].span, "the comparison is complete here")
    help: str | Help = "compare twice: `a < b and b < c`"
    middle = at.source.text[at.read[-1].span.end : at.token.span.start].strip()
    if _PLAIN_WORD.fullmatch(middle):
        again = Span(at.token.span.start, at.token.span.start), f"and {middle} "
        help = write(Fix(f"write `… {middle} and {middle} …`", (again,)))
    return at.report("LTL013", f"comparisons cannot be chained: {at.found} follows a comparison", first, help=help)


def _chained_since(at: Situation) -> Diagnostic | None:
    first = next((t for t in reversed(at.read) if t.terminal in ("since", "(")), None)
    if at.token.terminal != "since" or first is None or first.terminal == "(":
        return None
    help = "put one of them in parentheses: `(p since q) since r` or `p since (q since r)`"
    return at.report("LTL013", "`since` cannot be chained", Label(first.span, "the first one"), help=help)


def _not_in(at: Situation) -> Diagnostic | None:
    if at.token.terminal != "in" or at.previous is None or at.previous.terminal != "not":
        return None
    text = "write `not x in {1, 2}`"
    value = _PLAIN_VALUE.search(
        at.source.text, at.source.text.rfind("\n", 0, at.previous.span.start) + 1, at.previous.span.start
    )
    fixes: tuple[Fix, ...] = ()
    if value is not None:
        edits = (Span(value.start(1), value.start(1)), "not "), (Span(at.previous.span.start, at.token.span.start), "")
        fixes = (Fix(f"write `not {value[1]} in`", edits, is_certain=True),)
    return at.report("LTL001", "`not` comes before the value, not before `in`", help=Help(text, fixes))


def _missing_value(at: Situation) -> Diagnostic | None:
    if not at.begins_value or at.previous is None or "decl" in at.expected:
        return None
    before = f"`{at.source.text[at.previous.span.start : at.previous.span.end]}`"
    if at.previous.terminal == "=" and at.token.terminal == "/":
        topic = _TOPIC_AND_PATH.match(at.source.text, at.token.span.start)
        path = (topic and topic[2]) or ".FIELD"
        help = f"declare a signal: `decl {at.read[-2].text} {topic[1] if topic else '/TOPIC'} TYPE{path}`"
        return at.report("LTL006", f"expected a value after {before}, not a topic", help=help)
    form = _form(at)
    what = "a property" if at.previous.terminal in FORMS or "always" in at.expected else "a value"
    what = "a duration" if at.previous.terminal in ("WITHIN_FIRST", "within", "for") else what
    message = f"expected {what} after {before}, not {at.found}"
    if at.token.terminal == END:
        message = f"expected {what} after {before}, but the file ends"
    return at.report("LTL006", message, help=f"the form is `{form}`" if form else "")


def _missing_comma(at: Situation) -> Diagnostic | None:
    opener = _open_keyword(at)
    if "," not in at.expected or opener is None:
        return None
    form, label = FORMS[opener.terminal], Label(opener.span, "this needs it")
    if at.token.terminal == END or at.token.terminal in ("decl", "model", "object", "SETTING", ")", ":", "="):
        message = f"`{opener.text}` lacks an argument before {at.found}"
        return at.report("LTL006", message, label, help=f"the form is `{form}`")
    message = f"a comma is missing before {at.found}: separate the arguments of `{opener.text}`"
    help = Help(f"the form is `{form}`", (_after_previous(at, ","),))
    return at.report("LTL002", message, label, label="expected `,` before this", help=help)


def _unclosed(at: Situation) -> Diagnostic | None:
    opener = next((t for t in reversed(at.waiting) if t.terminal in _CLOSING), None)
    if opener is None or _CLOSING[opener.terminal] not in at.expected:
        return None
    closing = _CLOSING[opener.terminal]
    message = f"`{opener.terminal}` is not closed before {at.found}"
    missing = [closing, ","] if "," in at.expected else [closing]
    text = " or ".join(f"a `{each}`" for each in missing) + " is missing"
    fitting = [each for each in missing if at.token.terminal in (_COMMANDS if each == closing else _VALUE_BEGINS)]
    help = Help(text, tuple(_after_previous(at, each) for each in fitting))
    return at.report("LTL005", message, Label(opener.span, "opened here"), help=help)


def _definition_in_model(at: Situation) -> Diagnostic | None:
    """`near = …` or `fast: …` behind a model without `;`, where the name is taken for an attribute."""
    model = next((token for token in at.waiting if token.terminal == "model"), None)
    if model is None or at.token.terminal not in ("=", ":") or "TOPIC" not in at.expected or not _begins_line(at):
        return None
    text, (colon, name) = at.source.text, at.waiting[-2:]
    is_first = skip_blank(text, colon.span.end) == name.span.start
    if is_first or text[at.token.span.end :].lstrip()[:1] in ("/", "~"):
        return None
    message, label = f"the model must end with `;` before `{name.text}`", Label(model.span, "the model begins here")
    help = "write `;` after its last attribute"
    return diagnostic("LTL007", at.source, name.span, message, secondary=(label,), help=help)


def _missing_semicolon(at: Situation) -> Diagnostic | None:
    if ";" not in at.expected:
        return None
    model = next(t for t in at.waiting if t.terminal == "model")
    message = f"the model must end with `;` before {at.found}"
    fixes = (_after_previous(at, " ;", is_certain=True),) if at.token.terminal in _COMMANDS else ()
    help = Help("write `;` after its last attribute", fixes)
    return at.report("LTL007", message, Label(model.span, "the model begins here"), help=help)


def _incomplete_command(at: Situation) -> Diagnostic | None:
    opener = next((t for t in at.waiting if t.terminal in _DEFINING), None)
    if opener is None or (at.begins_value and opener.terminal not in ("object", "zone")):
        return None
    form = FORMS.get(opener.terminal, f"{opener.text} = VALUE")
    needed = "a coordinate" if at.begins_value else expectation(at.expected - {"+", "-"})
    message = f"expected {needed} here, not {at.found}"
    if at.token.terminal == END:
        message = f"expected {needed}, but the file ends"
    return at.report("LTL006", message, Label(opener.span), help=f"the form is `{form}`")


def _stray_closing(at: Situation) -> Diagnostic | None:
    opening = {v: k for k, v in _CLOSING.items()}.get(at.token.terminal)
    if opening is None:
        return None
    return at.report("LTL001", f"{at.found} closes nothing", help=f"no `{opening}` is open here")


_MISTAKES: tuple[Callable[[Situation], Diagnostic | None], ...] = (
    _definition_in_model,
    _colon_in_message,
    _attributes,
    _single_equals,
    _keyword_as_name,
    _id_as_label,
    _forall,
    _label_in_forall,
    _braces,
    _chained_comparison,
    _chained_since,
    _not_in,
    _missing_semicolon,
    _incomplete_command,
    _missing_value,
    _missing_comma,
    _unclosed,
    _stray_closing,
)


def _open_keyword(at: Situation) -> Token | None:
    """The innermost keyword that waits for a comma."""
    openers = ("after", "until", "after_until", "WITHIN_FIRST", "@")
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


def too_deep(source: Source, span: Span, limit: int) -> Diagnostic:
    """The place from which on a property is nested deeper than `limit`."""
    help = "several simpler properties say more when one fails"
    return diagnostic("LTL015", source, span, f"the property is nested more than {limit} deep", help=help)
