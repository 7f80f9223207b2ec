"""`ltlc serve`: a page in the browser for trying out properties."""

from __future__ import annotations

import argparse
import errno
import signal
import sys
from pathlib import Path

from ltlc.automata import SpotMissing
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source
from ltlc.frontend.language import read_source
from ltlc.interfaces.commands import arguments
from ltlc.interfaces.commands.common import OK, failure, report, unusable

WARNING = """ltlc: warning: other machines can reach this page. Whoever has its whole address can read the text that it
begins with and let this machine compute; nothing is encrypted on the way."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What `ltlc serve` takes."""
    parser.add_argument(
        "specification", metavar="PROPS", nargs="?", type=Path, help="the initial text of the page; `-` for stdin"
    )
    parser.add_argument("--port", type=_port, default=8000, help="0 for any free port (default: %(default)s)")
    parser.add_argument(
        "--host", default="127.0.0.1", help="0.0.0.0 accepts other machines (default: %(default)s, this one only)"
    )
    arguments.add_message_paths(parser)


def _port(text: str) -> int:
    if not (text.isascii() and text.isdigit() and int(text) <= 65_535):
        raise argparse.ArgumentTypeError(f"{text!r} is not a port from 0 to 65535")
    return int(text)


def _unserved(host: str, port: int, error: OSError) -> str:
    """Why a page cannot be served, and what to do about it."""
    match error.errno:
        case errno.EADDRINUSE:
            return f"another program uses port {port} of {host}: `ltlc serve --port 0` takes a free one"
        case errno.EACCES:
            return f"port {port} is for administrators: choose one from 1024 on, or `--port 0` for a free one"
        case _:
            why = error.strerror or error
            return f"port {port} of {host} cannot be served: {why}; `--host` must be an address of this machine"


def run(options: argparse.Namespace) -> int:
    """Serve the page until Ctrl-C."""
    source = Source("", "") if options.specification is None else read_source(options.specification)
    if isinstance(source, Diagnostic):
        report([source])
        return failure([source])
    try:
        from ltlc.automata import engine  # noqa: F401  once here, not in each child
    except SpotMissing as error:
        return unusable(str(error))
    from ltlc.interfaces.serve.server import Server, is_local
    from ltlc.interfaces.serve.start import Start

    start = Start(Path(source.name).name, source.text, tuple(map(str, options.msg_path)))
    try:
        server = Server(options.host, options.port, start)
    except OSError as error:
        return unusable(_unserved(options.host, options.port, error))
    # Files that are dropped on the page are removed at the end, whichever signal that comes by.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with server:
        try:
            if not is_local(options.host):
                print(WARNING, file=sys.stderr)
            print(f"ltlc: open {server.address} in a browser; press Ctrl-C to stop", flush=True)
            server.serve_forever()
        except KeyboardInterrupt:
            if not options.quiet:
                print("ltlc: ended", file=sys.stderr)
    return OK
