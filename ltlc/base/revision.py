"""The commit of this ltlc: from git in a checkout, from what `hatch_build.py` wrote in a package."""

from __future__ import annotations

from pathlib import Path

from ltlc import __version__

FILE = "commit.txt"
"""The file in the package `ltlc` that has the commit; a checkout has none."""

_PACKAGE = Path(__file__).parents[1]


def version_text() -> str:
    """`1.0.0 (1f3a5c7e9b2d)`, with `, modified` where files differ from the commit; without one that is not known."""
    commit = commit_text()
    return f"{__version__} ({commit})" if commit else __version__


def commit_text() -> str:
    """`1f3a5c7e9b2d`, with `, modified` where files differ from the commit; empty if it is not known."""
    packaged = _PACKAGE / FILE
    return packaged.read_text(encoding="utf-8") if packaged.exists() else commit_of(_PACKAGE.parent)


def commit_of(checkout: Path) -> str:
    """The commit of the repository whose root is `checkout`; empty if it is not one, or git is missing or fails."""
    if not (checkout / ".git").exists():
        return ""
    import subprocess

    command = ["git", "describe", "--always", "--dirty=, modified", "--abbrev=12", "--exclude=*"]
    try:
        done = subprocess.run(command, cwd=checkout, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
