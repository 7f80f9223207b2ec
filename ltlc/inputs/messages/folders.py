"""Definitions of messages, services and actions as ROS packages have them: `.msg`, `.srv` and `.action` files.

The only importer of rosbags here.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rosbags.typesys import TypesysError, get_types_from_msg  # noqa: TID251

from ltlc.inputs.messages.definitions import BadPath, Constant, FieldType, Message
from ltlc.specification.wire import double_or_integer

_PARTS = {".msg": ("",), ".srv": ("_Request", "_Response"), ".action": ("_Goal", "_Result", "_Feedback")}
"""What the sections of a file define, by the end of its name; lines of three dashes stand between them."""

_UUID, _TIME = FieldType("unique_identifier_msgs/msg/UUID"), FieldType("builtin_interfaces/msg/Time")
_EVENT_INFO = FieldType("service_msgs/msg/ServiceEventInfo")


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
    return sorted(file for suffix in _PARTS for file in folder.rglob(f"*{suffix}"))


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
    return interface(f"{package}/{file.suffix[1:]}/{file.stem}", text)


def interface(name: str, text: str) -> dict[str, Message]:
    """The messages that a message, service or action is made of. Raises ValueError if `text` does not define it.

    `name` is full, as in `std_srvs/srv/SetBool`.
    """
    package, kind, short = name.split("/")
    parts, sections = _PARTS[f".{kind}"], _sections(text)
    if len(sections) != len(parts):
        raise ValueError(f"has {len(sections)} sections separated by ---, but needs {len(parts)}")
    try:
        found = {
            f"{name}{part}": _defined(f"{package}/msg/{short}{part}", section)
            for part, section in zip(parts, sections, strict=True)
        }
    except TypesysError as error:
        raise ValueError(f"is not a message definition: {error}") from None
    return found | {"msg": {}, "srv": _event(name), "action": _of_action(name)}[kind]


def _sections(text: str) -> list[str]:
    sections = [""]
    for line in text.splitlines():
        if line.rstrip() == "---":
            sections.append("")
        else:
            sections[-1] += f"{line}\n"
    return sections


def _defined(name: str, text: str) -> Message:
    (definition,) = get_types_from_msg(text, name).values()
    return from_rosbags(definition)


def _event(service: str) -> dict[str, Message]:
    """What the introspection of a service publishes on `…/_service_event`."""
    request, response = FieldType(f"{service}_Request", 0), FieldType(f"{service}_Response", 0)
    return {f"{service}_Event": Message({"info": _EVENT_INFO, "request": request, "response": response}, {})}


def _of_action(action: str) -> dict[str, Message]:
    """What an action publishes beside its status, and the two services that it is made of."""
    send, get = f"{action}_SendGoal", f"{action}_GetResult"
    fields = {
        f"{action}_FeedbackMessage": {"goal_id": _UUID, "feedback": FieldType(f"{action}_Feedback")},
        f"{send}_Request": {"goal_id": _UUID, "goal": FieldType(f"{action}_Goal")},
        f"{send}_Response": {"accepted": FieldType("bool"), "stamp": _TIME},
        f"{get}_Request": {"goal_id": _UUID},
        f"{get}_Response": {"status": FieldType("int8"), "result": FieldType(f"{action}_Result")},
    }
    return {name: Message(parts, {}) for name, parts in fields.items()} | _event(send) | _event(get)


def from_rosbags(definition: Any) -> Message:
    """A message from its constants and fields as rosbags has them."""
    constants, fields = definition
    return Message(
        {name: _field_type(description) for name, description in fields},
        {name: _constant(value) for name, _, value in constants},
    )


def _constant(value: Constant) -> Constant:
    return double_or_integer(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _field_type(description: Any) -> FieldType:
    """A field's type from rosbags' description: (kind, content), the kinds being base, name, array and sequence."""
    kind, content = description
    match kind.name:
        case "BASE":
            return FieldType(content[0])
        case "NAME":
            return FieldType(content)
        case "ARRAY":
            return FieldType(_field_type(content[0]).base, content[1])
        case _:
            return FieldType(_field_type(content[0]).base, 0)
