"""Whether the verdict that a claim states is the one that follows from its letters: what the judge makes of its lines.

The same in Coq's program: `proofs/checker/judge.ml`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ltlc.assurance.evidence.counting import counted
from ltlc.assurance.evidence.document import Claim, Line
from ltlc.assurance.evidence.judge import Judging, Standing, judge_line, judge_part, prepare, whole_part
from ltlc.assurance.evidence.parts import Part
from ltlc.semantics import finite
from ltlc.semantics.certificate_text import Entry
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.encodings import EPISODE
from ltlc.semantics.ltl import atoms
from ltlc.semantics.openings import scope_clocks
from ltlc.semantics.properties import After, predicates
from ltlc.semantics.timed_atoms import Clock, News, Occurred, atoms_within
from ltlc.semantics.verdicts import Verdict
from ltlc.semantics.words import Letter

LATEST: Nanoseconds = 3_600_000_000_000_000_000
"""The last time that is judged, in the year 2084: with any duration added, it is a machine integer to Coq's program."""


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


def refusal_of_all(claim: Claim) -> str | None:
    """Why the verdict of `claim` is not that of its slices together: of the worst, and never satisfied for good."""
    if claim.letters:
        return "it has letters that belong to no id"
    if len({each.id for each in claim.slices}) < len(claim.slices):
        return "an id is there twice"
    verdicts = {each.verdict for each in claim.slices} - {Verdict.NOT_STARTED}
    verdict = Verdict.PRESUMABLY_SATISFIED if verdicts else Verdict.NOT_STARTED
    worst = [each for each in (Verdict.VIOLATED, Verdict.PRESUMABLY_VIOLATED) if each in verdicts]
    verdict = worst[0] if worst else verdict
    decided = min((each.decided for each in claim.slices if each.verdict is Verdict.VIOLATED), default=claim.until)
    if (verdict, decided, decided) == (claim.verdict, claim.decided, claim.until):
        return None
    return f"the verdict is {_from(verdict, decided)}, not {_from(claim.verdict, claim.decided)}"


def _judge(claim: Claim, lines: Iterable[Line], entry: Entry) -> None:
    if entry.encoding != EPISODE.name:
        raise _RefusedError("its encoding is not that of the language")
    try:
        counts = [counted(each, [name for name, _ in claim.atoms]) for each in claim.counts]
    except ValueError as error:
        raise _RefusedError(str(error)) from None
    judging = prepare(entry.certificate, claim.session, counts, [*_scopes(claim, entry)])
    names = [*_names(claim, judging), *(name for name, _ in judging.scopes)]
    if claim.opens is not None and not _is_opened_by(names[claim.opens : claim.opens + 1], entry, counts):
        raise _RefusedError("its certificate is not of instances")
    run = _Run(judging) if claim.opens is None else _InstancesRun(judging, names[claim.opens])
    letters: dict[tuple[int, ...], Letter] = {}
    before = None
    for time, numbers in lines:
        if before is not None:
            run.take(before, time)
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
    run.take(before, claim.until)
    verdict, since = run.answer()
    decided = since if verdict.is_permanent else claim.until
    if (verdict, decided) != (claim.verdict, claim.decided):
        stated, found = _from(claim.verdict, claim.decided), _from(verdict, decided)
        raise _RefusedError(f"the verdict is {found}, not {stated}")


def _is_opened_by(names: Sequence[str], entry: Entry, counts: Iterable[Occurred]) -> bool:
    """Whether a certificate is of instances that the one of these `names` opens, which nothing else asks for."""
    match entry.subject:
        case After(News(name), body) if [name] == [*names]:
            asked = [*predicates(body), *(count.operand for count in counts)]
            return all(atom.name != name for part in asked for atom in atoms_within(part))
        case _:
            return False


class _Run:
    """A run that is judged line by line."""

    def __init__(self, judging: Judging) -> None:
        self._judging = judging
        self._standing = Standing()

    def take(self, line: tuple[Nanoseconds, Letter], end: Nanoseconds) -> None:
        """A line, which is held until `end`."""
        self._standing = _judged(self._judging, self._standing, line, end)

    def answer(self) -> tuple[Verdict, Nanoseconds]:
        """The verdict, and since when it is that."""
        return self._standing.verdict, self._standing.since


class _InstancesRun(_Run):
    """A run from each line on at which an atom holds, by which an instance opens: in that, it holds at this line only.

    Instances of which the same is known are one. Coq: `evidence_of_instances`, in `proofs/Instances.v`.
    """

    def __init__(self, judging: Judging, opens: str) -> None:
        super().__init__(judging)
        self._opens = opens
        self._open: set[Standing] = set()
        self._violated: Nanoseconds | None = None

    def take(self, line: tuple[Nanoseconds, Letter], end: Nanoseconds) -> None:
        """A line, which is held until `end`."""
        time, letter = line
        others = letter - {self._opens}
        found = [_judged(self._judging, each, (time, others), end) for each in self._open]
        if self._opens in letter:
            found.append(_judged(self._judging, self._standing, line, end))
        self._open = {each._replace(since=0) for each in found if not each.verdict.is_permanent}
        violated = [each.since for each in found if each.verdict is Verdict.VIOLATED]
        if self._violated is None:
            self._violated = min(violated, default=None)
        super().take((time, others), end)

    def answer(self) -> tuple[Verdict, Nanoseconds]:
        """That of the worst instance; none is satisfied for good, since another one may open."""
        if self._violated is not None:
            return Verdict.VIOLATED, self._violated
        is_owed = any(each.verdict is Verdict.PRESUMABLY_VIOLATED for each in self._open)
        return Verdict.PRESUMABLY_VIOLATED if is_owed else Verdict.PRESUMABLY_SATISFIED, 0


def _scopes(claim: Claim, entry: Entry) -> Iterator[tuple[str, Clock]]:
    """The scopes of a claim, each with the atom that says that it is open, which has a name that no other can have."""
    clocks = scope_clocks(entry.subject)
    for number, _ in claim.scopes:
        clock = clocks[number] if number < len(clocks) else None
        if clock is None:
            raise _RefusedError(f"there is no scope {number} that is open once at a time")
        yield f"\nscope {number}", clock


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
    found = whole_part(judging, standing, part)
    if found is None:
        if judging.scopes:
            return "it does not say which scopes are open"
        asks = "is counted" if judging.counts else "'previously' asks"
        return f"what {asks} depends on steps that have no line"
    if not finite.holds(judging.certificate.assumption, (found[0],)):
        return "the certificate assumes that there is no such letter"
    return "the verdict depends on how often this letter comes"


def _names(claim: Claim, judging: Judging) -> list[str]:
    """The names of the atoms of a claim: with its counts all that the certificate does not define, and none else."""
    certificate = judging.certificate
    defined = {each.name for each in (*judging.past, *judging.timers)}
    within = (atom.name for atom in atoms_within(certificate.formula))
    asked = {*certificate.monitor.atoms, *atoms(certificate.assumption), *within}
    names = [name for name, _ in claim.atoms]
    stated = [*names, *(count.name for count in judging.counts)]
    for number, name in enumerate(stated):
        if name in defined:
            raise _RefusedError(f"'{name}' follows from the other atoms")
        if name in stated[:number]:
            raise _RefusedError(f"'{name}' is there twice")
    if missing := sorted(asked - defined - {*stated}):
        raise _RefusedError(f"'{missing[0]}' is missing")
    return names
