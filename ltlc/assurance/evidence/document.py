"""The document of evidence, version 1: what was judged, by what, and for each property its letters and its verdict.

One item a line, in one order; `docs/evidence.md` describes them. What is read is written again as the same bytes, or is
refused, and the last line has the SHA-256 of all before it: no byte can be changed unnoticed.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from ltlc.base.provenance import FileDigest
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict

HEADER = "ltlc-evidence 1"
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


@dataclass(frozen=True, slots=True)
class Claim:
    """The verdict of one property, and the letters that it follows from.

    Ages count from `session` until a message comes. The run was looked at up to `until`: the moment of the decision, or
    the end of the recording. The verdict was right from `decided` on.
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


@dataclass(frozen=True, slots=True)
class UnreadableEvidence:
    """A text is no evidence: `line`, counted from 1, says something else."""

    line: int
    message: str


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
    yield f"session {claim.session}"
    if isinstance(claim.letters, Summed):
        yield f"letters {claim.letters.count} sha256 {claim.letters.sha256}"
    else:
        yield from (text.rstrip("\n") for text in letters_text(claim.letters))
    yield f"until {claim.until}"
    yield f"verdict {claim.verdict.value} {claim.decided}"


_TEXT = re.compile(r"[^\x00-\x1f\x7f\x85\u2028\u2029]+")
"""What fits on a line."""

_TIME, _HEX, _SOME = r"(0|[1-9][0-9]{0,18})", r"([0-9a-f]{64})", r"(\S|\S.*\S)"
_LETTER = r"((?: a(?:0|[1-9][0-9]{0,5}))*)"


def parsed(text: str) -> Document | UnreadableEvidence:
    """The one document that `text` is."""
    found = parsed_all(text)
    if isinstance(found, UnreadableEvidence):
        return found
    return found[0] if len(found) == 1 else UnreadableEvidence(1, f"there are {len(found)} documents")


def parsed_all(text: str) -> tuple[Document, ...] | UnreadableEvidence:
    """The documents that stand one after the other in `text`: those of a campaign."""
    reader = _Reader(text)
    try:
        return tuple(reader.documents())
    except _RefusedError as error:
        return UnreadableEvidence(reader.at + 1, str(error))


def _is_printed(document: Document, text: str) -> bool:
    try:
        return printed(document) == text
    except (ValueError, RecursionError):
        return False


class _RefusedError(Exception):
    """Why a line cannot stand where it does."""


class _Reader:
    """Reads a text line by line; `at` is the number of the next one, from 0."""

    def __init__(self, text: str) -> None:
        self._lines = text.split("\n")
        self.at = 0

    def documents(self) -> Iterator[Document]:
        """All that there are, at least one."""
        while True:
            yield self._document()
            if self.at == len(self._lines) - 1 and not self._lines[-1]:
                return

    def _document(self) -> Document:
        first = self.at
        document = Document(self._head(), tuple(self._properties()))
        (sha256,) = self._need(END + _HEX, "the SHA-256 of all lines before")
        end, self.at = self.at, self.at - 1
        if end == len(self._lines):
            raise _RefusedError("the last line has no end")
        text = "".join(f"{line}\n" for line in self._lines[first : self.at])
        if digest(text) != sha256:
            raise _RefusedError("this is not the SHA-256 of the lines before: something was changed")
        if not _is_printed(document, f"{text}{END}{sha256}\n"):
            raise _RefusedError("the document is not written as it should be")
        self.at = end
        return document

    def _take(self, pattern: str) -> tuple[str, ...] | None:
        """The groups of the next line, if it is all that the pattern says."""
        line = self._lines[self.at] if self.at < len(self._lines) else ""
        found = re.fullmatch(pattern, line)
        if found is None:
            return None
        self.at += 1
        return found.groups()

    def _need(self, pattern: str, what: str) -> tuple[str, ...]:
        found = self._take(pattern)
        if found is None:
            line = self._lines[self.at] if self.at < len(self._lines) else ""
            raise _RefusedError(f"expected {what}, found `{line[:80]}`" if line else f"expected {what}")
        return found

    def _all(self, pattern: str) -> Iterator[tuple[str, ...]]:
        while (found := self._take(pattern)) is not None:
            yield found

    def _optional(self, pattern: str) -> str | None:
        found = self._take(pattern)
        return None if found is None else found[0]

    def _time(self, pattern: str) -> Nanoseconds | None:
        found = self._optional(pattern)
        return None if found is None else int(found)

    def _head(self) -> Head:
        self._need(HEADER, f"`{HEADER}`")
        (version,) = self._need(f"ltlc {_SOME}", "the version of ltlc")
        name, of_specification = self._need(f"specification {_SOME} sha256 {_HEX}", "the specification")
        (certificates,) = self._need(f"certificates sha256 {_HEX}", "the SHA-256 of the certificates")
        files = self._all(f"recording {_SOME} {_TIME} sha256 {_HEX}")
        recordings = tuple(FileDigest(name, int(size), sha256) for name, size, sha256 in files)
        if not recordings:
            self._need("recording", "a file of the recording")
        definitions = tuple((type_, sha256) for type_, sha256 in self._all(rf"definition (\S+) sha256 {_HEX}"))
        signals = tuple(self._signals())
        rate, timeout = self._optional(r"rate ([0-9.e+-]+)"), self._time(f"timeout {_TIME}")
        is_by_header = self._take("stamp header") is not None
        since, until = self._time(f"from {_TIME}"), self._time(f"to {_TIME}")
        return Head(
            version, (name, of_specification), certificates, recordings, definitions,
            rate, timeout, is_by_header, since, until, signals,
        )  # fmt: skip

    def _properties(self) -> Iterator[Claim | NotCovered]:
        while self._take("") is not None:
            if (found := self._take(f"not-covered {_SOME}: {_SOME}")) is not None:
                label, _, reason = ": ".join(found).partition(": ")
                yield NotCovered(label, reason)
            else:
                yield self._claim()

    def _claim(self) -> Claim:
        (label,) = self._need(f"property {_SOME}", "a property")
        (text,) = self._need(f"text {_SOME}", "the text of the property")
        requirement = self._optional(f"requirement {_SOME}")
        verifies = tuple(each for (each,) in self._all(f"verifies {_SOME}"))
        atoms = tuple(self._atoms())
        (session,) = self._need(f"session {_TIME}", "when the session began")
        letters = self._letters(len(atoms))
        (until,) = self._need(f"until {_TIME}", "the time up to which the run was looked at")
        verdicts = "|".join(verdict.value for verdict in Verdict)
        verdict, decided = self._need(f"verdict ({verdicts}) {_TIME}", "a verdict and its time")
        return Claim(
            label, text, atoms, int(session), letters, int(until), Verdict(verdict), int(decided), requirement, verifies
        )

    def _signals(self) -> Iterator[StatedSignal]:
        for name, type_, definition in self._all(r"signal (\S+) (\S+) (\{.*\})"):
            yield StatedSignal(name, type_, self._data(definition))

    def _atoms(self) -> Iterator[StatedAtom]:
        for (name,) in self._all(f"atom {_SOME}"):
            (condition,) = self._need(r"is (\{.*\})", "what the atom is")
            yield StatedAtom(name, self._data(condition))

    def _data(self, text: str) -> Data:
        """What the last line says in JSON."""
        try:
            found: Data = json.loads(text)
        except (ValueError, RecursionError):
            self.at -= 1
            raise _RefusedError("this is not JSON") from None
        return found

    def _letters(self, atoms: int) -> tuple[Line, ...] | Summed:
        found = self._take(f"letters {_TIME} sha256 {_HEX}")
        if found is not None:
            return Summed(int(found[0]), found[1])
        lines: list[Line] = []
        for pattern, most in ((f"at {_TIME}{_LETTER}", 1), (rf"\+{_TIME}{_LETTER}", len(self._lines))):
            while len(lines) < most and (found := self._take(pattern)) is not None:
                numbers = tuple(int(each[1:]) for each in found[1].split())
                if list(numbers) != sorted({*numbers}) or (numbers and numbers[-1] >= atoms):
                    self.at -= 1
                    raise _RefusedError(f"not a letter:{found[1]}")
                lines.append(Line(int(found[0]) + (lines[-1].time if lines else 0), numbers))
            if not lines:
                break
        return tuple(lines)
