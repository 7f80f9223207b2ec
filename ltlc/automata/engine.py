"""Finds Spot: the package that PyPI calls `spottl`, or conda-forge's `spot`."""

from __future__ import annotations

import warnings

from ltlc.automata.errors import SpotMissing

try:
    with warnings.catch_warnings():
        # SWIG's types lack `__module__`; as an error, that warning crashes the interpreter.
        warnings.simplefilter("ignore", DeprecationWarning)
        import spot  # noqa: TID251  # isort: skip  spottl's `spot` makes `buddy` importable
        import buddy  # noqa: TID251  # isort: skip
except ImportError as error:
    raise SpotMissing(str(error)) from error

if not hasattr(spot, "translator"):
    raise SpotMissing(f"the module `spot` at {getattr(spot, '__file__', '?')} is not the automata library")

__all__ = ["buddy", "spot"]
