"""The requirement that a property states: text and attributes, which have no effect on a monitor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ltlc.base.source import Span
from ltlc.dataclass import dataclass

KNOWN = {
    "id": "the requirement's own id, unique across the files that are checked together",
    "verifies": "the ids of the requirements it is derived from",
    "severity": "how bad a violation is",
    "rationale": "why it is required",
    "owner": "who is responsible for it",
    "status": "its status",
}
"""The attributes that are known by name, and what each means; there may be others."""


@dataclass(frozen=True, slots=True)
class Requirement:
    """The `text` of a requirement, on one line, and its `attributes`; `span` is the place of all of the property."""

    text: str
    attributes: Mapping[str, tuple[str, ...]]
    span: Span

    @property
    def id(self) -> str | None:
        """Its id, if it has one."""
        return self.attributes["id"][0] if "id" in self.attributes else None

    def document(self) -> dict[str, Any]:
        """The requirement as an object of JSON."""
        attributes = {key: list(values) for key, values in self.attributes.items()}
        return {"id": self.id, "text": self.text, "attributes": attributes}
