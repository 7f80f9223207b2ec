"""`ltlc.check`: finds mistakes in a specification before it ever runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from os import PathLike
from typing import Any

from ltlc.analysis.examine import Examined, examine
from ltlc.analysis.subjects import Subject
from ltlc.base.diagnostics import Diagnostic, Severity
from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget
from ltlc.base.nearest import did_you_mean
from ltlc.base.provenance import provenance
from ltlc.base.render import full
from ltlc.base.render import json as render_json
from ltlc.base.source import Source, Span
from ltlc.dataclass import dataclass
from ltlc.interfaces.api.prepare import Text, encoding_of, folders, read
from ltlc.specification.requirements import Requirement
from ltlc.specification.specification import topics

SECONDS = 30.0
"""The default limits of all analyses together."""


@dataclass(frozen=True, slots=True)
class PropertyCheck:
    """What a property can do: whether some run satisfies it and some violates it, None where that was not decided.

    Its monitor has so many `states`, None if it was too hard to make. It may state a `requirement`.
    """

    file: str
    label: str
    line: int
    text: str
    can_hold: bool | None
    can_fail: bool | None
    states: int | None
    requirement: Requirement | None = None

    @property
    def summary(self) -> str:
        """What it can do, in words."""
        if self.can_hold is None:
            return "not decided whether it can hold or fail"
        if not self.can_hold:
            return "cannot hold"
        return "can hold, can fail" if self.can_fail else "cannot fail"

    def __str__(self) -> str:
        return f"{self.label}: {self.summary}"

    def document(self) -> dict[str, Any]:
        """The property as an object of JSON."""
        document = {field.name: getattr(self, field.name) for field in fields(self) if field.name != "requirement"}
        return document | ({"requirement": self.requirement.document()} if self.requirement else {})


def property_check(subject: Subject, file: str) -> PropertyCheck:
    """What is known of a property of a file that was analysed."""
    of, is_known = subject.specification, subject.monitor is not None
    return PropertyCheck(
        file,
        of.label,
        of.line,
        of.text,
        not subject.never_holds if is_known else None,
        not subject.always_holds if is_known else None,
        len(subject.monitor.verdicts) if subject.monitor is not None else None,
        of.requirement,
    )


@dataclass(frozen=True)
class Check:
    """What was found: `diagnostics` in the order of the text, and what each of the `properties` can do.

    If the text has errors of form, there are no properties. The `sources` are the specifications that could be read.
    """

    diagnostics: tuple[Diagnostic, ...]
    properties: tuple[PropertyCheck, ...]
    sources: tuple[Source, ...] = ()

    @property
    def has_errors(self) -> bool:
        """Whether one of the diagnostics is an error."""
        return any(each.severity is Severity.ERROR for each in self.diagnostics)

    def requirement_of(self, found: Diagnostic) -> Mapping[str, Any]:
        """The requirement of the property in whose text `found` is, as an object of JSON; empty if there is none."""
        for each in self.properties:
            stated, place = each.requirement, found.primary
            if stated and place and each.file == found.source.name and _is_within(place.span, stated.span):
                return stated.document()
        return {}

    def __add__(self, other: Check) -> Check:
        diagnostics, properties = self.diagnostics + other.diagnostics, self.properties + other.properties
        return Check(diagnostics, properties, self.sources + other.sources)

    def __str__(self) -> str:
        lines = "".join(f"{each}\n" for each in self.properties)
        return (full.render(self.diagnostics) + lines).rstrip()

    __repr__ = __str__

    def _repr_html_(self) -> str:
        from ltlc.interfaces.api.display import check_html

        return check_html(self.properties, self.diagnostics)

    def document(self) -> dict[str, Any]:
        """What `ltlc check --format json` prints."""
        properties = [each.document() for each in self.properties]
        return {
            "properties": properties,
            "diagnostics": render_json.documents(self.diagnostics),
            "provenance": provenance(self.sources),
        }


def _is_within(inner: Span, outer: Span) -> bool:
    return outer.start <= inner.start and inner.end <= outer.end


def check_of(examined: Examined, read: Source | Diagnostic) -> Check:
    """What was found about a specification, of which so much was `read`."""
    file = examined.specification.source.name if examined.specification else ""
    properties = tuple(property_check(each, file) for each in examined.subjects)
    return Check(tuple(examined.diagnostics), properties, () if isinstance(read, Diagnostic) else (read,))


def unread_topic(examined: Examined, controls: Sequence[str]) -> str:
    """That no property reads one of the topics `controls`, in words; empty if each is read, or nothing could be."""
    read = {topic for subject in examined.subjects for topic in topics(subject.specification)}
    unread = next((topic for topic in controls if topic not in read), None)
    if unread is None or examined.specification is None:
        return ""
    hint = did_you_mean(unread, read)
    return f"no property reads `{unread}`{f'; {hint}' if hint else ''}"


def check(
    specification: Text,
    *,
    encoding: str = "episode",
    pedantic: bool = False,
    controls: Sequence[str] = (),
    message_paths: Sequence[str | PathLike[str]] = (),
    budget: Budget | None = None,
) -> Check:
    """What is wrong with `specification`, and what its properties can do.

    >>> import ltlc
    >>> found = ltlc.check("slow: never robot.velocity >= 0")
    >>> [(each.code, each.name, each.severity.value) for each in found.diagnostics]
    [('LTL501', 'unsatisfiable', 'error')]
    >>> found.properties[0].can_hold
    False
    >>> print(ltlc.check("slow: never robot.velocty > 2"))
    error[LTL105]: `robot` has no `velocty`: it is neither declared nor a primitive
     --> specification:1:19
      |
    1 | slow: never robot.velocty > 2
      |                   ^^^^^^^
      = help: did you mean `velocity`?

    A `str` is the text of a specification, a `pathlib.Path` a file. If `pedantic`, also what is opinion rather than
    fault is said. With the topics `controls`, also whether a controller that sends on them can keep the properties.
    `budget` is what all analyses together may use. Nothing is raised for what is wrong with the text or the file, which
    is what is asked for; UnusableInput for an encoding that is not known and a topic that no property reads, and
    SpotMissing.
    """
    paths, budget_, source = folders(message_paths), budget or Budget(SECONDS), read(specification)
    topics_ = tuple(dict.fromkeys([controls] if isinstance(controls, str) else controls))
    examined = examine(source, paths, encoding_of(encoding), budget_, pedantic=pedantic, controls=topics_)
    if unread := unread_topic(examined, topics_):
        raise UnusableInput((), unread)
    return check_of(examined, source)
