"""The control of what runs: the machine that folding makes, in the form in which it is compared with its monitor."""

from __future__ import annotations

from ltlc.semantics.control import Base, Branch, Control, Outcome, Setting, Stance, Way
from ltlc.semantics.monitor import Target
from ltlc.semantics.timed_monitor import Action, Effect, TimedMonitor


def control_of(program: TimedMonitor) -> Control:
    """The control of `program`. What is kept of values at openings is no part of it."""
    return _Numbering(program).control()


class _Numbering:
    """Numbers outcomes and branches as they are met: one of `program` may set a clock in two ways, by step or not."""

    def __init__(self, program: TimedMonitor) -> None:
        self.program = program
        self.outcomes: dict[Outcome, int] = {}
        self.branches: list[Branch] = []
        self.known: dict[tuple[Target, bool], Way] = {}

    def control(self) -> Control:
        program = self.program
        held: tuple[Target | None, ...] = program.held_edges or (None,) * len(program.verdicts)
        stances = tuple(
            Stance(
                verdict,
                self.way(edge, by_time=False),
                None if clock_step is None else self.way(clock_step, by_time=True),
            )
            for verdict, edge, clock_step in zip(program.verdicts, program.edges, held, strict=True)
        )
        first_due = tuple(None if due is None else due.duration for due in program.ages)
        return Control(stances, tuple(self.branches), tuple(self.outcomes), first_due)

    def way(self, target: Target, by_time: bool) -> Way:
        key = target, by_time
        if key not in self.known:
            self.known[key] = self.outcome(target, by_time) if target >= 0 else self.branch(~target, by_time)
        return self.known[key]

    def outcome(self, number: int, by_time: bool) -> Way:
        state, actions, again, _ = self.program.outcomes[number]
        made = Outcome(state, tuple(_setting(action, by_time) for action in actions), again)
        return self.outcomes.setdefault(made, len(self.outcomes))

    def branch(self, number: int, by_time: bool) -> Way:
        asked, low, high = self.program.decisions[number]
        if_not, if_so = self.way(low, by_time), self.way(high, by_time)
        clock = asked - len(self.program.atoms)
        self.branches.append(Branch(self.program.atoms[asked] if clock < 0 else clock, if_so, if_not))
        return ~(len(self.branches) - 1)


def _setting(action: Action, by_time: bool) -> Setting:
    """What `action` does at a step, or at a clock step: there, the letter was held until a nanosecond before."""
    match action.effect:
        case Effect.START:
            return Setting(action.clock, Base.NOW, action.duration)
        case Effect.RELEASE:
            return Setting(action.clock, Base.JUST_BEFORE if by_time else Base.NOW, action.duration)
        case Effect.EXTEND:
            return Setting(action.clock, Base.DUE, action.duration)
        case Effect.STOP:
            return Setting(action.clock, Base.NEVER, 0)
