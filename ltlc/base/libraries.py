"""What ltlc uses where it is installed: the extras of the package, and what to type where one is missing."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source

EXTRAS = {
    "recordings": ("isal", "lz4", "mcap", "pyarrow", "rosbags", "zstandard"),
    "campaigns": ("dask", "distributed", "fsspec"),
    "falsify": ("cma",),
    "editor": ("lsprotocol", "pygls"),
}
"""The modules that an extra of the package brings, by its name."""


@cache
def is_installed(module: str) -> bool:
    """Whether `module` could be imported; it is not."""
    return find_spec(module) is not None


def missing_library(error: ModuleNotFoundError, where: str) -> Diagnostic | None:
    """The diagnostic that names the command which brings what is missing; None of what is in no extra.

    `where` is the recording or the command that needs it.
    """
    module = (error.name or "").partition(".")[0]
    extra = next((name for name, modules in EXTRAS.items() if module in modules), None)
    if extra is None:
        return None
    message = f"this needs `{module}`, which is not installed: run `{command(extra)}`"
    return diagnostic("LTL808", Source(where, ""), None, message)


def command(extra: str) -> str:
    """What brings an extra."""
    return f"pip install 'ltlc[{extra}]'"
