"""Names of emitted C in Rust: the same, unless Rust means something else by them."""

from __future__ import annotations

from collections.abc import Iterable

from ltlc.backends.names import Names

_KEYWORDS = """
Self abstract as async await become box break const continue crate do dyn else enum extern false final fn for if impl in
let loop macro match mod move mut override priv pub ref return self static struct super trait true try type typeof union
unsafe unsized use virtual where while yield
"""
_RESERVED = frozenset(f"{_KEYWORDS} Some None Ok Err LIMIT NEVER PLACES".split())
_TYPES = frozenset(["Judgement", "Option", "Property", "Self", "Verdict"])


def spelled(name: str) -> str:
    """A name of C, none of which ends so, as one of Rust."""
    return f"{name}_" if name in _RESERVED else name


def struct_name(struct: str) -> str:
    """What a struct of C is called that no property has."""
    return struct[0].upper() + struct[1:]


def type_names(structs: Iterable[str]) -> Names:
    """Names of types, beside those that all files have and those of `structs` of C."""
    return Names(_TYPES | frozenset(map(struct_name, structs)))
