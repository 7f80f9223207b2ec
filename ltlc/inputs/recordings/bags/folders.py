"""The files of a bag: which there are, what `metadata.yaml` says about them, and those compressed as a whole."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from errno import ENOSPC
from pathlib import Path, PurePosixPath
from shutil import disk_usage
from tempfile import TemporaryDirectory
from typing import Any

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.bags.messages import Storage
from ltlc.inputs.recordings.rows import RecordingError, failure

METADATA = "metadata.yaml"
_PACKED = ".zstd"
_STORAGES = (".mcap", ".db3")
_ALONE = (".bag", ".ulg")
_NUMBER = re.compile(r"\d+")


@dataclass(frozen=True)
class Bag:
    """The files of a bag in their order, how many messages there are on each topic, if that is said, and remarks.

    It was recorded with the `distribution` of ROS 2, as in `humble`; empty if that is not said.
    """

    files: tuple[Path, ...]
    counts: Mapping[str, int] | None
    remarks: tuple[Diagnostic, ...] = ()
    distribution: str = ""


def is_bag(path: Path) -> bool:
    """Whether `path` is one, by its name and by what is in it if it is a folder."""
    if path.is_dir():
        return (path / METADATA).is_file() or (os.access(path, os.R_OK) and bool(_storage_files(path)))
    return _kind(path) in (*_STORAGES, *_ALONE)


def is_flight_log(path: Path) -> bool:
    """Whether a file is one of PX4's, by its name."""
    return _kind(path) == ".ulg"


def is_packed(path: Path) -> bool:
    """Whether a file is compressed as a whole."""
    return path.suffix.lower() == _PACKED


def bag_at(path: Path) -> Bag:
    """The bag at `path`, a folder or a file. Raises RecordingError."""
    if not path.is_dir():
        return Bag((path,), None)
    if (path / METADATA).is_file():
        return _described(path)
    files = _storage_files(path)
    message = (
        f"`{path}` has no {METADATA}: its files are read in order of their numbers, and messages cannot be counted"
    )
    help = "a killed recorder leaves none; `ros2 bag reindex` makes one"
    return Bag(tuple(files), None, (diagnostic("LTL813", Source(str(path), ""), None, message, help=help),))


def _kind(path: Path) -> str:
    return Path(path.stem if is_packed(path) else path.name).suffix.lower()


def _storage_files(folder: Path) -> list[Path]:
    """The files in `folder` that have messages; `_10` comes after `_9`."""
    found = [file for file in folder.iterdir() if _kind(file) in _STORAGES and file.is_file()]
    return sorted(found, key=lambda file: ([int(number) for number in _NUMBER.findall(file.name)], file.name))


def _described(folder: Path) -> Bag:
    """A bag as its metadata has it. Raises RecordingError."""
    try:
        metadata = _metadata(folder / METADATA)
        names = [PurePosixPath(str(name)).name for name in metadata["relative_file_paths"]]
        topics = [(each["topic_metadata"]["name"], each["message_count"]) for each in _topics(metadata)]
        counts = {str(name): int(count) for name, count in topics}
        distribution = str(metadata.get("ros_distro") or "").lower()
    except (KeyError, TypeError, ValueError) as error:
        raise _unusable(folder, f"`{folder / METADATA}` is not in the format of rosbag2: {_reason(error)}") from None
    missing = [name for name in names if not (folder / name).is_file()]
    if missing:
        raise _unusable(folder, f"`{folder / METADATA}` lists `{missing[0]}`, which does not exist")
    others = [file.name for file in _storage_files(folder) if file.name not in names]
    remarks = tuple(_unread(folder, name) for name in others)
    return Bag(tuple(folder / name for name in names), counts, remarks, distribution)


def _topics(metadata: Mapping[str, Any]) -> list[Any]:
    """The first editions had a topic for each file that it is in."""
    topics = metadata["topics_with_message_count"]
    return topics if isinstance(topics, list) else []


def _metadata(path: Path) -> Mapping[str, Any]:
    """Raises RecordingError, KeyError, TypeError and ValueError."""
    import yaml

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        document = yaml.load(path.read_text(encoding="utf-8"), Loader=loader)
    except OSError as error:
        raise failure("LTL902", path, f"`{path}` cannot be read: {error.strerror}") from None
    except yaml.YAMLError as error:
        raise ValueError(str(error).partition("\n")[0]) from None
    metadata: Mapping[str, Any] = document["rosbag2_bagfile_information"]
    return metadata


def _reason(error: Exception) -> str:
    return f"there is no {error}" if isinstance(error, KeyError) else str(error)


def _unusable(folder: Path, message: str) -> RecordingError:
    return failure("LTL810", folder, message, "`ros2 bag reindex` rebuilds the metadata of a bag from its files")


def _unread(folder: Path, name: str) -> Diagnostic:
    message = f"`{folder / name}` was not read: {METADATA} does not list it"
    return diagnostic("LTL813", Source(str(folder), ""), None, message, help="`ros2 bag reindex` adds it")


@contextmanager
def opened(path: Path, wanted: Mapping[str, str]) -> Iterator[Storage]:
    """The storage at `path`, from which messages are wanted, by topic with their types. Raises RecordingError.

    One that is compressed lies in a temporary folder meanwhile.
    """
    with unpacked(path) as plain:
        yield _storage(plain, wanted)


@contextmanager
def unpacked(path: Path) -> Iterator[Path]:
    """The file at `path`; of one that is compressed, one in a temporary folder that is not. Raises RecordingError."""
    if not is_packed(path):
        yield path
        return
    with TemporaryDirectory(prefix="ltlc-") as folder:
        plain = Path(folder) / path.stem
        _unpack(path, plain)
        yield plain


def _unpack(path: Path, target: Path) -> None:
    import zstandard

    try:
        most = disk_usage(target.parent).free // 2
        with path.open("rb") as packed, target.open("wb") as unpacked:
            for data in zstandard.ZstdDecompressor().read_to_iter(packed):
                unpacked.write(data)
                if unpacked.tell() > most:
                    raise OSError(ENOSPC, os.strerror(ENOSPC))
    except zstandard.ZstdError as error:
        raise failure("LTL811", path, f"`{path}` cannot be decompressed: {error}") from None
    except OSError as error:
        raise failure("LTL902", path, f"`{path}` cannot be decompressed: {error.strerror}") from None


def _storage(path: Path, wanted: Mapping[str, str]) -> Storage:
    match path.suffix.lower():
        case ".mcap":
            from ltlc.inputs.recordings.bags.mcap import McapStorage

            return McapStorage(path)
        case ".db3":
            from ltlc.inputs.recordings.bags.sqlite import SqliteStorage

            return SqliteStorage(path)
        case ".ulg":
            from ltlc.inputs.recordings.bags.ulog import ULogStorage

            return ULogStorage(path, wanted)
        case _:
            pass
    from ltlc.inputs.recordings.bags.ros1 import Ros1Storage

    return Ros1Storage(path)
