"""Backends: what a compiled specification is written out as, one folder or file for each target, each with `emit`.

That of C makes several files, see `ltlc.backends.c`; all others have one text.
"""

from __future__ import annotations

import importlib
from collections.abc import Sequence

from ltlc.backends.inputs import require_whole_runs
from ltlc.compiler import Compiled
from ltlc.program.guards import GuardProgram
from ltlc.specification.specification import Specification

FILE_NAMES = {
    "ros2": "{stem}_monitor.py",
    "ament": "{stem}_monitor",
    "python": "{stem}_monitor.py",
    "c": "{stem}.c",
    "rust": "{stem}.rs",
    "hoa": "{stem}.hoa",
    "dot": "{stem}.dot",
    "json": "{stem}.json",
    "tests": "{stem}_tests",
}
"""The targets, and what their output is called, beside where one stands."""

JUDGE_EACH = ("ros2", "ament", "rust")
"""The targets that judge a property for each id; Rust itself refuses those for which a table is not all they need."""


GUARDED = ("ros2", "ament", "c")
"""The targets of code that have guards."""


def emit(
    target: str, compiled: Sequence[Compiled], specification: Specification, guards: Sequence[GuardProgram] = ()
) -> str:
    """The text of the output for one of the targets other than C, with `guards`. Raises NotInTargetError."""
    if target not in JUDGE_EACH:
        require_whole_runs(compiled)
    of_guards = (guards,) if guards else ()
    text: str = importlib.import_module(f"ltlc.backends.{target}").emit(compiled, specification, *of_guards)
    return text
