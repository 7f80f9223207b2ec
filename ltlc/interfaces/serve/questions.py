"""Requests of the page: a specification's text, and what to do with it, read from untrusted JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cached_property
from http import HTTPStatus
from typing import Any, TypeVar

from ltlc.base.diagnostics import Diagnostic
from ltlc.base.errors import UnusableInput
from ltlc.base.source import Source
from ltlc.dataclass import dataclass
from ltlc.frontend.language import load_text
from ltlc.interfaces.api.prepare import NAME, encoding_of
from ltlc.semantics.encodings import Encoding
from ltlc.specification.specification import PropertySpecification, Specification

MOST_STEPS = 2_000
"""Of a run that is edited."""

Wanted = TypeVar("Wanted")


class Refused(Exception):  # noqa: N818  an answer, too
    """A request that is not answered, and why; the `status` of HTTP is OK where nothing is wrong with the request."""

    def __init__(self, status: HTTPStatus, reason: str) -> None:
        super().__init__(status, reason)
        self.status = status
        self.reason = reason

    def __str__(self) -> str:
        return self.reason


@dataclass(frozen=True)
class Question:
    """The text of a specification, an encoding, and what else was `asked`; reading any of it may raise Refused.

    `folder` is where a file that is sent may be written to.
    """

    asked: dict[str, Any]
    message_paths: Sequence[str]
    folder: str = ""

    @property
    def encoding(self) -> Encoding:
        """How scopes are read; `episode` by default."""
        try:
            return encoding_of(self._get("encoding", str, "episode"))
        except UnusableInput as error:
            raise bad(str(error)) from None

    @property
    def analyses(self) -> bool:
        """Whether the analyses are asked for, besides what is reported at once."""
        return self._get("analyses", bool, False)

    @property
    def steps(self) -> list[dict[str, Any]]:
        """The run: an object for each step, with `time` in s, and the signals that have a sample."""
        steps = self._get("steps", list, [])
        if len(steps) > MOST_STEPS:
            raise bad(f"a run has at most {MOST_STEPS} steps here: use `ltlc run` for longer ones")
        if not all(isinstance(step, dict) for step in steps):
            raise bad("`steps` are objects")
        return steps

    @property
    def at(self) -> int:
        """The step up to which the run is shown in detail; the last by default."""
        return self._get("at", int, MOST_STEPS)

    @property
    def file(self) -> str:
        """The name of a file that is sent."""
        return self._get("file", str, "")

    @property
    def content(self) -> str:
        """Its bytes, in base64."""
        return self._get("content", str, "")

    @property
    def source(self) -> Source:
        """The text of the specification."""
        return Source(NAME, self._get("text", str, ""))

    @cached_property
    def loaded(self) -> tuple[Specification | None, list[Diagnostic]]:
        """The specification, None if it has errors, and all that the front end says about it."""
        return load_text(self.source, self.message_paths, self.encoding)

    @property
    def specification(self) -> Specification:
        """The specification, which must have no errors."""
        specification, _ = self.loaded
        if specification is None:
            raise with_errors()
        return specification

    @property
    def chosen(self) -> PropertySpecification:
        """The property that is asked about."""
        return self.specification.properties[self.number]

    @property
    def number(self) -> int:
        """Which property is asked about, from 0."""
        number, count = self._get("property", int, 0), len(self.specification.properties)
        if not 0 <= number < count:
            raise bad(f"there is no property {number}: there are {count}")
        return number

    def _get(self, name: str, wanted: type[Wanted], otherwise: Wanted) -> Wanted:
        value = self.asked.get(name)
        if value is None:
            return otherwise
        if type(value) is not wanted:
            raise bad(f"`{name}` is not {_KINDS[wanted]}")
        return value


_KINDS: dict[type[Any], str] = {str: "a string", bool: "true or false", int: "a whole number", list: "an array"}


def read_question(body: bytes, message_paths: Sequence[str], folder: str = "") -> Question:
    """The question that `body` is. Raises Refused."""
    try:
        asked = json.loads(body)
    except ValueError as error:
        raise bad(f"not JSON: {error}") from None
    if not isinstance(asked, dict):
        raise bad("a question is an object")
    return Question(asked, message_paths, folder)


def with_errors() -> Refused:
    """The refusal where a specification without errors is needed."""
    return Refused(HTTPStatus.OK, "the specification has errors")


def bad(reason: str) -> Refused:
    """The refusal of a request that makes no sense."""
    return Refused(HTTPStatus.BAD_REQUEST, reason)
