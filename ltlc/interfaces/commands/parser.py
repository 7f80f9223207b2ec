"""Which commands there are, which module does each, and the parser of their arguments.

A command is a module of this package with `add_arguments(parser)` and `run(options)`, whose result is the exit code. It
is imported when it is called, so that no other command's imports cost time.
"""

from __future__ import annotations

import argparse
import importlib
import keyword
import re
from collections.abc import Collection
from typing import Any, NoReturn

from ltlc.base.nearest import did_you_mean
from ltlc.base.revision import version_text

COMMANDS = {
    "new": "write a specification to start with, for the topics of a bag or of `ros2 topic list -t`",
    "import": "write a specification of FRET, C2PO, NuSMV, rtamt, reelay or HPL in this language, and compare the two",
    "check": "find mistakes in specifications, without running them",
    "format": "write specifications in one canonical layout, in place",
    "build": "make monitors, judge them, and write a ROS 2 node or another target",
    "run": "judge a recorded run",
    "mine": "find the tightest values for `?` with which recorded runs pass",
    "falsify": "search parameters and inputs of a simulation that violate a property, and shrink what is found",
    "matrix": "show which requirement is verified by which property, with which results, and what is not covered",
    "certify": "check certificates made by someone else, trusting neither Spot nor their monitors",
    "compare": "compare encodings of a sentence, formulas, or guards, and show runs that distinguish them",
    "explain": "explain properties in plain English, with example runs; or show the page of a diagnostic",
    "lsp": "run the language server for editors (LSP), over stdin and stdout",
    "serve": "serve a page for trying out properties in the browser; nothing leaves this machine",
    "completion": "print the completion script for a shell",
}

QUIET = "print findings and results only: no progress, no count, no names of files written"


def parser_of(called: Collection[str]) -> argparse.ArgumentParser:
    """The parser of `ltlc`, in which the commands `called` have their arguments, and the others have a name only."""
    parser = _Parser(
        prog="ltlc",
        description="Compile properties of robots into runtime monitors.",
        epilog="Exit codes: 0 all well; 1 a finding; 2 unusable input or usage, or a bug; "
        "3 nothing violated, but something still open, not started or not decided.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and the commit, and exit")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, text in COMMANDS.items():
        command = commands.add_parser(name, help=text, description=text)
        if name in called:
            module_of(name).add_arguments(command)
            command.add_argument("-q", "--quiet", action="store_true", help=QUIET)
    return parser


class _Version(argparse.Action):
    """Finds the commit when it is asked for, which takes a while."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        print(f"ltlc {version_text()}")
        parser.exit()


class _Parser(argparse.ArgumentParser):
    """Asks whether a known word is meant where an unknown one stands."""

    def error(self, message: str) -> NoReturn:
        if found := _CHOICE.search(message):
            near = did_you_mean(found[1], re.findall(r"[\w-]+", found[2]))
            message += f"; {near}" if near else ""
        super().error(message)


_CHOICE = re.compile(r"invalid choice: '([^']*)' \(choose from (.*)\)")


def module_of(command: str) -> Any:
    """The module of a command, imported when it is first asked for."""
    name = f"{command}_" if keyword.iskeyword(command) else command
    return importlib.import_module(f"ltlc.interfaces.commands.{name}")
