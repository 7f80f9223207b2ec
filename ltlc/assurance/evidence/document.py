"""The document of evidence, version 2: what was judged, by what, and for each property its letters and its verdict.

One item a line, in one order; `docs/evidence.md` describes them. What is read is written again as the same bytes, or is
refused, and the last line has the SHA-256 of all before it: no byte can be changed unnoticed.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

from ltlc.base.provenance import FileDigest
from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict

HEADER = "ltlc-evidence 2"
END = "end sha256 "

Data = dict[str, object]
"""The condition of an atom, as JSON has it; see `conditions`."""


class Line(NamedTuple):
    """From `time` on, the `atoms` with these numbers hold, ascending; those that are news at that instant only."""

    time: Nanoseconds
    atoms: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Summed:
    """What stands in the place of many lines: how many there are, and the SHA-256 of their text."""

    count: int
    sha256: str


class StatedAtom(NamedTuple):
    """An atom by its name in the certificate, and what it is."""

    name: str
    condition: Data


class StatedCount(NamedTuple):
    """A count by its name in the certificate, and what is counted; see `counting`."""

    name: str
    said: str


class StatedScope(NamedTuple):
    """A scope at whose opening values are taken, by its number in the property of the certificate.

    It is open from one step up to another one, which are counted from 0; the last time perhaps to the end.
    """

    number: int
    open: tuple[tuple[int, int | None], ...]

    @property
    def said(self) -> str:
        """As documents have it."""
        spans = (f" {first}-{'' if end is None else end}" for first, end in self.open)
        return f"{self.number}{''.join(spans)}"


@dataclass(frozen=True, slots=True)
class StatedSlice:
    """What was judged of one id, which is written as JSON: as of a claim its letters, up to when, and the verdict."""

    id: str
    letters: tuple[Line, ...] | Summed
    until: Nanoseconds
    verdict: Verdict
    decided: Nanoseconds


class StatedSignal(NamedTuple):
    """A signal that a table may have a column of: the type of its values as ROS 2 has it, and what it is otherwise."""

    name: str
    type: str
    definition: Data


@dataclass(frozen=True, slots=True)
class Head:
    """What was judged, and by what.

    `version` is that of ltlc, with its commit. `specification` and `certificates` are digests, the former with the name
    of the file. `recordings` are all files of the recording, their names relative to the folder that it is in.
    `definitions` are the types of messages that were read, with the SHA-256 of their `definition_text`. Of the times
    that the recording was judged at and between, None is the default; `rate` is in Hz, as Python writes it. Of a table,
    `signals` are all that its columns may be.
    """

    version: str
    specification: tuple[str, str]
    certificates: str
    recordings: tuple[FileDigest, ...]
    definitions: tuple[tuple[str, str], ...] = ()
    rate: str | None = None
    timeout: Nanoseconds | None = None
    is_by_header: bool = False
    since: Nanoseconds | None = None
    until: Nanoseconds | None = None
    signals: tuple[StatedSignal, ...] = ()

    @property
    def recording(self) -> str:
        """What the recording is called: its folder, or its only file."""
        return self.recordings[0].name.partition("/")[0]


@dataclass(frozen=True, slots=True)
class Claim:
    """The verdict of one property, and the letters that it follows from.

    What is counted follows from the letters. Behind the atoms, these have one for each of the `scopes`, which says that
    it is open. Where the atom with the number `opens` holds, an instance of the property opens. With a `key`, a field,
    there are letters of `slices` only, in the order of their first messages. Ages count from `session` until a message
    comes. The run was looked at up to `until`: the moment of the decision, or the end of the recording. The verdict was
    right from `decided` on.
    """

    label: str
    text: str
    atoms: tuple[StatedAtom, ...]
    session: Nanoseconds
    letters: tuple[Line, ...] | Summed
    until: Nanoseconds
    verdict: Verdict
    decided: Nanoseconds
    requirement: str | None = None
    verifies: tuple[str, ...] = ()
    counts: tuple[StatedCount, ...] = ()
    scopes: tuple[StatedScope, ...] = ()
    opens: int | None = None
    key: Data | None = None
    slices: tuple[StatedSlice, ...] = ()

    def of_slice(self, slice_: StatedSlice) -> Claim:
        """The claim about one slice alone."""
        return replace(
            self,
            key=None,
            slices=(),
            letters=slice_.letters,
            until=slice_.until,
            verdict=slice_.verdict,
            decided=slice_.decided,
        )


@dataclass(frozen=True, slots=True)
class NotCovered:
    """Nothing is claimed of the property called `label`, for a reason."""

    label: str
    reason: str


@dataclass(frozen=True, slots=True)
class Document:
    """What one recording has shown of each property of a specification, in their order."""

    head: Head
    properties: tuple[Claim | NotCovered, ...]


def printed(document: Document) -> str:
    """The text of `document`. Raises ValueError if a name or a number does not fit in."""
    lines = [*_head_lines(document.head)]
    for each in document.properties:
        lines += [
            "",
            *(_claim_lines(each) if isinstance(each, Claim) else [f"not-covered {each.label}: {each.reason}"]),
        ]
    text = "".join(f"{line}\n" for line in lines)
    if any(not _TEXT.fullmatch(line) for line in lines if line):
        raise ValueError("a name that does not fit on a line")
    return f"{text}{END}{digest(text)}\n"


def digest(text: str) -> str:
    """The SHA-256 of a text in UTF-8, in hexadecimal."""
    return hashlib.sha256(text.encode()).hexdigest()


def condition_text(condition: Data) -> str:
    """The condition of an atom, as documents have it. Raises ValueError for a number that JSON does not have."""
    return json.dumps(condition, ensure_ascii=True, allow_nan=False, separators=(",", ":"))


def letters_text(lines: Iterable[Line]) -> Iterator[str]:
    """The lines of letters as they are written, each with its end."""
    before: Nanoseconds | None = None
    for time, atoms in lines:
        held = "".join(f" a{number}" for number in atoms)
        yield f"at {time}{held}\n" if before is None else f"+{time - before}{held}\n"
        before = time


def summed(lines: Iterable[Line]) -> Summed:
    """What stands in the place of these lines."""
    sha256, count = hashlib.sha256(), 0
    for text in letters_text(lines):
        sha256.update(text.encode())
        count += 1
    return Summed(count, sha256.hexdigest())


def _head_lines(head: Head) -> Iterator[str]:
    name, of_specification = head.specification
    yield HEADER
    yield f"ltlc {head.version}"
    yield f"specification {name} sha256 {of_specification}"
    yield f"certificates sha256 {head.certificates}"
    yield from (f"recording {file.name} {file.bytes} sha256 {file.sha256}" for file in head.recordings)
    yield from (f"definition {type_} sha256 {sha256}" for type_, sha256 in head.definitions)
    yield from (f"signal {name} {type_} {condition_text(definition)}" for name, type_, definition in head.signals)
    if head.rate is not None:
        yield f"rate {head.rate}"
    if head.timeout is not None:
        yield f"timeout {head.timeout}"
    if head.is_by_header:
        yield "stamp header"
    if head.since is not None:
        yield f"from {head.since}"
    if head.until is not None:
        yield f"to {head.until}"


def _claim_lines(claim: Claim) -> Iterator[str]:
    yield f"property {claim.label}"
    yield f"text {claim.text}"
    if claim.requirement is not None:
        yield f"requirement {claim.requirement}"
    yield from (f"verifies {each}" for each in claim.verifies)
    for name, condition in claim.atoms:
        yield f"atom {name}"
        yield f"is {condition_text(condition)}"
    for name, said in claim.counts:
        yield f"count {name}"
        yield f"of {said}"
    yield from (f"scope {each.said}" for each in claim.scopes)
    if claim.opens is not None:
        yield f"instances a{claim.opens}"
    if claim.key is not None:
        yield f"key {condition_text(claim.key)}"
    yield f"session {claim.session}"
    for each in claim.slices:
        yield f"slice {each.id}"
        yield from _verdict_lines(each)
    yield from _verdict_lines(claim)


def _verdict_lines(of: Claim | StatedSlice) -> Iterator[str]:
    if isinstance(of.letters, Summed):
        yield f"letters {of.letters.count} sha256 {of.letters.sha256}"
    else:
        yield from (text.rstrip("\n") for text in letters_text(of.letters))
    yield f"until {of.until}"
    yield f"verdict {of.verdict.value} {of.decided}"


_TEXT = re.compile(r"[^\x00-\x1f\x7f\x85\u2028\u2029]+")
"""What fits on a line."""
