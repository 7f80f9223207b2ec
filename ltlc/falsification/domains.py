"""ROS domains for simulations that run at the same time, so that their nodes do not meet."""

from __future__ import annotations

import fcntl
import socket
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

DOMAINS = range(1, 101)
"""Those whose ports no system gives to others; 0 is where robots are that nobody has put elsewhere."""

PORTS = 60
"""How many ports of a domain are looked at: that of discovery, and two kinds for each of 25 participants."""


@contextmanager
def free_domains(count: int) -> Iterator[list[int]]:
    """At most so many domains that nothing on this machine uses, and no other caller gets meanwhile."""
    with ExitStack() as claims:
        found: list[int] = []
        for domain in DOMAINS:
            if len(found) == count:
                break
            if _is_claimed(domain, claims) and all(_is_free(7400 + 250 * domain + port) for port in range(PORTS)):
                found.append(domain)
        yield found


def _is_claimed(domain: int, claims: ExitStack) -> bool:
    """Lock the file for `domain`, for as long as `claims` lasts, unless someone else has."""
    try:
        lock = claims.enter_context((Path(tempfile.gettempdir()) / f"ltlc-ros-domain-{domain}").open("w"))
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:  # taken, or the file of another user
        return False
    return True


def _is_free(port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("", port))
        except OSError:
            return False
    return True
