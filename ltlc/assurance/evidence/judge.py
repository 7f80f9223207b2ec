"""From the letters of a recorded run to its verdict, by a certificate that the checker has accepted: line by line.

Coq: `proofs/Evidence.v`, with the same names, and the proof that the verdict is right: `evidence_of_lines`. This is the
same algorithm in Python; `proofs/checker/judge` is that of Coq.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ltlc.assurance.evidence.document import Claim, Line
from ltlc.assurance.evidence.parts import NOTHING, Memory, Part, Past, next_part
from ltlc.semantics import finite
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.certificate_text import Entry
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.ltl import atoms
from ltlc.semantics.timed_atoms import Late, News, atoms_within
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter

LATEST: Nanoseconds = 3_600_000_000_000_000_000
"""The last time that is judged, in the year 2084: with any duration added, it is a machine integer to Coq's program."""


@dataclass(frozen=True, slots=True)
class Judging:
    """What does not change in a run: the certificate, with its past, clocks and news, and when the session began."""

    certificate: Certificate
    session: Nanoseconds
    past: tuple[Past, ...]
    timers: tuple[Late, ...]
    news: frozenset[str]

    def is_one(self, part: Part) -> bool:
        """Whether `part` is known to be one letter. Without time, a letter may come more often than its line says."""
        return part.single and bool(self.past or self.timers)


class Standing(NamedTuple):
    """What is known after some lines: whether there were any, and what the past and clocks remember.

    And the state of the monitor, its `verdict`, and since when it is that.
    """

    has_read: bool = False
    remembers: Memory = NOTHING
    state: int = 0
    verdict: Verdict = Verdict.NOT_STARTED
    since: Nanoseconds = 0


def prepare(certificate: Certificate, session: Nanoseconds) -> Judging:
    """How runs in a session that began at `session` are judged by a certificate of the encoding `episode`."""
    within = tuple(atoms_within(certificate.formula))
    return Judging(
        certificate,
        session,
        tuple(atom for atom in within if isinstance(atom, Past)),
        tuple(atom for atom in within if isinstance(atom, Late)),
        frozenset(atom.name for atom in within if isinstance(atom, News)),
    )


def judge_part(judging: Judging, standing: Standing, part: Part) -> Standing | None:
    """What is known after a part; None if it is not judged.

    Its letter has to be one that the certificate allows; and to lead back to the state that it leads to, so that it
    does not matter how many instants the part has.
    """
    has_read = standing.has_read
    found = next_part(judging.session, judging.past, judging.timers, not has_read, standing.remembers, part)
    if found is None or not finite.holds(judging.certificate.assumption, (found[0],)):
        return None
    letter, remembers = found
    monitor = judging.certificate.monitor
    state = monitor.step(standing.state, letter)
    if not judging.is_one(part) and monitor.step(state, letter) != state:
        return None
    verdict = monitor.verdicts[state]
    since = standing.since if has_read and verdict is standing.verdict else part.start
    return Standing(True, remembers, state, verdict, since)


def judge_held(judging: Judging, standing: Standing, held: Part, cuts: Sequence[Nanoseconds] = ()) -> Standing | None:
    """What is known after a letter that is held, cut after the instants at `cuts`, where clocks may come due."""
    for cut in cuts:
        if held.start <= cut < held.end:
            after = judge_part(judging, standing, held._replace(end=cut))
            if after is None:
                return None
            standing, held = after, held._replace(start=cut + 1)
    return judge_part(judging, standing, held)


def judge_line(
    judging: Judging,
    standing: Standing,
    line: tuple[Nanoseconds, Letter],
    end: Nanoseconds,
    cuts: Sequence[Nanoseconds] = (),
) -> Standing | None:
    """What is known after a line, if the next one is at `end`: after its own instant, and what is held after it."""
    time, letter = line
    if end < time:
        return None
    after = judge_part(judging, standing, Part(letter, time, time, single=True))
    if after is None or time == end:
        return after
    return judge_held(judging, after, Part(letter - judging.news, time + 1, end), cuts)


class _RefusedError(Exception):
    """Why a claim is not what the judge finds."""


def refusal(claim: Claim, lines: Iterable[Line], entry: Entry) -> str | None:
    """Why `claim` is not what follows from `lines`, by a certificate that is accepted; None if it is.

    That the certificate is accepted, and about the property, somebody else has found.
    """
    try:
        _judge(claim, lines, entry)
    except _RefusedError as refused:
        return str(refused)
    return None


def _judge(claim: Claim, lines: Iterable[Line], entry: Entry) -> None:
    if entry.encoding != EPISODE.name:
        raise _RefusedError("its encoding is not that of the language")
    judging = prepare(entry.certificate, claim.session)
    names = _names(claim, judging)
    letters: dict[tuple[int, ...], Letter] = {}
    standing, before = Standing(), None
    for time, numbers in lines:
        if before is not None:
            standing = _judged(judging, standing, before, time)
        letter = letters.get(numbers)
        if letter is None:
            letter = letters[numbers] = frozenset(names[number] for number in numbers)
        before = time, letter
    if claim.decided != claim.until:
        raise _RefusedError("the run was not looked at up to the time of its verdict")
    if (claim.verdict is Verdict.NOT_STARTED) != (before is None):
        raise _RefusedError("it has no letters" if before is None else "it has letters, so it has started")
    if before is None:
        return
    standing = _judged(judging, standing, before, claim.until)
    decided = standing.since if standing.verdict.is_permanent else claim.until
    if (standing.verdict, decided) != (claim.verdict, claim.decided):
        stated, found = _from(claim.verdict, claim.decided), _from(standing.verdict, decided)
        raise _RefusedError(f"the verdict is {found}, not {stated}")


def _from(verdict: Verdict, time: Nanoseconds) -> str:
    return f"{verdict.value} from {time} on"


def _judged(judging: Judging, standing: Standing, line: tuple[Nanoseconds, Letter], end: Nanoseconds) -> Standing:
    """What is known after a line; where its letter has to be cut is looked for, and need not be right."""
    time, letter = line
    if time > LATEST or end > LATEST:
        raise _RefusedError("times after the year 2084 are not judged")
    if end < time:
        raise _RefusedError("times go back")
    if (after := judge_line(judging, standing, line, end)) is not None:
        return after
    alone = Part(letter, time, time, single=True)
    if (first := judge_part(judging, standing, alone)) is None:
        raise _RefusedError(_reason(judging, standing, alone))
    cuts = list(_cuts(judging, first, Part(letter - judging.news, time + 1, end)))
    if (after := judge_line(judging, standing, line, end, cuts)) is None:
        raise _RefusedError("it is not judged")
    return after


def _cuts(judging: Judging, standing: Standing, held: Part) -> Iterator[Nanoseconds]:
    """The last instants before the answer of a clock changes while a letter is held."""
    while judge_part(judging, standing, held) is None:
        low, high = held.start, held.end
        while high - low > 1:
            middle = (low + high) // 2
            if judge_part(judging, standing, held._replace(end=middle)) is None:
                high = middle
            else:
                low = middle
        part = held._replace(end=low)
        after = judge_part(judging, standing, part)
        if after is None or low == held.end:
            raise _RefusedError(_reason(judging, standing, part))
        yield low
        standing, held = after, held._replace(start=low + 1)


def _reason(judging: Judging, standing: Standing, part: Part) -> str:
    """Why a part is not judged."""
    found = next_part(judging.session, judging.past, judging.timers, not standing.has_read, standing.remembers, part)
    if found is None:
        return "what 'previously' asks depends on steps that have no line"
    if not finite.holds(judging.certificate.assumption, (found[0],)):
        return "the certificate assumes that there is no such letter"
    return "the verdict depends on how often this letter comes"


def _names(claim: Claim, judging: Judging) -> list[str]:
    """The names of the atoms of a claim: all that the certificate does not define, and none that it does."""
    certificate = judging.certificate
    defined = {each.name for each in (*judging.past, *judging.timers)}
    within = (atom.name for atom in atoms_within(certificate.formula))
    asked = {*certificate.monitor.atoms, *atoms(certificate.assumption), *within}
    names = [name for name, _ in claim.atoms]
    for number, name in enumerate(names):
        if name in defined:
            raise _RefusedError(f"'{name}' follows from the other atoms")
        if name in names[:number]:
            raise _RefusedError(f"'{name}' is there twice")
    if missing := sorted(asked - defined - {*names}):
        raise _RefusedError(f"'{missing[0]}' is missing")
    return names
