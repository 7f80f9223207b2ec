"""ltlc compiles properties of robots into runtime monitors whose meaning is defined, checked and proved."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ltlc.api.build import Build, build
    from ltlc.api.check import Check, check
    from ltlc.api.compare import compare
    from ltlc.api.corpus import measure_corpus
    from ltlc.api.monitor import LiveRun, monitor
    from ltlc.api.results import Run
    from ltlc.api.run import run, run_each
    from ltlc.errors import UnusableInput
    from ltlc.limits import Budget
    from ltlc.semantics.verdicts import Verdict

__version__ = "0.1.0"
__all__ = [
    "Budget",
    "Build",
    "Check",
    "LiveRun",
    "Run",
    "UnusableInput",
    "Verdict",
    "build",
    "check",
    "compare",
    "measure_corpus",
    "monitor",
    "run",
    "run_each",
]

_MODULES = {
    "Budget": "ltlc.limits",
    "Build": "ltlc.api.build",
    "Check": "ltlc.api.check",
    "LiveRun": "ltlc.api.monitor",
    "Run": "ltlc.api.results",
    "UnusableInput": "ltlc.errors",
    "Verdict": "ltlc.semantics.verdicts",
    "build": "ltlc.api.build",
    "check": "ltlc.api.check",
    "compare": "ltlc.api.compare",
    "measure_corpus": "ltlc.api.corpus",
    "monitor": "ltlc.api.monitor",
    "run": "ltlc.api.run",
    "run_each": "ltlc.api.run",
}


def __getattr__(name: str) -> Any:
    """The public names, imported when they are first asked for: most need Spot, and not every command does."""
    if name not in _MODULES:
        raise AttributeError(f"module `ltlc` has no `{name}`")
    return getattr(import_module(_MODULES[name]), name)
