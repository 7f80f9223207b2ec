"""What a step does to the state, the verdict and the clocks of a monitor, as statements of a language."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ltlc.backends.statements import Do, If, Statement, conjunction, disjunction
from ltlc.backends.trees import Call, Chain, Code, Text
from ltlc.dataclass import dataclass
from ltlc.semantics.verdicts import Verdict

MEANINGS = {
    Verdict.NOT_STARTED: "no step yet",
    Verdict.VIOLATED: "whatever follows",
    Verdict.PRESUMABLY_VIOLATED: "an obligation is still open",
    Verdict.PRESUMABLY_SATISFIED: "no obligation is open so far",
    Verdict.SATISFIED: "whatever follows",
}
"""The texts of verdicts in compiled languages."""


@dataclass(frozen=True, slots=True)
class Wording:
    """The words of a language, for a monitor whose members stand behind `own`.

    A verdict that `is_dated` has the time since when it holds; the first step has set both then. A clock that is due
    `never` does not run. `duration` is a format, `sooner` the least of times. Of times and how many these are to be,
    `noted` has what notes another, and whether there are as many, `first` the first. Methods stand behind `method`, and
    are given what is `handed` to each, first. `words` are false and true.
    """

    own: str
    verdicts: Mapping[Verdict, str]
    is_dated: bool
    never: str
    duration: str
    sooner: Callable[[Sequence[str]], Code]
    noted: Callable[[str, int], tuple[tuple[Statement, ...], Code]]
    first: Callable[[str, int], str]
    method: str
    handed: tuple[str, ...] = ()
    same: tuple[str, str] = ("==", "!=")
    words: tuple[str, str] = ("false", "true")

    def starts(self, verdict: Verdict) -> tuple[Statement, ...]:
        """What the first state does to a verdict that may not be there yet."""
        return () if self.is_dated else self.verdict(verdict)

    def state(self, number: int) -> Statement:
        """The state is the one with this number from now on."""
        return f"{self.own}state = {number}"

    def verdict(self, verdict: Verdict) -> tuple[Statement, ...]:
        """The verdict changes."""
        changes = f"{self.own}verdict = {self.verdicts[verdict]}"
        return (changes, f"{self.own}since = time") if self.is_dated else (changes,)

    def settled(self, verdict: Verdict) -> tuple[Statement, ...]:
        """The verdict is this one from now on, which it may have been before."""
        return (If(self._is(verdict, False), self.verdict(verdict)),) if self.is_dated else self.verdict(verdict)

    def begun(self, verdict: Verdict, *further: Statement) -> If:
        """The first step sets the verdict, and does something `further`."""
        return If(self.is_new(), (*self.verdict(verdict), *further))

    def is_new(self, is_new: bool = True) -> Code:
        """Whether there was no step, or there was one."""
        return self._is(Verdict.NOT_STARTED, is_new)

    def _is(self, verdict: Verdict, holds: bool) -> Code:
        """Whether the verdict is this one, or is not."""
        operator = self.same[not holds]
        return Chain((Text(f"{self.own}verdict"), Text(self.verdicts[verdict])), (operator,))

    def clock(self, name: str, since: str, duration: int) -> Statement:
        """The clock is due a duration `since` this or that: `time`, `time - 1`, or itself when it was due; or never."""
        later = self.duration.format(duration)
        if since == name:
            return f"{self.own}{name} += {later}"
        return f"{self.own}{name} = {since} + {later}" if since else f"{self.own}{name} = {self.never}"

    def is_late(self, clock: str, late: bool = True) -> Code:
        """Whether the clock was due before `time`, or was not."""
        return Chain((Text("time"), Text(f"{self.own}{clock}")), (">" if late else "<=",))

    def again(self) -> Statement:
        """A clock step comes a nanosecond later."""
        return f"{self.own}due = time"

    def soonest(self, clocks: Sequence[str]) -> Statement:
        """The next clock step is that of the first of the clocks to be due."""
        times = [f"{self.own}{name}" for name in clocks] or [self.never]
        return Do(f"{self.own}due = ", self.sooner(times) if len(times) > 1 else Text(times[0]))

    def schedule(self) -> Statement:
        """The next clock step is that of the first clock to be due, of ages those that are not late."""
        return self.call("_schedule", ["time"])

    def heard(self, news: str, ages: Mapping[str, int], can_be_due: bool = True) -> Statement:
        """The clocks of `ages`, with their durations, are renewed if there is `news`; if one was late, it is due."""
        was_late = conjunction([disjunction([self.is_late(name) for name in ages]), self.is_new(False)])
        held = (If(was_late, (f"{self.own}due = time - 1",)),) if can_be_due else ()
        return If(Text(news), (*held, *(self.clock(name, "time", duration) for name, duration in ages.items())))

    def call(self, method: str, arguments: Sequence[str]) -> Statement:
        """Go on with the method that shared decisions have become."""
        return Do("", Call(f"{self.method}{method}", tuple(map(Text, (*self.handed, *arguments)))))
