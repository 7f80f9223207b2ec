"""Terms as a person reads them, for messages."""

from __future__ import annotations

from ltlc.assurance.lowered.language import Apply, Constant, Moment, Term
from ltlc.assurance.lowered.meaning import Counted, ElementOf, Given
from ltlc.specification import text as specification_text

_INFIX = frozenset({"+", "-", "*", "/", "<", "<=", ">", ">=", "==", "!=", "and", "or"})


def text(term: Term) -> str:
    """`term` in one line."""
    match term:
        case Constant(value):
            return repr(value)
        case Moment(base, offset):
            return f"{base} {'+' if offset > 0 else '-'} {abs(offset)}" if offset else base
        case Given(read):
            return specification_text.text(read)
        case ElementOf(array):
            return f"an element of {text(array)}"
        case Counted(arrays):
            return f"the count of {' and '.join(sorted(map(text, arrays)))}"
        case Apply(function, arguments) if function in _INFIX:
            return f" {function} ".join(_operand(each) for each in arguments)
        case Apply(function, arguments):
            return f"{function}({', '.join(map(text, arguments))})"
        case _:
            return repr(term)


def _operand(term: Term) -> str:
    is_infix = isinstance(term, Apply) and term.function in _INFIX
    return f"({text(term)})" if is_infix else text(term)
