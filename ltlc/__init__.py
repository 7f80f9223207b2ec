"""ltlc compiles properties of robots into runtime monitors whose meaning is defined, checked and proved."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ltlc.comparison.api import compare
    from ltlc.comparison.corpus import measure_corpus
    from ltlc.comparison.errors import UnusableInput

__version__ = "0.1.0"
__all__ = ["UnusableInput", "compare", "measure_corpus"]


def __getattr__(name: str) -> Any:
    """The public functions, imported when they are first asked for: they need Spot, and not every command does."""
    if name not in __all__:
        raise AttributeError(f"module `ltlc` has no `{name}`")
    from ltlc.comparison import api, corpus, errors

    return next(getattr(module, name) for module in (api, corpus, errors) if hasattr(module, name))
