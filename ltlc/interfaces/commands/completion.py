"""`ltlc completion`: what makes bash, zsh or fish complete the command line of ltlc."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from ltlc.interfaces.commands.common import OK
from ltlc.interfaces.commands.parser import COMMANDS, parser_of

FILES = ("PROPS", "PROPS_OR_CODE", "RECORDING", "CERTIFICATE", "PATH", "FILE")
"""How what is asked for begins where a file is."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc completion` takes."""
    parser.add_argument("shell", choices=("bash", "zsh", "fish"))


def run(options: argparse.Namespace) -> int:
    """Print the script for a shell, which knows all commands and options as they are now: ltlc is not run by TAB."""
    import shtab

    parser = parser_of(COMMANDS)
    for action in _actions(parser):
        if isinstance(action.metavar, str) and action.metavar.startswith(FILES):
            action.complete = shtab.FILE  # type: ignore[attr-defined]
        elif action.metavar == "DIR":
            action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
    print(shtab.complete(parser, options.shell))
    return OK


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                yield from _actions(command)
        yield action
