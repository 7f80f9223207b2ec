"""The rules that are about some recordings: those whose messages are in them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.source import Source
from ltlc.frontend.language import read, types_for
from ltlc.frontend.layout import layout
from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.inputs.recordings import RecordingError, open_recording
from ltlc.inputs.recordings.bags import BagRecording
from ltlc.rules import Rule, UnknownRuleError, pack
from ltlc.specification.specification import fields

MOST = 100
"""So many recordings are looked into: what is in none of them is taken to be in none at all."""


def specification(
    name: str, message_paths: Sequence[str], recordings: Sequence[Path]
) -> tuple[Source | Diagnostic, list[Diagnostic]]:
    """The rules called `name`, such as `@px4`, as a specification, and a note about those that cannot be checked.

    With `recordings`, those are left out that read messages or fields which none of them has.
    """
    source = Source(name, "")
    try:
        found = pack(name[1:])
    except UnknownRuleError as error:
        return diagnostic("LTL901", source, None, f"there are no rules `{name}`", help=str(error)), []
    whys: dict[str, str] = {}
    if recordings:
        types, _ = types_for(Source(name, found.text()), message_paths, recordings)
        topics = _topics(recordings)
        whys = {rule.name: why for rule in found.rules if (why := _reason(rule, types, topics))}
    notes = []
    if whys:
        listed = "; ".join(f"`{rule}`, {why}" for rule, why in whys.items())
        notes = [diagnostic("LTL852", source, None, f"rules that were not checked: {listed}")]
    chosen = [rule for rule in found.rules if rule.name not in whys]
    if not chosen:
        return diagnostic("LTL901", source, None, f"none of the rules `{name}` is about this"), notes
    text = layout(Source(name, found.text(chosen)))
    assert isinstance(text, str)
    return Source(f"@{found.name}", text), notes


def _reason(rule: Rule, types: MessageTypes, topics: set[str] | None) -> str:
    """Why a rule cannot be checked; nothing if it can."""
    found = read(Source(rule.name, rule.text), types)
    error = next((each for each in found.diagnostics if each.severity is Severity.ERROR), None)
    if error is not None:
        return error.message
    signals = (signal for of in found.sound.properties for signal in of.signals())
    wanted = (field.topic for signal in signals for _, field in fields(signal))
    missing = [] if topics is None else [topic for topic in wanted if topic not in topics]
    return f"no message on `{missing[0]}`" if missing else ""


def _topics(paths: Sequence[Path]) -> set[str] | None:
    """The topics on which some of the recordings have messages; None if one of them may have any."""
    found: set[str] = set()
    for path in paths[:MOST]:
        try:
            recording = open_recording(path, {})
        except RecordingError:
            continue  # it is reported when it is judged
        if not isinstance(recording, BagRecording):
            return None
        found.update(name for name, topic in recording.topics.items() if topic.count != 0)
    return found
