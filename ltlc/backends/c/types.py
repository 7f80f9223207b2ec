"""The names of a program's types in C."""

from __future__ import annotations

from ltlc.program.types import Scalar, Type

_NAMES = {Scalar.BOOL: "bool", Scalar.TEXT: "const char *", Scalar.SINGLE: "float", Scalar.DOUBLE: "double"}


def type_name(scalar: Scalar) -> str:
    """The type of one value."""
    return _NAMES.get(scalar) or f"{scalar.value}_t"


def pointer(type_: Type) -> str:
    """What leads to the elements of an array."""
    name = type_name(type_.scalar)
    return f"{name}const *" if name.endswith("*") else f"const {name} *"


def plural(type_: Type) -> str:
    """What arrays of such elements are called."""
    return "texts" if type_.scalar is Scalar.TEXT else type_name(type_.scalar).removesuffix("_t") + "s"
