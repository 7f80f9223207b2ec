"""Terms as a person reads them, for messages."""

from __future__ import annotations

from ltlc.assurance.reading.language import Apply, Attribute, Choice, Constant, Elements, Moment, Term, Variable
from ltlc.assurance.reading.meaning import Counted, ElementOf, Given
from ltlc.specification import text as specification_text

_INFIX = frozenset({"+", "-", "*", "/", "<", "<=", ">", ">=", "==", "!=", "and", "or"})
_SILENT = frozenset({"loose", "raw", "kept"})


def text(term: Term) -> str:
    """`term` in one line."""
    match term:
        case Constant(value):
            return getattr(value, "name", None) or repr(value)
        case Variable(name) | Attribute(name):
            return name
        case Moment(base, offset):
            return f"{base} {'+' if offset > 0 else '-'} {abs(offset)}" if offset else base
        case Given(read):
            return specification_text.text(read)
        case ElementOf(array):
            return f"an element of {text(array)}"
        case Counted(arrays) | Elements(_, arrays):
            return f"the count of {' and '.join(sorted(map(text, arrays)))}"
        case Choice(guard, then, otherwise):
            return f"{text(then)} if {text(guard)} else {text(otherwise)}"
        case Apply(function, (inner,)) if function in _SILENT:
            return text(inner)
        case Apply(function, arguments) if function in _INFIX:
            return f" {function} ".join(_operand(each) for each in arguments)
        case Apply(function, arguments):
            return f"{function}({', '.join(map(text, arguments))})"
        case _:
            return repr(term)


def _operand(term: Term) -> str:
    is_infix = isinstance(term, Apply) and term.function in _INFIX
    return f"({text(term)})" if is_infix else text(term)
