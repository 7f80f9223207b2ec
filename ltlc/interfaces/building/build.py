"""Makes the output for a target, and has the gate judge it: nothing else may be written."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ltlc.assurance.evidence.certified import entry_of
from ltlc.assurance.gate import Judgement, judge_all
from ltlc.assurance.messages import Messages
from ltlc.assurance.pairs import followed
from ltlc.backends import GUARDED
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import Budget, Exceeded, Watch
from ltlc.compiler import Compiled
from ltlc.dataclass import dataclass
from ltlc.frontend.language import types_for
from ltlc.interfaces.building.guards import NoRegionError, difference, guard_entries, guard_programs
from ltlc.interfaces.building.targets import Made, Target, UnfitError, Unit
from ltlc.interfaces.building.wording import (
    GATE_MEMORY,
    GATE_SECONDS,
    failures,
    guard_code_failure,
    guard_failure,
    summary,
)
from ltlc.program.guards import GuardProgram
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.certificate_reader import UnreadableError, parse
from ltlc.semantics.certificate_text import to_text
from ltlc.semantics.region_text import GuardEntry, guard_lines
from ltlc.specification.specification import Specification


class TooLargeError(Exception):
    """The certificates are larger than `ltlc certify` reads, or say less than they would have to."""


@dataclass(frozen=True)
class Built:
    """The output that was made of `compiled`, and the judgement of each property; it may be written if none failed."""

    specification: Specification
    compiled: Sequence[Compiled]
    target: Target
    made: Made
    judgements: Sequence[Judgement | Exceeded]
    guards: Sequence[GuardProgram] = ()
    entries: Sequence[GuardEntry] = ()

    def summaries(self) -> Iterator[tuple[str, str]]:
        """The label of each property, the size of its monitor, and what the gate checked."""
        for each, judgement in zip(self.compiled, self.judgements, strict=True):
            yield each.specification.label, summary(each, judgement, self.target.name)

    def failures(self) -> list[Diagnostic]:
        """Why the output may not be written; nothing if it may."""
        pairs = zip(self.compiled, self.judgements, strict=True)
        found = [each for pair in pairs for each in failures(self.specification, *pair)]
        for program, entry in zip(self.guards, self.entries, strict=True):
            if (wrong := difference(program, entry, self.compiled)) is not None:
                found.append(guard_failure(self.specification, program, wrong))
        if not found and (wrong_code := self.made.flaw()) is not None:
            found.append(guard_code_failure(self.specification, wrong_code))
        return found

    def certificates(self, with_programs: bool = False) -> str:
        """The certificates of judgements that have all passed, and what runs if asked for.

        Raises TooLargeError if others could not read them.
        """
        entries = (
            entry_of(
                compiled,
                judgement.certificate,
                followed(compiled, judgement.certificate.assumption) if with_programs else None,
            )
            for compiled, judgement in zip(self.compiled, self.judgements, strict=True)
            if isinstance(judgement, Judgement) and isinstance(judgement.certificate, Certificate)
        )
        try:
            guards = self.entries or guard_entries(self.specification, self.compiled)
            text = to_text(entries, [guard_lines(each) for each in guards])
        except NoRegionError as error:
            raise TooLargeError(str(error)) from None
        try:
            parse(text)
        except UnreadableError as error:
            raise TooLargeError(f"the certificates are too large for `ltlc certify`: {error.message}") from None
        return text


def build(
    specification: Specification,
    compiled: Sequence[Compiled],
    target: Target,
    message_paths: Sequence[str],
    budget: Budget,
    watch: Watch | None = None,
) -> Built:
    """The output for `target` of the properties `compiled` of `specification`, judged.

    `budget` is what the translation of each property may use; judging it may use some times as much. Raises UnfitError.
    """
    messages = Messages(types_for(specification.source, message_paths)[0])
    try:
        entries = guard_entries(specification, compiled) if target.name in GUARDED else []
        guards = guard_programs(specification, compiled, entries) if entries else []
    except NoRegionError as error:
        raise UnfitError([_without_guards(specification, str(error))]) from None
    made = target.make(Unit(specification, compiled, messages, guards))
    if specification.guards and made.programs is not None and not guards:
        reason = f"the target `{target.name}` has no guards: the output would monitor, and hold back nothing"
        raise UnfitError([_without_guards(specification, reason)])
    gate = Budget(GATE_SECONDS * budget.seconds, GATE_MEMORY * budget.megabytes)
    judgements = judge_all(compiled, made.programs, messages, gate, watch, made.written)
    return Built(specification, compiled, target, made, judgements, guards, entries)


def _without_guards(specification: Specification, reason: str) -> Diagnostic:
    help = "nothing was written; to emit the monitors alone, build the properties from a file without a guard"
    return diagnostic("LTL708", specification.source, specification.guards[0].span, reason, help=help)
