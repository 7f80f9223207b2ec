"""From the letters of a recorded run to its verdict, by a certificate that the checker has accepted: line by line.

Coq: `proofs/Evidence.v`, with the same names, and the proof that the verdict is right: `evidence_of_lines`. This is the
same algorithm in Python; `proofs/checker/judge` is that of Coq.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ltlc.assurance.evidence.parts import (
    NOTHING,
    Memory,
    Opened,
    Part,
    Past,
    Tally,
    counted_parts,
    next_part,
    open_part,
)
from ltlc.dataclass import dataclass
from ltlc.semantics import finite
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.timed_atoms import Clock, Late, News, Occurred, atoms_within, news_of
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter


@dataclass(frozen=True, slots=True)
class Judging:
    """What does not change in a run: the certificate, its past, clocks, counts and news, and when the session began.

    The atom that comes with each of the `scopes` says that it is open.
    """

    certificate: Certificate
    session: Nanoseconds
    past: tuple[Past, ...]
    timers: tuple[Late, ...]
    counts: tuple[Occurred, ...]
    scopes: tuple[tuple[str, Clock], ...]
    news: frozenset[str]

    def is_one(self, part: Part) -> bool:
        """Whether `part` is known to be one letter. Without time, a letter may come more often than its line says."""
        return part.single and bool(self.past or self.timers or self.counts)


class Standing(NamedTuple):
    """What is known after some lines: whether there were any, and what the past, clocks, counts and scopes remember.

    And the state of the monitor, its `verdict`, and since when it is that.
    """

    has_read: bool = False
    remembers: Memory = NOTHING
    tallies: tuple[Tally, ...] = ()
    opened: tuple[Opened, ...] = ()
    state: int = 0
    verdict: Verdict = Verdict.NOT_STARTED
    since: Nanoseconds = 0


def prepare(
    certificate: Certificate,
    session: Nanoseconds,
    counts: Sequence[Occurred] = (),
    scopes: Sequence[tuple[str, Clock]] = (),
) -> Judging:
    """How runs in a session that began at `session` are judged by a certificate of the encoding `episode`.

    It asks for the `counts` as atoms; other atoms say which of the `scopes` are open.
    """
    within = tuple(atoms_within(certificate.formula))
    news = (atom for atom in within if isinstance(atom, News))
    return Judging(
        certificate,
        session,
        tuple(atom for atom in within if isinstance(atom, Past)),
        tuple(atom for atom in within if isinstance(atom, Late)),
        tuple(counts),
        tuple(scopes),
        frozenset(atom.name for atom in (*news, *(each for count in counts for each in news_of(count.operand)))),
    )


def open_scopes(
    scopes: Sequence[tuple[str, Clock]], part: Part, is_first: bool, before: Sequence[Opened]
) -> tuple[Opened, ...] | None:
    """Since when scopes, and those around them, are open at a part; None if its letter does not say which are."""
    found = tuple(
        open_part(scope, part, is_first, () if is_first else before[number])[0]
        for number, (_, scope) in enumerate(scopes)
    )
    is_right = all((name in part.letter) == (of[0] is not None) for (name, _), of in zip(scopes, found, strict=True))
    return found if is_right else None


def whole_part(
    judging: Judging, standing: Standing, part: Part
) -> tuple[Letter, Memory, tuple[Tally, ...], tuple[Opened, ...]] | None:
    """The letter of a part with its counts, past and clocks, and what is remembered then.

    None: these are not the same at all of its instants, or it does not say which scopes are open.
    """
    is_first = not standing.has_read
    if (with_counts := counted_parts(judging.counts, is_first, standing.tallies, part)) is None:
        return None
    counted_part, tallies = with_counts
    found = next_part(judging.session, judging.past, judging.timers, is_first, standing.remembers, counted_part)
    if found is None:
        return None
    opened = open_scopes(judging.scopes, part._replace(letter=found[0]), is_first, standing.opened)
    return None if opened is None else (*found, tallies, opened)


def judge_alike(judging: Judging, standing: Standing, part: Part) -> Standing | None:
    """What is known after a part whose instants are all alike to the monitor; None if it is not judged.

    Its letter has to be one that the certificate allows; and to lead back to the state that it leads to, so that it
    does not matter how many instants the part has.
    """
    found = whole_part(judging, standing, part)
    if found is None or not finite.holds(judging.certificate.assumption, (found[0],)):
        return None
    letter, remembers, tallies, opened = found
    monitor = judging.certificate.monitor
    state = monitor.step(standing.state, letter)
    if not judging.is_one(part) and monitor.step(state, letter) != state:
        return None
    verdict = monitor.verdicts[state]
    since = standing.since if standing.has_read and verdict is standing.verdict else part.start
    return Standing(True, remembers, tallies, opened, state, verdict, since)


def judge_part(judging: Judging, standing: Standing, part: Part) -> Standing | None:
    """What is known after a part; None if it is not judged.

    If its instants are not alike, they have to have one time, and the later ones, of which there may be none, to change
    nothing. So a clock may come due at the instant at which it is stopped.
    """
    if (alike := judge_alike(judging, standing, part)) is not None or part.start < part.end:
        return alike
    first = judge_alike(judging, standing, part._replace(single=True))
    return first if first is not None and judge_alike(judging, first, part) == first else None


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
