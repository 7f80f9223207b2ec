"""The `ltlc` command.

Exit codes: 0 all well; 1 a finding (errors, a failed gate, a violated property) and nothing else; 2 unusable input or
usage, output that cannot be written, or a bug; 3 nothing violated, but something still
open, not started or not decided.
"""

from __future__ import annotations

import gc
import os
import sys
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial

from ltlc.base.revision import version_text
from ltlc.interfaces.commands.parser import COMMANDS, module_of, parser_of

ALLOCATIONS = 50_000
"""So many objects more than were freed are searched for garbage, of which compiling makes little: 700 cost a tenth."""

TRACEBACK = "LTLC_TRACEBACK"
"""The environment variable that asks where a bug is."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the result is the exit code of the process."""
    _open_closed_streams()
    try:
        command = _without_garbage(sys.argv[1:]) if arguments is None else _command(arguments)
        code = command()
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
        if not _report_missing(error):
            _report_bug(error)
        return 2


def _command(arguments: Sequence[str]) -> Callable[[], int]:
    """What runs the command, its module imported."""
    called = next((each for each in arguments if not each.startswith("-")), "")
    options = parser_of({called} & COMMANDS.keys()).parse_args(arguments)
    return partial(module_of(options.command).run, options)


def _without_garbage(arguments: Sequence[str]) -> Callable[[], int]:
    """The same, in a process that is for this command only: what is imported stays, and is not searched for garbage.

    Children share it, and would copy what they search.
    """
    gc.disable()
    command = _command(arguments)
    gc.freeze()
    gc.set_threshold(ALLOCATIONS)
    gc.enable()
    return command


def _open_closed_streams() -> None:
    """Nothing is read from, and nothing written to, a standard stream with which the process was not started."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115  it stays open


def _report_missing(error: Exception) -> bool:
    """Name the command that brings a library which is not installed; False of any other error."""
    if not isinstance(error, ModuleNotFoundError):
        return False
    from ltlc.base.libraries import missing_library
    from ltlc.interfaces.commands.common import report

    found = missing_library(error, "ltlc")
    if found is not None:
        report([found])
    return found is not None


def _report_bug(error: Exception) -> None:
    """Say what went wrong in ltlc itself, and what its authors need to know; where, only if that is asked for."""
    what = f"{type(error).__name__}: {error}".partition("\n")[0]
    print(
        f"ltlc: this is a bug in ltlc {version_text()}: {what}\n"
        f"Please report it with the command, its files and what `{TRACEBACK}=1` makes it print.",
        file=sys.stderr,
    )
    if os.environ.get(TRACEBACK):
        traceback.print_exception(error)


def _give_up_stdout() -> None:
    """Let Python not try again, at its end, to write what cannot be written."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    sys.exit(main())
