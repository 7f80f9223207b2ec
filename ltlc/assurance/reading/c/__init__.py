"""Emitted C in the small language of step functions, by pycparser."""
