"""What a release carries: the commit that it was made from, in a checkout and in what is built of it."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from ltlc import __version__
from ltlc.base import revision
from ltlc.base.revision import commit_of, version_text

PROJECT = Path(__file__).parents[1]
UV = Path(sys.executable).with_name("uv")


def git(folder: Path, *arguments: str) -> str:
    command = ["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout.strip()


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A repository with one commit."""
    git(tmp_path, "init", "--quiet")
    (tmp_path / "file").write_text("a\n")
    git(tmp_path, "add", "file")
    git(tmp_path, "commit", "--quiet", "--message", "first")
    return tmp_path


def test_a_checkout_has_the_commit_that_git_says(repository: Path) -> None:
    git(repository, "tag", "--annotate", "v9", "--message", "tags are not commits")
    assert commit_of(repository) == git(repository, "rev-parse", "HEAD")[:12]


def test_a_checkout_that_differs_from_its_commit_says_so(repository: Path) -> None:
    (repository / "file").write_text("b\n")
    assert commit_of(repository).endswith(", modified")


def test_a_folder_within_a_repository_is_not_its_checkout(repository: Path) -> None:
    (repository / "site-packages").mkdir()
    assert commit_of(repository / "site-packages") == ""


def test_without_git_the_commit_is_omitted(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(repository))
    monkeypatch.setattr(revision, "_PACKAGE", repository / "ltlc")
    assert version_text() == __version__


def test_a_package_says_the_commit_that_it_was_built_from(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (repository / "ltlc").mkdir()
    (repository / "ltlc" / revision.FILE).write_text("0123456789ab")
    monkeypatch.setattr(revision, "_PACKAGE", repository / "ltlc")
    assert version_text() == f"{__version__} (0123456789ab)"


def test_a_wheel_made_of_an_sdist_has_the_commit_and_the_data(tmp_path: Path) -> None:
    """`scripts/release` installs both, and tries them."""
    commit = commit_of(PROJECT)
    if not UV.exists() or not commit:
        pytest.skip("needs uv and a checkout with git")
    done = subprocess.run(
        [UV, "build", "--out-dir", tmp_path], cwd=PROJECT, capture_output=True, text=True, check=False
    )
    if done.returncode and "hatchling" in done.stderr:
        pytest.skip("hatchling, which builds packages, cannot be had here")
    assert done.returncode == 0, done.stderr
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as content:
        assert content.read(f"ltlc/{revision.FILE}").decode() == commit
        packaged = {name for name in content.namelist() if name.startswith("ltlc/")}
    tracked = git(PROJECT, "ls-files", "--cached", "--others", "--exclude-standard", "ltlc").splitlines()
    assert packaged == {*tracked, f"ltlc/{revision.FILE}"}
