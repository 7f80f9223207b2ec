"""The part of SARIF 2.1.0 (OASIS, 2020) that ltlc writes, and a check against it.

Written by hand after the standard's sections 3.13 to 3.57: for each object the properties that it may have, which of
them it must have, and of what kind they are. The standard's own schema is not shipped in any package that is a
dependency; this one allows less, since nothing else is written.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

Check = Callable[[Any, str], Iterator[str]]


def kind(*types: type) -> Check:
    def check(value: Any, where: str) -> Iterator[str]:
        if not isinstance(value, types) or (isinstance(value, bool) and bool not in types):
            yield f"{where}: {value!r} is not of {types}"

    return check


def at_least(least: int) -> Check:
    def check(value: Any, where: str) -> Iterator[str]:
        if not isinstance(value, int) or isinstance(value, bool) or value < least:
            yield f"{where}: {value!r} is not an integer from {least} on"

    return check


def one_of(*values: str) -> Check:
    def check(value: Any, where: str) -> Iterator[str]:
        if value not in values:
            yield f"{where}: {value!r} is none of {values}"

    return check


def many(item: Check) -> Check:
    def check(value: Any, where: str) -> Iterator[str]:
        yield from kind(list)(value, where)
        for number, each in enumerate(value):
            yield from item(each, f"{where}[{number}]")

    return check


def record(required: dict[str, Check], optional: dict[str, Check] | None = None) -> Check:
    def check(value: Any, where: str) -> Iterator[str]:
        known = {**required, **(optional or {})}
        yield from kind(dict)(value, where)
        yield from (f"{where}: `{name}` is missing" for name in required if name not in value)
        yield from (f"{where}: `{name}` is not known" for name in value if name not in known)
        for name, inner in known.items():
            if name in value:
                yield from inner(value[name], f"{where}.{name}")

    return check


TEXT = kind(str)
LEVEL = one_of("none", "note", "warning", "error")
MESSAGE = record({"text": TEXT}, {"markdown": TEXT})
POSITION = at_least(1)
REGION = record({"startLine": POSITION}, dict.fromkeys(("startColumn", "endLine", "endColumn"), POSITION))
ARTIFACT = record({"uri": TEXT})
BAG = kind(dict)
"""A property bag: anything by name."""
PHYSICAL = record({"artifactLocation": ARTIFACT}, {"region": REGION})
LOCATION = record({"physicalLocation": PHYSICAL}, {"id": at_least(0), "message": MESSAGE})
RULE = record(
    {"id": TEXT},
    {
        "name": TEXT,
        "shortDescription": MESSAGE,
        "help": MESSAGE,
        "defaultConfiguration": record({}, {"level": LEVEL}),
    },
)
REPLACEMENT = record({"deletedRegion": REGION}, {"insertedContent": record({"text": TEXT})})
CHANGE = record({"artifactLocation": ARTIFACT, "replacements": many(REPLACEMENT)})
FIX = record({"artifactChanges": many(CHANGE)}, {"description": MESSAGE})
RESULT = record(
    {"message": MESSAGE},
    {
        "ruleId": TEXT,
        "ruleIndex": at_least(0),
        "level": LEVEL,
        "locations": many(LOCATION),
        "relatedLocations": many(LOCATION),
        "fixes": many(FIX),
        "properties": BAG,
    },
)
DRIVER = record({"name": TEXT}, {"version": TEXT, "rules": many(RULE), "properties": BAG})
READ = record({}, {"location": ARTIFACT, "hashes": record({}, {"sha-256": TEXT})})
RUN = record(
    {"tool": record({"driver": DRIVER})},
    {
        "columnKind": one_of("unicodeCodePoints", "utf16CodeUnits"),
        "artifacts": many(READ),
        "results": many(RESULT),
    },
)
LOG = record({"version": one_of("2.1.0"), "runs": many(RUN)}, {"$schema": TEXT})


def problems(log: Any) -> list[str]:
    """What in `log` is not as SARIF has it; rules must be found by their index, too."""
    found = list(LOG(log, "log"))
    for run in log["runs"]:
        rules = run["tool"]["driver"]["rules"]
        found += [f"{r['ruleId']}: wrong rule" for r in run["results"] if rules[r["ruleIndex"]]["id"] != r["ruleId"]]
    return found
