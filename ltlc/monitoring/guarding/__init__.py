"""Recordings as a guard would have let them through: what it is tried on before it drives."""
