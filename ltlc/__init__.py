"""ltlc compiles properties of robots into runtime monitors whose meaning is defined, checked and proved."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ltlc.base.errors import UnusableInput
    from ltlc.base.limits import Budget
    from ltlc.interfaces.api.build import Build, build
    from ltlc.interfaces.api.check import Check, check
    from ltlc.interfaces.api.compare import compare
    from ltlc.interfaces.api.corpus import measure_corpus
    from ltlc.interfaces.api.falsify import Falsified, falsify
    from ltlc.interfaces.api.guard import LiveGuard, guard
    from ltlc.interfaces.api.monitor import LiveRun, monitor
    from ltlc.interfaces.api.results import Run
    from ltlc.interfaces.api.run import run, run_each
    from ltlc.semantics.verdicts import Verdict

__version__ = "1.0.0"
__all__ = [
    "Budget",
    "Build",
    "Check",
    "Falsified",
    "LiveGuard",
    "LiveRun",
    "Run",
    "UnusableInput",
    "Verdict",
    "build",
    "check",
    "compare",
    "falsify",
    "guard",
    "measure_corpus",
    "monitor",
    "run",
    "run_each",
]

_MODULES = {
    "Budget": "ltlc.base.limits",
    "Build": "ltlc.interfaces.api.build",
    "Check": "ltlc.interfaces.api.check",
    "Falsified": "ltlc.interfaces.api.falsify",
    "LiveGuard": "ltlc.interfaces.api.guard",
    "LiveRun": "ltlc.interfaces.api.monitor",
    "Run": "ltlc.interfaces.api.results",
    "UnusableInput": "ltlc.base.errors",
    "Verdict": "ltlc.semantics.verdicts",
    "build": "ltlc.interfaces.api.build",
    "check": "ltlc.interfaces.api.check",
    "compare": "ltlc.interfaces.api.compare",
    "falsify": "ltlc.interfaces.api.falsify",
    "guard": "ltlc.interfaces.api.guard",
    "measure_corpus": "ltlc.interfaces.api.corpus",
    "monitor": "ltlc.interfaces.api.monitor",
    "run": "ltlc.interfaces.api.run",
    "run_each": "ltlc.interfaces.api.run",
}


def __getattr__(name: str) -> Any:
    """The public names, imported when they are first asked for: most need Spot, and not every command does."""
    if name not in _MODULES:
        raise AttributeError(f"module `ltlc` has no `{name}`")
    return getattr(import_module(_MODULES[name]), name)
