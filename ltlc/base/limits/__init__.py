"""Work in child processes, bounded in time and memory."""

from __future__ import annotations

from ltlc.base.limits.budget import UNBOUNDED, Budget, Exceeded, Limit
from ltlc.base.limits.children import Watch, run_all, run_each
from ltlc.base.limits.memory import at_most

__all__ = ["UNBOUNDED", "Budget", "Exceeded", "Limit", "Watch", "at_most", "run_all", "run_each"]
