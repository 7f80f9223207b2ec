"""The possible outcomes of comparing a file with what ltlc emits."""

from __future__ import annotations

from ltlc.dataclass import dataclass

MOST_SHOWN = 100
"""How many characters of a line are shown."""


@dataclass(frozen=True, slots=True)
class Equal:
    """Nothing differs but what is `not_compared`; `how` they were compared, and which functions there are."""

    how: str
    functions: tuple[str, ...] = ()
    not_compared: str = ""


@dataclass(frozen=True, slots=True)
class Unequal:
    """What differs first, or why that is unknown; `line` is that of the file, `function` the one it is in."""

    reason: str
    line: int | None = None
    function: str = ""

    def at(self, file: str) -> str:
        """The difference with its place in `file`."""
        place = file if self.line is None else f"{file}:{self.line}"
        return f"{place}: {f'in `{self.function}`, ' if self.function else ''}{self.reason}"


def instead(found: str | None, emitted: str | None) -> str:
    """That a line stands where ltlc emits another; None is the end."""
    if emitted is None:
        return f"{_shown(found)} where ltlc emits nothing more"
    return f"{_shown(found)} where ltlc emits {_shown(emitted)}"


def _shown(line: str | None) -> str:
    if line is None:
        return "nothing"
    line = " ".join(line.split())
    return f"`{line}`" if len(line) <= MOST_SHOWN else f"`{line[:MOST_SHOWN]}…`"
