"""An editor as a language server sees it: its messages over pipes, and its own idea of the text."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

PATIENCE = 300
"""Seconds after which a message will not come any more."""

URI = "file:///home/robot/props.txt"

CAPABILITIES = {
    "general": {"positionEncodings": ["utf-16"]},
    "window": {"showDocument": {"support": True}},
    "workspace": {"codeLens": {"refreshSupport": True}},
    "textDocument": {"documentSymbol": {"hierarchicalDocumentSymbolSupport": True}},
}


class Editor:
    """A client with one text at a time; the requests of the server are agreed to, and noted with its notifications."""

    def __init__(
        self, *arguments: str, capabilities: dict[str, Any] | None = None, temporary: Path | None = None
    ) -> None:
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
        if temporary is not None:
            environment["TMPDIR"] = str(temporary)
        self.process = subprocess.Popen(
            [sys.executable, "-m", "ltlc", "lsp", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
        )
        self.errors: list[bytes] = []
        self._messages: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self._kept: list[dict[str, Any]] = []
        self._version = self._last = 0
        self._threads = [threading.Thread(target=task, daemon=True) for task in (self._listen, self._collect_errors)]
        for thread in self._threads:
            thread.start()
        chosen = CAPABILITIES if capabilities is None else capabilities
        self.offered = self.request("initialize", {"processId": os.getpid(), "rootUri": None, "capabilities": chosen})
        self.notify("initialized", {})

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        for thread in self._threads:
            thread.join()
        for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
            assert pipe is not None
            pipe.close()

    def end(self) -> int:
        """Shut the server down as editors do; its exit code."""
        assert self.request("shutdown", None) is None
        self.notify("exit", None)
        return self.process.wait(PATIENCE)

    def open(self, text: str, uri: str = URI) -> None:
        """Open `text`."""
        self._version += 1
        opened = {"uri": uri, "languageId": "ltlc", "version": self._version, "text": text}
        self.notify("textDocument/didOpen", {"textDocument": opened})

    def type(self, text: str, uri: str = URI) -> None:
        """Change the text into `text`."""
        self._version += 1
        document = {"uri": uri, "version": self._version}
        self.notify("textDocument/didChange", {"textDocument": document, "contentChanges": [{"text": text}]})

    def ask(self, question: str, position: tuple[int, int] | None = None, uri: str = URI, **more: Any) -> Any:
        """The answer to a question about the text, or about a place in it."""
        params: dict[str, Any] = {"textDocument": {"uri": uri}, **more}
        if position is not None:
            params["position"] = {"line": position[0], "character": position[1]}
        return self.request(f"textDocument/{question}", params)

    def diagnostics(self, uri: str = URI) -> list[dict[str, Any]]:
        """Those that are published next for the text as it is now."""
        while True:
            params = self.next("textDocument/publishDiagnostics")["params"]
            if params["uri"] == uri and params["version"] == self._version:
                return params["diagnostics"]  # type: ignore[no-any-return]

    def request(self, method: str, params: Any) -> Any:
        """The result of a request, which must not fail."""
        answer = self.answer(method, params)
        assert "error" not in answer, answer["error"]
        return answer["result"]

    def answer(self, method: str, params: Any) -> dict[str, Any]:
        """The answer to a request, be it a result or an error."""
        self._last += 1
        self._send({"id": self._last, "method": method, "params": params})
        return self._take(lambda message: message.get("id") == self._last and "method" not in message)

    def next(self, method: str) -> dict[str, Any]:
        """The next notification, or request, of the server with this name."""
        return self._take(lambda message: message.get("method") == method)

    def notify(self, method: str, params: Any) -> None:
        """Tell the server something."""
        self._send({"method": method, "params": params})

    def raw(self, content: bytes) -> None:
        """Send bytes as the body of a message."""
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(content), content))
        self.process.stdin.flush()

    def _send(self, message: dict[str, Any]) -> None:
        self.raw(json.dumps({"jsonrpc": "2.0", **message}).encode())

    def _take(self, is_wanted: Any) -> dict[str, Any]:
        for number, message in enumerate(self._kept):
            if is_wanted(message):
                return self._kept.pop(number)
        with suppress(queue.Empty):
            while (received := self._messages.get(timeout=PATIENCE)) is not None:
                if is_wanted(received):
                    return received
                self._kept.append(received)
        raise AssertionError(f"the message does not come; of itself, the server says: {b''.join(self.errors).decode()}")

    def _listen(self) -> None:
        assert self.process.stdout is not None
        while header := self.process.stdout.readline():
            length = int(header.partition(b":")[2])
            while self.process.stdout.readline().strip():
                pass
            message = json.loads(self.process.stdout.read(length))
            self._messages.put(message)
            if "method" in message and "id" in message:
                self._send({"id": message["id"], "result": {"success": True} if "show" in message["method"] else None})
        self._messages.put(None)

    def _collect_errors(self) -> None:
        assert self.process.stderr is not None
        self.errors.extend(self.process.stderr)
