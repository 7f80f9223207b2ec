"""Lowered machines against certified monitors: the atoms as the specification says them, the control on diagrams."""
