"""Debian's Chromium, driven by its chromedriver over WebDriver's HTTP: no package is needed for that."""

from __future__ import annotations

import base64
import http.client
import json
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

DRIVER, BROWSER = shutil.which("chromedriver"), shutil.which("chromium")

PATIENCE = 300.0
"""How long to wait for what the browser has to do, in s: so long that only what it will never do is given up."""

MISSING = "" if DRIVER and BROWSER else "no chromium and chromedriver here (Debian: chromium chromium-driver)"

FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
)


class Browser:
    """One browser with one window."""

    def __init__(self, port: int, profile: Path) -> None:
        self._port = port
        options = {"binary": BROWSER, "args": [*FLAGS, f"--user-data-dir={profile}"]}
        wanted = {
            "goog:chromeOptions": options,
            "goog:loggingPrefs": {"browser": "ALL"},
            "timeouts": {"script": int(PATIENCE * 1000)},
        }
        self._session = ""
        session = self._call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
        self._session = f"/session/{session['sessionId']}"

    def _call(self, method: str, path: str, body: object = None) -> Any:
        connection = http.client.HTTPConnection("127.0.0.1", self._port, timeout=PATIENCE)
        connection.request(method, self._session + path, None if body is None else json.dumps(body))
        answer = json.loads(connection.getresponse().read())["value"]
        connection.close()
        assert not (isinstance(answer, dict) and "error" in answer), answer
        return answer

    def devtools(self, command: str, **parameters: object) -> Any:
        """What the command of Chromium's own protocol gives."""
        return self._call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def open(self, page: Path, width: int = 1280, scheme: str = "light") -> None:
        """Show `page` as `visit` does; wait until its timelines are drawn."""
        self.visit(page.as_uri(), width, scheme)
        self.wait_until("return !document.querySelector('.timeline') || timelines.some(each => each.isLoaded)")

    def visit(self, address: str, width: int = 1280, scheme: str = "light") -> None:
        """Show the page at `address` in a window so wide, to somebody who prefers the colour `scheme`."""
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        self.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self._call("POST", "/url", {"url": address})

    def enter(self, frame: int | None) -> None:
        """Go into the frame with this number; None goes back to the page."""
        self._call("POST", "/frame", {"id": frame})

    def run(self, script: str, *arguments: object) -> Any:
        """What `script` returns in the page."""
        return self._call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def run_until_done(self, script: str) -> Any:
        """What `script` gives to the function that is its last argument."""
        return self._call("POST", "/execute/async", {"script": script, "args": []})

    def wait_until(self, script: str) -> None:
        """Wait until `script` returns something true."""
        end, pause = time.monotonic() + PATIENCE, 0.01
        while not self.run(script):
            assert time.monotonic() < end, script
            time.sleep(pause)
            pause = min(2 * pause, 0.2)  # each question costs both processes more than what is waited for

    def act(self, *actions: dict[str, Any]) -> None:
        """What a person does with a mouse, a wheel or a keyboard."""
        self._call("POST", "/actions", {"actions": list(actions)})

    def complaints(self) -> list[str]:
        """What the console says since the last time."""
        return [entry["message"] for entry in self._call("POST", "/se/log", {"type": "browser"})]

    def picture(self) -> bytes:
        """What is to be seen, as PNG."""
        return base64.b64decode(self._call("GET", "/screenshot"))

    def close(self) -> None:
        """Close the browser."""
        self._call("DELETE", "")


@contextmanager
def browser(folder: Path) -> Iterator[Browser]:
    """A browser whose profile is in `folder`; it is closed at the end."""
    assert DRIVER is not None
    driver = subprocess.Popen(
        [DRIVER, "--port=0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )
    try:
        assert driver.stdout is not None
        port = next(
            int(line.split()[-1].rstrip(".")) for line in driver.stdout if "started successfully on port" in line
        )
        opened = Browser(port, folder / "profile")
        try:
            yield opened
        finally:
            opened.close()
    finally:
        os.killpg(driver.pid, signal.SIGKILL)  # also a browser that was not opened in time
        driver.wait()
        if driver.stdout is not None:
            driver.stdout.close()
