"""The `ltlc` command: which commands there are, and which module does each.

A command is a module of `ltlc.commands` with `add_arguments(parser)` and `run(options)`, whose result is the exit code.
It is imported when it is called, so that no other command's imports cost time.

Exit codes: 0 all well; 1 a finding (errors, a failed gate, a violated property) and nothing else; 2 unusable input or
usage, output that cannot be written, or a bug; 3 nothing violated, but something owed, never started or not decided.
"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
import traceback
from collections.abc import Collection, Sequence
from contextlib import suppress
from typing import Any

from ltlc import __version__

COMMANDS = {
    "new": "write a specification to start with, for the topics of a bag or of `ros2 topic list -t`",
    "check": "find what is wrong with specifications, without running them",
    "format": "write specifications in one canonical layout, in place",
    "build": "make monitors, judge them, and write a ROS 2 node or another target",
    "run": "judge a recorded run",
    "mine": "find the tightest thresholds and bounds, written as `?`, with which recorded runs pass",
    "certify": "check the certificates that someone else made, trusting neither Spot nor their monitors",
    "compare": "encodings of the same sentence, or formulas, side by side, with the runs that tell them apart",
    "explain": "say in plain English what properties mean, with example runs; or show the page of a diagnostic",
    "lsp": "serve an editor, over stdin and stdout, by the Language Server Protocol",
    "serve": "show a page in the browser to try properties on; nothing leaves this machine",
    "completion": "print what makes a shell complete the command line of ltlc",
}

TRACEBACK = "LTLC_TRACEBACK"
"""The environment variable that asks where a bug is."""

QUIET = "say only what was found: no progress, no count, no names of files written"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the result is the exit code of the process."""
    _open_closed_streams()
    try:
        code = _run(sys.argv[1:] if arguments is None else arguments)
        if not sys.stdout.closed:  # the language server closes it when its editor ends
            sys.stdout.flush()
        return code
    except BrokenPipeError:
        _give_up_stdout()
        return 2
    except OSError as error:
        with suppress(OSError):  # where stderr cannot be written
            print(f"ltlc: {f'{error.filename}: ' if error.filename else ''}{error.strerror or error}", file=sys.stderr)
        _give_up_stdout()
        return 2
    except KeyboardInterrupt:
        print("ltlc: interrupted", file=sys.stderr)
        return 130
    except MemoryError:
        print("ltlc: out of memory", file=sys.stderr)
        return 2
    except Exception as error:
        _report_bug(error)
        return 2


def _run(arguments: Sequence[str]) -> int:
    called = next((each for each in arguments if not each.startswith("-")), "")
    options = parser_of({called} & COMMANDS.keys()).parse_args(arguments)
    return int(_module(options.command).run(options))


def _open_closed_streams() -> None:
    """Nothing is read from, and nothing written to, a standard stream with which the process was not started."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115  it stays open


def _report_bug(error: Exception) -> None:
    """Say what went wrong in ltlc itself, and what its authors need to know; where, only if that is asked for."""
    what = f"{type(error).__name__}: {error}".partition("\n")[0]
    print(
        f"ltlc: this is a bug in ltlc {__version__}: {what}\n"
        f"Please report it with the command, its files and what `{TRACEBACK}=1` makes it print.",
        file=sys.stderr,
    )
    if os.environ.get(TRACEBACK):
        traceback.print_exception(error)


def _give_up_stdout() -> None:
    """Let Python not try again, at its end, to write what cannot be written."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def parser_of(called: Collection[str]) -> argparse.ArgumentParser:
    """The parser of `ltlc`, in which the commands `called` have their arguments, and the others have a name only."""
    parser = argparse.ArgumentParser(
        prog="ltlc",
        description="Compile properties of robots into runtime monitors.",
        epilog="Exit codes: 0 all well; 1 a finding; 2 unusable input or usage, or a bug; "
        "3 nothing violated, but something owed, never started or not decided.",
    )
    parser.add_argument("--version", action="version", version=f"ltlc {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, text in COMMANDS.items():
        command = commands.add_parser(name, help=text, description=text)
        if name in called:
            _module(name).add_arguments(command)
            command.add_argument("-q", "--quiet", action="store_true", help=QUIET)
    return parser


def _module(command: str) -> Any:
    return importlib.import_module(f"ltlc.commands.{command}")


if __name__ == "__main__":
    sys.exit(main())
