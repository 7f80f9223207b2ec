"""The message types that are known: those of ROS 2 Jazzy, and what folders of definitions and bags have beside them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from ltlc.inputs.messages.definitions import BadPath, Message, MessageTypes, shipped
from ltlc.inputs.messages.folders import files_below, read_folder
from ltlc.inputs.messages.texts import defined, full_name
from ltlc.inputs.recordings import open_recording
from ltlc.inputs.recordings.bags import BagRecording
from ltlc.inputs.recordings.bags.folders import is_bag, is_flight_log, opened
from ltlc.inputs.recordings.bags.messages import PX4_MESSAGES, Topic
from ltlc.inputs.recordings.fence import fenced
from ltlc.inputs.recordings.rows import RecordingError

Declared = Callable[[], Sequence[tuple[str, str]]]
"""Gives the topics of declarations, each with the name of its type."""


def message_types(
    paths: Sequence[str] = (), recordings: Iterable[Path] = (), declared: Declared = list
) -> tuple[MessageTypes, list[BadPath]]:
    """The messages of Jazzy, those that the bags among `recordings` define, and those below `paths`; the later win.

    Also what could not be read; a recording only if a type is not known otherwise. Types that are `declared`, each
    after its topic, are looked for in all bags. What is recorded may lack constants, which are in no message: these
    stay as they are.
    """
    given, problems = given_messages(paths)
    known = shipped()
    recorded, unread = _recorded(recordings, declared, MessageTypes({**known, **given}))
    fuller = {name: _with_constants(message, known.get(name)) for name, message in recorded.items()}
    types = MessageTypes({**known, **fuller, **given})
    if unread and not all(types.find(name) for _, name in declared()):
        problems += unread
    return types, problems


def _with_constants(message: Message, other: Message | None) -> Message:
    return message if other is None else Message(message.fields, {**other.constants, **message.constants})


def given_messages(paths: Sequence[str]) -> tuple[dict[str, Message], list[BadPath]]:
    """What the folders and bags at `paths` define, of which the later win; with what could not be read."""
    messages: dict[str, Message] = {}
    problems: list[BadPath] = []
    for path in map(Path, paths):
        found, bad = _read(path)
        messages.update(found)
        problems.extend(bad)
    return messages, problems


def _read(path: Path) -> tuple[dict[str, Message], list[BadPath]]:
    return _read_bag(path) if is_bag(path) and not files_below(path) else read_folder(path)


def messages_in(topics: Iterable[Topic]) -> dict[str, Message]:
    """What the recording of these topics defines; of what is defined twice, the first; nothing that cannot be read."""
    found: dict[str, Message] = {}
    for topic in topics:
        try:
            found = defined(topic.type, topic.form, topic.definition) | found
        except ValueError:
            continue
    return {name: found[name] for name in _finite(found)}


def _finite(messages: Mapping[str, Message]) -> set[str]:
    """Those of `messages` that do not contain themselves."""
    inside = {
        name: {type_.base for type_ in message.fields.values()} & messages.keys() for name, message in messages.items()
    }
    found: set[str] = set()
    while more := {name for name, bases in inside.items() if name not in found and bases <= found}:
        found |= more
    return found


def _read_bag(path: Path, declared: Declared = list) -> tuple[dict[str, Message], list[BadPath]]:
    """What the bag at `path` defines, or why that is nothing."""
    try:
        found = messages_in(_topics_of(path, declared).values())
    except RecordingError as error:
        return {}, [BadPath(str(path), f"cannot be read: {error.diagnostic.message}")]
    return found, [] if found else [BadPath(str(path), "is a bag that defines no messages")]


def _topics_of(path: Path, declared: Declared) -> Mapping[str, Topic]:
    """What a bag says of its topics; of a flight log also under the types that these are `declared` with.

    Raises RecordingError.
    """
    if is_flight_log(path):
        types = {topic: full_name(name if "/" in name else f"{PX4_MESSAGES}/{name}") for topic, name in declared()}
        with fenced(path, "LTL811"), opened(path, types) as log:
            return log.topics
    recording = open_recording(path, {})
    assert isinstance(recording, BagRecording)
    return recording.topics


def _recorded(
    paths: Iterable[Path], declared: Declared, types: MessageTypes
) -> tuple[dict[str, Message], list[BadPath]]:
    """What the bags among `paths` define, of which the earlier win; with what cannot be read.

    The first is always looked at, the others until all types that are `declared` are known, beside those in `types`.
    """
    found: dict[str, Message] = {}
    unread: list[BadPath] = []
    names: Sequence[str] = ()
    for number, path in enumerate(filter(is_bag, paths)):
        if number:
            names = names or [name for _, name in declared()]
            known = MessageTypes({**types.messages, **found})
            if all(known.find(name) for name in names):
                break
        more, problems = _read_bag(path, declared)
        found = more | found
        unread += problems
    return found, unread
