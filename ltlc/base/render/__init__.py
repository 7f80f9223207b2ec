"""Diagnostics for people and for tools: one file for each form of output."""
