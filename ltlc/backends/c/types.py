"""Types of C for the values of signals: those that their fields have."""

from __future__ import annotations

from dataclasses import dataclass

from ltlc.specification.expressions import Signal, ValueType
from ltlc.specification.wire import PRIMITIVES, Kind, Numbers

_INTEGERS = {PRIMITIVES[name]: f"{name}_t" for bits in (8, 16, 32, 64) for name in (f"int{bits}", f"uint{bits}")}


@dataclass(frozen=True, slots=True)
class CType:
    """A type, by its `name`; of an array, that of its elements."""

    name: str
    is_array: bool = False

    @property
    def element(self) -> CType:
        """The type of the elements of an array."""
        return CType(self.name)

    @property
    def pointer(self) -> str:
        """What leads to the elements of an array of it."""
        return f"{self.name}const *" if self.name.endswith("*") else f"const {self.name} *"

    @property
    def plural(self) -> str:
        """What arrays of it are called."""
        return {"const char *": "text"}.get(self.name, self.name.removesuffix("_t")) + "s"

    @property
    def integers(self) -> Numbers | None:
        """The integers that it has; None if it is no type of integers."""
        return next((numbers for numbers, name in _INTEGERS.items() if name == self.name), None)

    @property
    def is_wide(self) -> bool:
        """Whether some of its numbers are no doubles."""
        return self.integers is not None and self.integers.is_wide


DOUBLE, FLOAT, BOOL, TEXT = CType("double"), CType("float"), CType("bool"), CType("const char *")


def type_of(signal: Signal) -> CType:
    """The type of the values of `signal`."""
    single = signal.type.element or signal.type
    return CType(_single(single, signal.numbers).name, is_array=signal.type.element is not None)


def _single(type_: ValueType, numbers: Numbers) -> CType:
    match type_:
        case ValueType.BOOLEAN:
            return BOOL
        case ValueType.STRING:
            return TEXT
    if numbers.kind is Kind.INTEGER:
        return CType(_INTEGERS[numbers])
    return FLOAT if numbers.kind is Kind.SINGLE else DOUBLE
