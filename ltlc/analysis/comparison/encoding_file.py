"""Reads user-defined encodings: a name, and an equation for each scope keyword.

    # what I think the patterns mean
    encoding patient
    after X, Z          = G(X -> G Z)
    until X, Z          = Z U X
    after_until X, Y, Z = G((X & !Y & F Y) -> rel(Y, Z))
    bare

X and Y are the events, Z is the body, already encoded. With `bare`, a state predicate that is a body stays as it is;
without, it is read as `always` it. A file may define several encodings; `#` starts a comment.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import field

from ltlc.analysis.comparison.bounded import within
from ltlc.analysis.comparison.equations import Equation, EquationError, parse_equation
from ltlc.automata.queries import is_satisfiable
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import Budget
from ltlc.base.nearest import did_you_mean
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.encodings import Encoding
from ltlc.semantics.ltl import Atom, Not

KEYWORDS = {"after": ("X", "Z"), "until": ("X", "Z"), "after_until": ("X", "Y", "Z")}
"""The keywords that an encoding has to give equations for, with what stands on the left side."""

_NAME = re.compile(r"[A-Za-z][\w-]*")
_LEFT_SIDE = re.compile(r"(?P<keyword>\w+)\s*(?P<letters>.*)", re.DOTALL)


@dataclass
class _Draft:
    """An encoding while it is read."""

    name: str
    span: Span
    equations: dict[str, Equation] = field(default_factory=dict)
    places: dict[str, Span] = field(default_factory=dict)
    bare: bool = False


def read_encodings(source: Source, taken: frozenset[str], budget: Budget) -> tuple[list[Encoding], list[Diagnostic]]:
    """The encodings that `source` defines and its errors; names in `taken` cannot be used.

    Encodings come back only where there is no error. Raises UnusableInput where `budget` does not suffice to look at
    their equations.
    """
    drafts: list[_Draft] = []
    problems: list[Diagnostic] = []
    for span in _statements(source):
        try:
            _read(source, span, drafts, taken)
        except EquationError as error:
            problems.append(error.diagnostic)
    for draft in drafts:
        problems += _missing(source, draft)
    if not drafts and not problems:
        problems.append(diagnostic("LTL323", source, Span(0, 0), "the file defines no encoding", help=_EXAMPLE))
    if problems:
        return [], problems
    warnings = within(budget, lambda: [w for draft in drafts for w in _idle(source, draft)], f"to read {source.name}")
    return [_finished(draft) for draft in drafts], warnings


_EXAMPLE = "begin with a line such as `encoding mine`, then an equation for after, until and after_until"


def _statements(source: Source) -> Iterator[Span]:
    """The lines with something on them, without comments and white space around."""
    offset = 0
    for line in source.text.splitlines(keepends=True):
        text = line.split("#", 1)[0]
        if stripped := text.strip():
            start = offset + text.index(stripped)
            yield Span(start, start + len(stripped))
        offset += len(line)


def _read(source: Source, span: Span, drafts: list[_Draft], taken: frozenset[str]) -> None:
    """Take in one line. Raises EquationError."""
    text = source.text[span.start : span.end]
    if text.split()[0] == "encoding":
        drafts.append(_named(source, span, taken.union(draft.name for draft in drafts)))
        return
    if not drafts:
        raise _error("LTL323", source, span, "this line belongs to no encoding", _EXAMPLE)
    if text == "bare":
        drafts[-1].bare = True
        return
    _read_equation(source, span, drafts[-1])


def _named(source: Source, span: Span, taken: frozenset[str]) -> _Draft:
    name = source.text[span.start + len("encoding") : span.end].strip()
    if not _NAME.fullmatch(name):
        raise _error(
            "LTL321", source, span, "an encoding needs a name made of letters, digits, `-` and `_`", "encoding mine"
        )
    if name in taken:
        raise _error("LTL323", source, span, f"an encoding `{name}` already exists", "choose another name")
    return _Draft(name, span)


def _read_equation(source: Source, span: Span, draft: _Draft) -> None:
    """Take in an equation of `draft`. Raises EquationError."""
    left, equals, _ = source.text[span.start : span.end].partition("=")
    match = _LEFT_SIDE.match(left)
    if not equals or match is None:
        raise _error("LTL321", source, span, "an equation is missing here", "after X, Z = …")
    keyword = match["keyword"]
    if keyword not in KEYWORDS:
        place = Span(span.start, span.start + len(keyword))
        help = did_you_mean(keyword, KEYWORDS) or "the keywords are " + ", ".join(KEYWORDS)
        raise _error("LTL322", source, place, f"`{keyword}` is not a scope keyword", help)
    if keyword in draft.places:
        raise _error("LTL323", source, span, f"`{keyword}` already has an equation", "")
    draft.places[keyword] = span
    letters = KEYWORDS[keyword]
    if tuple(part.strip() for part in match["letters"].split(",")) != letters:
        wanted = f"{keyword} {', '.join(letters)}"
        place = Span(span.start, span.start + len(left.rstrip()))
        raise _error("LTL324", source, place, f"the left side must be `{wanted}`", f"{wanted} = …")
    right = Span(span.start + len(left) + 1, span.end)
    draft.equations[keyword] = parse_equation(source, right, letters, letters[:-1])


def _missing(source: Source, draft: _Draft) -> Iterator[Diagnostic]:
    for keyword, letters in KEYWORDS.items():
        if keyword not in draft.places:
            message = f"the encoding `{draft.name}` has no equation for `{keyword}`"
            yield diagnostic("LTL323", source, draft.span, message, help=f"{keyword} {', '.join(letters)} = …")


def _idle(source: Source, draft: _Draft) -> Iterator[Diagnostic]:
    """Equations that do not depend on some letter, or on the run."""
    for keyword, letters in KEYWORDS.items():
        equation, place = draft.equations[keyword], draft.places[keyword]
        formula, free = equation.of({letter: Atom(letter) for letter in letters}), Alphabet(letters)
        if not is_satisfiable(formula, free) or not is_satisfiable(Not(formula), free):
            which = "every" if is_satisfiable(formula, free) else "no"
            message = f"`{keyword}` of `{draft.name}` holds on {which} run, whatever its arguments"
            yield diagnostic("LTL325", source, place, message, help="is that intended?")
            continue
        for letter in letters:
            if letter not in equation.uses:
                message = f"`{keyword}` of `{draft.name}` does not depend on {letter}, {_ROLES[letter]}"
                yield diagnostic("LTL325", source, place, message, help="is that intended?")


_ROLES = {"X": "the event that opens", "Y": "the event that closes", "Z": "the body"}


def _finished(draft: _Draft) -> Encoding:
    after, until, after_until = (draft.equations[keyword].of for keyword in KEYWORDS)
    return Encoding(
        draft.name,
        "defined by the user",
        lambda x, z: after({"X": x, "Z": z}),
        lambda x, z: until({"X": x, "Z": z}),
        lambda x, y, z: after_until({"X": x, "Y": y, "Z": z}),
        draft.bare,
    )


def _error(code: str, source: Source, span: Span, message: str, help: str) -> EquationError:
    return EquationError(diagnostic(code, source, span, message, help=help))
