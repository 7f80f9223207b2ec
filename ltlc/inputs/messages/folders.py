"""Definitions of messages, services and actions as ROS packages have them: `.msg`, `.srv` and `.action` files."""

from __future__ import annotations

from pathlib import Path

from ltlc.inputs.messages.definitions import BadPath, Message
from ltlc.inputs.messages.texts import PARTS, interface


def read_folder(folder: Path) -> tuple[dict[str, Message], list[BadPath]]:
    """The messages below a folder: packages in it, a package itself, or loose files; with what could not be read."""
    if not folder.is_dir():
        reason = "is neither a folder nor a bag" if folder.exists() else "does not exist"
        return {}, [BadPath(str(folder), reason)]
    files = files_below(folder)
    if not files:
        return {}, [BadPath(str(folder), "contains no .msg, .srv or .action file")]
    messages: dict[str, Message] = {}
    problems: list[BadPath] = []
    for file in files:
        try:
            messages.update(_read_file(file, _package(file, folder)))
        except (OSError, ValueError) as error:
            problems.append(BadPath(str(file), str(error)))
    return messages, problems


def files_below(folder: Path) -> list[Path]:
    """The files of definitions in `folder` and the folders in it."""
    return sorted(file for suffix in PARTS for file in folder.rglob(f"*{suffix}"))


def _package(file: Path, folder: Path) -> str:
    """The package of a file: the folder with `package.xml` or around `msg/`, else that of the loose file."""
    for parent in file.parents:
        if (parent / "package.xml").is_file():
            return parent.name
        if parent == folder.parent:
            break
    home = file.parent.parent if file.parent.name == file.suffix[1:] else file.parent
    return home.resolve().name


def _read_file(file: Path, package: str) -> dict[str, Message]:
    """The messages that `file` defines. Raises ValueError if it is not a definition."""
    try:
        text = file.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise ValueError("is not UTF-8") from None
    try:
        return interface(f"{package}/{file.suffix[1:]}/{file.stem}", text)
    except ValueError as error:
        raise ValueError(f"is not a message definition: {error}") from None
