"""C compared as trees with what ltlc emits: comments, blanks and redundant parentheses make no difference.

The header for C++, which no parser here reads, is compared token by token.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import zip_longest

from pycparser.c_ast import FuncDef, Node

from ltlc.assurance.afresh.outcomes import Equal, Unequal, instead
from ltlc.assurance.reading.c.lexing import tokens
from ltlc.assurance.reading.c.parsing import Directive, difference, line_of, parsed, shown
from ltlc.assurance.reading.trees import NotUnderstoodError


def compare(found: str, emitted: str, types: Iterable[str] = ()) -> Equal | Unequal:
    """Whether two headers, or two source files that know `types`, are the same program."""
    types = tuple(types)
    right = parsed(emitted, types)
    try:
        items = parsed(found, types).items()
    except NotUnderstoodError as error:
        return Unequal(str(error))
    for item, other in zip_longest(items, right.items()):
        if unequal := _difference(item, other):
            return unequal
    functions = tuple(node.decl.name for node in right.nodes if isinstance(node, FuncDef))
    return Equal("as a tree", functions, "comments")


def _difference(found: Directive | Node | None, right: Directive | Node | None) -> Unequal | None:
    """What differs in a line for the preprocessor, a declaration or a definition; None is the end of the file."""
    if isinstance(found, Directive) or isinstance(right, Directive):
        if isinstance(found, Directive) and isinstance(right, Directive) and found.words == right.words:
            return None
        return Unequal(instead(_shown(found), _shown(right)), None if found is None else line_of(found))
    place = difference(found, right)
    return place and Unequal(instead(shown(place.found), shown(place.right)), place.line, place.function)


def _shown(item: Directive | Node | None) -> str | None:
    return " ".join(item.words) if isinstance(item, Directive) else shown(item)


def compare_tokens(found: str, emitted: str) -> Equal | Unequal:
    """Whether two headers for C++ consist of the same tokens."""
    for token, other in zip_longest(tokens(found), tokens(emitted)):
        if token is None or other is None or token.text != other.text:
            reason = instead(*(each.text if each else None for each in (token, other)))
            return Unequal(reason, token.line if token else None)
    return Equal("token by token", not_compared="comments")
