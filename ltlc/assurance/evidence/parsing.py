"""Reads documents of evidence: what is read is written again as the same bytes, or is refused."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from ltlc.assurance.evidence.document import (
    END,
    HEADER,
    Claim,
    Data,
    Document,
    Head,
    Line,
    NotCovered,
    StatedAtom,
    StatedCount,
    StatedScope,
    StatedSignal,
    StatedSlice,
    Summed,
    digest,
    printed,
)
from ltlc.base.provenance import FileDigest
from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.verdicts import Verdict


@dataclass(frozen=True, slots=True)
class UnreadableEvidence:
    """A text is no evidence: `line`, counted from 1, says something else."""

    line: int
    message: str


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
        counts, scopes = tuple(self._counts()), tuple(self._scopes())
        opens = self._optional(r"instances a(0|[1-9][0-9]{0,5})")
        key = None if (found := self._optional(r"key (\{.*\})")) is None else self._data(found)
        (session,) = self._need(f"session {_TIME}", "when the session began")
        slices = [] if key is None else [*self._slices(len(atoms) + len(scopes))]
        letters, until, verdict, decided = self._judged(len(atoms) + len(scopes))
        return Claim(
            label, text, atoms, int(session), letters, until, verdict, decided, requirement,
            verifies, counts, scopes, None if opens is None else int(opens), key, tuple(slices),
        )  # fmt: skip

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

    def _slices(self, atoms: int) -> Iterator[StatedSlice]:
        for (id_,) in self._all(f"slice {_SOME}"):
            yield StatedSlice(id_, *self._judged(atoms))

    def _judged(self, atoms: int) -> tuple[tuple[Line, ...] | Summed, Nanoseconds, Verdict, Nanoseconds]:
        """Letters, up to when, and a verdict with its time."""
        letters = self._letters(atoms)
        (until,) = self._need(f"until {_TIME}", "the time up to which the run was looked at")
        verdicts = "|".join(verdict.value for verdict in Verdict)
        verdict, decided = self._need(f"verdict ({verdicts}) {_TIME}", "a verdict and its time")
        return letters, int(until), Verdict(verdict), int(decided)

    def _counts(self) -> Iterator[StatedCount]:
        for (name,) in self._all(f"count {_SOME}"):
            (said,) = self._need(f"of {_SOME}", "what is counted")
            yield StatedCount(name, said)

    def _scopes(self) -> Iterator[StatedScope]:
        for number, spans in self._all(r"scope (0|[1-9][0-9]{0,8})((?: [0-9]{1,18}-[0-9]{0,18})*)"):
            pairs = (span.split("-") for span in spans.split())
            yield StatedScope(int(number), tuple((int(first), int(end) if end else None) for first, end in pairs))

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
