"""Specifications of other tools, written in the language: `ltlc import`."""
