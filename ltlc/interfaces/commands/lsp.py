"""`ltlc lsp`: the language server."""

from __future__ import annotations

import argparse

from ltlc.automata import Budget
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import FINDING, OK
from ltlc.semantics.encodings import ENCODINGS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc lsp` takes."""
    parser.add_argument(
        "--stdio", action="store_true", help="accepted because many editors pass it; there is no other way"
    )
    arguments.add_reading(parser)
    arguments.add_budget(parser, "limits for the analyses of one file", 30.0)


def run(options: argparse.Namespace) -> int:
    """Serve one editor until it ends."""
    from ltlc.interfaces.editor.server import serve  # needs an extra

    paths = [str(path) for path in options.msg_path]
    return OK if serve(paths, ENCODINGS[options.encoding], Budget(*options.budget)) else FINDING
