"""Which functions a file of emitted C needs: those that it calls, with those that these call."""

from __future__ import annotations

import re
from collections.abc import Iterable

from ltlc.backends.c.library import FUNCTIONS, MATHEMATICS, OF_ARRAYS
from ltlc.backends.c.types import plural, pointer
from ltlc.backends.library import called_in, needed
from ltlc.program.types import Type


def of_array(function: str, type_: Type) -> str:
    """The name of a function of an array of such elements."""
    return f"{function}_{plural(type_)}"


def texts(code: str, arrays: Iterable[Type], prefix: str) -> list[str]:
    """The definitions of the functions that `code` calls, which may be of `arrays`, and of those that they call.

    Types of arrays have names that begin with `prefix`.
    """
    definitions = {"square_error": FUNCTIONS["square_error"], **FUNCTIONS}
    for type_ in arrays:
        of_type = {"array": f"{prefix}_{plural(type_)}", "plural": plural(type_), "pointer": pointer(type_)}
        functions = OF_ARRAYS if type_.scalar.is_number else ("recent", "slice")
        definitions |= {of_array(f, type_): OF_ARRAYS[f].format(**of_type) for f in functions}
    return needed(definitions, code, called_in)


def uses_math(code: str) -> bool:
    """Whether code needs `math.h`."""
    return bool(MATHEMATICS & called_in(code)) or re.search(r"\b(INFINITY|NAN)\b", code) is not None
