"""ltlc compiles properties of robots into runtime monitors whose meaning is defined, checked and proved."""

__version__ = "0.1.0"
