"""ltlc compiles properties of robots into runtime monitors whose meaning is defined, checked and proved."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ltlc.comparison.api import UnusableInput, compare

__version__ = "0.1.0"
__all__ = ["UnusableInput", "compare"]


def __getattr__(name: str) -> Any:
    """The public functions, imported when they are first asked for: they need Spot, and not every command does."""
    if name not in __all__:
        raise AttributeError(f"module `ltlc` has no `{name}`")
    from ltlc.comparison import api

    return getattr(api, name)
