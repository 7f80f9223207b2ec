"""Whole files compared with what ltlc emits afresh: all that is in them, not only the step functions."""
