"""The server of `ltlc serve`: the page and its files by GET, answers about specifications by POST, as JSON.

Users trust the page with a text that other pages in the same browser must not reach. So a request that names another
host (a foreign name that resolves to this machine) or comes from another origin is refused.
"""

from __future__ import annotations

import json
import secrets
import select
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from ipaddress import ip_address
from socketserver import TCPServer
from tempfile import TemporaryDirectory
from typing import Any
from urllib.parse import urlsplit

from ltlc.base import codes
from ltlc.base.limits import Budget, Exceeded, run_all
from ltlc.interfaces.serve.answers import ANSWERS
from ltlc.interfaces.serve.questions import Refused
from ltlc.interfaces.serve.start import Start

OF_AN_ANSWER = Budget(30, 1024)
"""What one answer may use; what it asks of others is bounded more tightly there."""

MOST_BYTES = 2_000_000
"""Of a request that sends no file."""

MOST_OF_A_FILE = 64_000_000
"""Bytes of a file that is dropped on the page."""

MOST_AT_ONCE = 4
"""So many answers are worked on at a time; others wait."""

LONGEST_WAIT = 20.0
"""Seconds that a request waits for its turn."""

PATIENCE = 0.1
"""Seconds between two checks whether the client is still there."""

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}

_TYPES = {"html": "text/html", "css": "text/css", "js": "text/javascript"}
_ASSETS = {
    **dict.fromkeys(("page.css", "theme.js"), "ltlc.interfaces.pages"),
    **{
        each.name: "ltlc.interfaces.serve"
        for each in files("ltlc.interfaces.serve").iterdir()
        if each.name.rpartition(".")[2] in _TYPES
    },
}
"""The files of the page, and the packages that they are in."""


class Server(ThreadingHTTPServer):
    """Serves the page that begins with `start`, at `host` and `port`; 0 takes any that is free.

    If other machines can reach the host, the page is below a path that nobody can guess.
    """

    daemon_threads = True

    def __init__(self, host: str, port: int, start: Start) -> None:
        self.start = start
        self._host = host
        self.base = "/" if is_local(host) else f"/{secrets.token_urlsafe(16)}/"
        self.turns = threading.BoundedSemaphore(MOST_AT_ONCE)
        self.address_family = socket.AF_INET6 if ":" in host else socket.AF_INET
        super().__init__((host, port), Handler)

    def server_bind(self) -> None:
        """Bind to the port, without asking the network for the name of this machine as `HTTPServer` does."""
        TCPServer.server_bind(self)

    @property
    def address(self) -> str:
        """Where the page is."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        if self._host in ("0.0.0.0", "::"):
            host = socket.gethostname()
        return f"http://{host}:{self.server_address[1]}{self.base}"

    def is_own(self, name: str) -> bool:
        """Whether `name` is one of this host: nobody else can make it point here."""
        if not is_local(self._host) and (_is_number(name) or name == socket.gethostname().lower()):
            return True
        return name in (self._host.lower(), "localhost", "127.0.0.1", "::1")


def is_local(host: str) -> bool:
    """Whether only this machine reaches `host`."""
    return host == "localhost" or (_is_number(host) and ip_address(host).is_loopback)


def _is_number(host: str) -> bool:
    try:
        ip_address(host)
    except ValueError:
        return False
    return True


_HAS_LEFT: int = getattr(select, "POLLRDHUP", 0)
"""How Linux marks a connection that the other side has closed, even if there is something left to read."""


class _GoneError(Exception):
    """The client no longer waits for the answer."""


class Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: Server
    protocol_version = "HTTP/1.1"
    timeout = 60
    server_version = "ltlc"
    sys_version = ""

    def do_GET(self) -> None:
        """Send a file of the page, what it begins with, or the page of a code."""
        self._guarded(self._get)

    def do_POST(self) -> None:
        """Answer a question."""
        self._guarded(self._post)

    def log_message(self, format: str, *args: Any) -> None:
        """Requests are not logged."""

    def end_headers(self) -> None:
        """Every answer has the same headers of security."""
        for name, value in HEADERS.items():
            self.send_header(name, value)
        super().end_headers()

    def _guarded(self, respond: Callable[[str], None]) -> None:
        """Respond to requests of the page, refuse others; a client may leave at any time."""
        try:
            try:
                respond(self._own_path())
            except Refused as refused:
                self.close_connection = True  # the body, if there is one, may not have been read
                self._send(refused.status, "application/json", json.dumps({"error": str(refused)}).encode())
        except (_GoneError, ConnectionError, TimeoutError):
            self.close_connection = True
        except Exception:
            told = "this is a bug in ltlc: please report what `ltlc serve` prints"
            self._send(HTTPStatus.INTERNAL_SERVER_ERROR, "application/json", json.dumps({"error": told}).encode())
            raise

    def _own_path(self) -> str:
        """What is requested, below the path of the page. Raises Refused, also for clients without access."""
        _refuse_foreign(self.server, self.headers.get_all("Host", []), self.headers.get_all("Origin", []))
        path = self.path.partition("?")[0]
        if not path.startswith(self.server.base):
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")
        return path.removeprefix(self.server.base)

    def _get(self, name: str) -> None:
        name = name or "index.html"
        if name == "start.json":
            self._send(
                HTTPStatus.OK,
                "application/json",
                json.dumps(self.server.start.document() | {"most": MOST_OF_A_FILE}).encode(),
            )
        elif name in _ASSETS:
            content = (files(_ASSETS[name]) / name).read_bytes()
            self._send(HTTPStatus.OK, f"{_TYPES[name.rpartition('.')[2]]}; charset=utf-8", content)
        elif name.startswith("codes/") and name.removeprefix("codes/") in codes.CODES:
            text = codes.page(name.removeprefix("codes/"))
            self._send(HTTPStatus.OK, "text/plain; charset=utf-8", text.encode())
        else:
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")

    def _post(self, name: str) -> None:
        if name not in ANSWERS:
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")
        if self.headers.get_content_type() != "application/json":
            raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a question is application/json")
        with TemporaryDirectory(prefix="ltlc-") if name == "open" else nullcontext("") as folder:
            most = MOST_OF_A_FILE * 4 // 3 + MOST_BYTES if name == "open" else MOST_BYTES  # it is sent in base64
            job = partial(ANSWERS[name], self._body(most), self.server.start.message_paths, folder)
            found = self._answer(job)
        self._send(HTTPStatus.OK, "application/json", found)

    def _body(self, most: int) -> bytes:
        written = self.headers.get("Content-Length", "")
        if not (written.isascii() and written.isdigit()):
            raise Refused(HTTPStatus.LENGTH_REQUIRED, "a question needs a Content-Length")
        if len(written) > 9 or int(written) > most:
            raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"a question has at most {most} bytes")
        return self.rfile.read(int(written))

    def _answer(self, job: Callable[[], bytes]) -> bytes:
        """What `job` returns in a child, which is ended if the client leaves."""
        with self._turn():
            [outcome] = run_all([job], OF_AN_ANSWER, watch=self._stop_if_gone)
        return json.dumps({"limit": f"this {outcome}"}).encode() if isinstance(outcome, Exceeded) else outcome

    @contextmanager
    def _turn(self) -> Iterator[None]:
        """Wait until fewer than so many others are being answered."""
        end = time.monotonic() + LONGEST_WAIT
        while not self.server.turns.acquire(timeout=PATIENCE):
            self._stop_if_gone()
            if time.monotonic() > end:
                raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "too many requests at once")
        try:
            yield
        finally:
            self.server.turns.release()

    def _stop_if_gone(self, *_: int) -> None:
        """Raise an exception if the client has closed the connection, even if it sent more before."""
        poll = select.poll()
        poll.register(self.connection, select.POLLIN | _HAS_LEFT)
        seen = poll.poll(0)
        if seen and (seen[0][1] & (_HAS_LEFT | select.POLLHUP) or not self.connection.recv(1, socket.MSG_PEEK)):
            raise _GoneError

    def _send(self, status: HTTPStatus, type_: str, content: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", type_)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)


def _refuse_foreign(server: Server, hosts: list[str], origins: list[str]) -> None:
    """Raise Refused unless the request names this host, and comes from its page or from no page."""
    if len(hosts) != 1 or not server.is_own(_name(hosts[0])):
        raise Refused(HTTPStatus.FORBIDDEN, "wrong host: open the address that `ltlc serve` prints")
    if any(origin.lower() != f"http://{hosts[0]}".lower() for origin in origins):
        raise Refused(HTTPStatus.FORBIDDEN, "the request comes from another origin")


def _name(host: str) -> str:
    """The name in a `Host` header, in lower case; empty if there is none."""
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""
