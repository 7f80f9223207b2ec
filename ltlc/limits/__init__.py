"""Work in child processes, bounded in time and memory."""

from __future__ import annotations

from ltlc.limits.budget import Budget, Exceeded, Limit
from ltlc.limits.children import Watch, run_all

__all__ = ["Budget", "Exceeded", "Limit", "Watch", "run_all"]
