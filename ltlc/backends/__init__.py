"""Backends: what a compiled specification is written out as, one folder or file for each target, each with `emit`."""
