"""Numbers in CDR messages, and messages that do not fit their definition."""

from __future__ import annotations

SCALARS = {
    **dict.fromkeys(("bool", "boolean", "byte", "octet", "char", "uint8"), "u1"),
    **{f"int{8 * size}": f"i{size}" for size in (1, 2, 4, 8)},
    **{f"uint{8 * size}": f"u{size}" for size in (2, 4, 8)},
    **dict.fromkeys(("float32", "float"), "f4"),
    **dict.fromkeys(("float64", "double"), "f8"),
}
"""How a number lies in a message, by its primitive type; it is aligned to its own size."""


class MisfitError(Exception):
    """Messages do not fit their definition; `reason` says how, as in `is too short for`."""

    def __init__(self, reason: str = "is not") -> None:
        super().__init__(reason)
        self.reason = reason
