"""Lowered machines against certified monitors: the atoms as in the specification, the control on diagrams."""
