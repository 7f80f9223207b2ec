"""`dataclass` of the standard library, where methods are compiled when they are first needed.

A command imports hundreds of classes and needs a few of their methods: compiling all of them took half of its start.
Instances are compared as the tuples of their fields with every version of Python, as the library does up to 3.12.
"""

from __future__ import annotations

import dataclasses
from dataclasses import MISSING, FrozenInstanceError, fields
from functools import partial
from typing import TYPE_CHECKING, Any

COMPARISONS = {"__eq__": "==", "__lt__": "<", "__le__": "<=", "__gt__": ">", "__ge__": ">="}

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from dataclasses import dataclass as dataclass
else:

    def dataclass(cls=None, /, *, frozen=False, slots=False, eq=True, order=False):
        """What `dataclasses.dataclass` makes with these options, but for InitVar; only frozen classes differ in how."""
        if cls is None:
            return partial(dataclass, frozen=frozen, slots=slots, eq=eq, order=order)
        if not frozen:
            return dataclasses.dataclass(cls, slots=slots, eq=eq, order=order)
        made = dataclasses.dataclass(cls, init=False, repr=False, eq=False, slots=slots)
        for name, method in _methods(made, slots, eq, order):
            if made.__dict__.get(name) is None:  # Python makes `__hash__` None where a class has an `__eq__` of its own
                setattr(made, name, method)
        return made


class _Compiled:
    """A method of a class that becomes what its text says when it is looked up."""

    def __init__(self, cls: type, name: str, text: Callable[[type, dict[str, object]], str]) -> None:
        self._cls, self._name, self._text = cls, name, text

    def __get__(self, instance: object, owner: type) -> Any:
        names: dict[str, object] = {"__name__": self._cls.__module__}
        exec(self._text(self._cls, names), names)
        method: Any = names[self._name]
        method.__qualname__ = f"{self._cls.__qualname__}.{self._name}"
        if self._name == "__init__":
            method.__annotations__ = {each.name: each.type for each in fields(self._cls) if each.init} | {
                "return": None
            }
        setattr(self._cls, self._name, method)
        return method.__get__(instance, owner)


def _methods(cls: type, slots: bool, eq: bool, order: bool) -> Iterator[tuple[str, object]]:
    yield "__init__", _Compiled(cls, "__init__", _init)
    yield "__repr__", _repr
    yield "__setattr__", _refuse_setting
    yield "__delattr__", _refuse_deleting
    if eq:
        yield "__hash__", _Compiled(cls, "__hash__", _hash)
        for name, operator in COMPARISONS.items() if order else [("__eq__", "==")]:
            yield name, _Compiled(cls, name, partial(_comparison, name, operator))
    if slots:
        yield "__getstate__", _state
        yield "__setstate__", _restore


def _init(cls: type, names: dict[str, object]) -> str:
    """The text of `__init__`; what it speaks of is added to `names`, as no field can be called in a class."""
    names |= {"__set": object.__setattr__, "__missing": MISSING}
    positional, keywords, body = ["self"], ["*"], [" pass"]
    for each in fields(cls):
        given = value = each.name
        if each.default is not MISSING:
            names[default := f"__default_{each.name}"] = each.default
            given, absent = f"{each.name}={default}", default
        elif each.default_factory is not MISSING:
            names[factory := f"__default_{each.name}"] = each.default_factory
            given, absent = f"{each.name}=__missing", f"{factory}()"
            value = f"{absent} if {each.name} is __missing else {each.name}"
        elif not each.init:
            continue
        if each.init:
            (keywords if each.kw_only else positional).append(given)
        body.append(f" __set(self, {each.name!r}, {value if each.init else absent})")
    if hasattr(cls, "__post_init__"):
        body.append(" self.__post_init__()")
    parameters = positional + keywords * (len(keywords) > 1)
    return "\n".join([f"def __init__({', '.join(parameters)}):", *body])


def _comparison(name: str, operator: str, cls: type, _names: dict[str, object]) -> str:
    compared = f"{_compared(cls, 'self')} {operator} {_compared(cls, 'other')}"
    return f"def {name}(self, other):\n return {compared} if other.__class__ is self.__class__ else NotImplemented"


def _hash(cls: type, _names: dict[str, object]) -> str:
    return f"def __hash__(self):\n return hash({_compared(cls, 'self')})"


def _compared(cls: type, instance: str) -> str:
    return f"({''.join(f'{instance}.{each.name}, ' for each in fields(cls) if each.compare)})"


def _repr(self: Any) -> str:
    shown = (f"{each.name}={getattr(self, each.name)!r}" for each in fields(self) if each.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _refuse_setting(_self: object, name: str, _value: object) -> None:
    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _refuse_deleting(_self: object, name: str) -> None:
    raise FrozenInstanceError(f"cannot delete field {name!r}")


def _state(self: Any) -> list[object]:
    return [getattr(self, each.name) for each in fields(self)]


def _restore(self: Any, state: list[object]) -> None:
    for each, value in zip(fields(self), state, strict=True):
        object.__setattr__(self, each.name, value)
