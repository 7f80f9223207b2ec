"""What can keep a formula from becoming a monitor."""

from __future__ import annotations


class SpotMissing(ImportError):  # noqa: N818  what it is called in the public interface
    """Spot cannot be imported; the message says how to install it."""

    def __init__(self, reason: str) -> None:
        super().__init__(
            f"ltlc needs the automata library Spot ({reason}): `pip install spottl` on Linux x86-64, "
            "or `conda install -c conda-forge spot` elsewhere"
        )
