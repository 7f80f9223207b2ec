"""Work in child processes, bounded in time and memory."""

from __future__ import annotations

from ltlc.limits.budget import UNBOUNDED, Budget, Exceeded, Limit
from ltlc.limits.children import Watch, run_all, run_each
from ltlc.limits.memory import at_most

__all__ = ["UNBOUNDED", "Budget", "Exceeded", "Limit", "Watch", "at_most", "run_all", "run_each"]
