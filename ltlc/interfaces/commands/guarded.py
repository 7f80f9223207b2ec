"""`ltlc run --guard`: the guards of a file, solved, to be tried on a recording."""

from __future__ import annotations

import argparse

from ltlc.base.errors import UnusableInput
from ltlc.interfaces.api.guard import guarding_of
from ltlc.interfaces.api.prepare import Prepared
from ltlc.interfaces.commands.common import unusable
from ltlc.interfaces.commands.progress import saying
from ltlc.monitoring.guarding.recording import Guarding

WITHOUT = {
    "evidence": "it shows what follows from the recording, not from what a guard would have let through",
    "cut": "an extract has what was recorded, not what a guard would have let through; --output writes that",
    "engine": "the game that gives reasons stays in this process; --jobs guards several recordings at a time",
}
"""The options that are about a recording as it is, or about other machines, and why they do not fit."""


def guarding(prepared: Prepared, options: argparse.Namespace) -> Guarding | int:
    """The guards of what was `prepared`, or the exit code."""
    try:
        with saying("solving the guards", options.quiet):
            return guarding_of(prepared, keeps_messages=bool(options.output))
    except UnusableInput as error:
        return unusable(f"--guard: {error}")


def refused_beside(options: argparse.Namespace) -> str | None:
    """Why an option cannot be combined with `--guard`, if one was given that cannot."""
    given = ((f"--{name}", why) for name, why in WITHOUT.items() if getattr(options, name))
    return next((f"--guard cannot be combined with {name}: {why}" for name, why in given), None)
