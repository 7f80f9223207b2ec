"""`ltlc.guard`: the guards of a specification along a run that goes on, row by row as values and commands come."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

from ltlc.analysis.guards.reasons import Reasons
from ltlc.analysis.guards.solution import TooManyPlacesError, solve
from ltlc.base.errors import UnusableInput
from ltlc.base.limits import Budget
from ltlc.base.nearest import did_you_mean
from ltlc.compiler import Compiled
from ltlc.inputs.recordings.checks import checks_of
from ltlc.inputs.recordings.given import TIME, GivenTable, cells, time_given
from ltlc.inputs.recordings.rows import RecordingError
from ltlc.inputs.recordings.signals import FromTable
from ltlc.interfaces.api.monitor import keys_of, written_time
from ltlc.interfaces.api.prepare import Prepared, Text, encoding_of, prepare, read
from ltlc.interfaces.api.times import Seconds
from ltlc.monitoring.guarding.arrangement import Solved
from ltlc.monitoring.guarding.recording import GuardedRun, Guarding
from ltlc.monitoring.judging.run import Judge, readings
from ltlc.runtime.guarding import Deed
from ltlc.runtime.sampling import Value
from ltlc.semantics.durations import Nanoseconds
from ltlc.specification.arenas import Property, arena_of, conditions_held, together
from ltlc.specification.specification import Specification, topics_of

NAME = Path("guard")
"""What is called a guarded run that is in no file."""


def guard(
    specification: Text,
    *,
    encoding: str = "episode",
    message_paths: Sequence[str | PathLike[str]] = (),
    budget: Budget | None = None,
) -> LiveGuard:
    """The guards of `specification`, before their first row.

    >>> import ltlc
    >>> run = ltlc.guard('''
    ... guard /cmd_vel_raw to /cmd_vel else stop
    ... message stop {}
    ... decl speed /cmd_vel geometry_msgs/Twist.linear.x
    ... decl asked /cmd_vel_raw geometry_msgs/Twist.linear.x
    ... decl scan /scan sensor_msgs/LaserScan.ranges
    ... slow: always (new speed and min(scan) < 0.5 implies speed <= 0.2)
    ... ''')
    >>> run.step({"scan": [2.0, 0.3]}, time=0.0)
    []
    >>> [(each.action.value, each.message, each.reason) for each in run.step({"asked": 1.0}, time=0.1)]
    [('changed', 'stop', 'it would violate `slow`')]

    A `str` is the text of a specification, a `pathlib.Path` a file; otherwise as `LiveGuard`. `budget` is what the
    translation of each property may use. Raises UnusableInput and SpotMissing.
    """
    return LiveGuard(prepare(read(specification), message_paths, encoding_of(encoding), budget or Budget()))


class LiveGuard:
    """The guards of a file along a run that goes on, as `ltlc run --guard` follows them on a recording.

    A row has values by names, as a recording has columns: of the signals that are read, or by topic and field. Commands
    are those of the topic that a guard takes commands from, and come after what else is in their row. The first row
    begins the session. A guard acts when it is stepped: without a row at the time that is `due` it is late, and loses
    if a deadline has passed.
    """

    def __init__(self, prepared: Prepared) -> None:
        self._prepared = prepared
        self._guarding = guarding_of(prepared)
        self.reset()

    def reset(self) -> None:
        """Begin again, before the first row."""
        judge = Judge(self._prepared.compiled, self._prepared.specification)
        plan = judge.plan(())
        signals = {name: judge.signals[name] for name in readings(plan)}
        self._signals, self._commands = self._guarding.wanted(signals)
        self._run = GuardedRun(self._guarding, judge.signals, self._commands, plan)
        self._checks = checks_of(self._signals.values())
        self._tables: dict[tuple[str, ...], FromTable] = {}
        self._rows = 0
        self._time: Nanoseconds | None = None

    def step(
        self, values: Mapping[str, object], time: Seconds | None = None, *, time_ns: Nanoseconds | None = None
    ) -> list[Deed]:
        """Take a row, of what came at `time`, in s, or `time_ns`; what the guards did since the last one, in order.

        Values are numbers, booleans, strings, or lists of these; None is no sample. `values` may have the time, too, in
        s, as `time`. A row without samples only moves time on. Raises UnusableInput, and then the row is as if it had
        not come.
        """
        try:
            number = self._rows + 1
            table = self._table(keys_of(values, number))
            moment = time_given(NAME, number, self._time, written_time(values.get(TIME), time, time_ns))
            taken = table.row(moment, cells(NAME, number, values, table.cells))
            self._checks.check_row(moment, taken, NAME)
        except RecordingError as error:
            raise UnusableInput([error.diagnostic]) from None
        self._rows, self._time = number, moment
        return self._row(moment, taken)

    @property
    def fallbacks(self) -> dict[str, dict[str, object]]:
        """The fields of each message that a guard may send, by its name; the others are zero, false or empty."""
        stated = (each for guard in self._prepared.specification.guards for each in guard.fallbacks)
        return {each.name: {"/".join(path): of.value for path, of in each.values.items()} for each in stated}

    @property
    def due(self) -> Nanoseconds | None:
        """When a guard may act by itself next, if nothing comes before; None: never."""
        return self._run.due()

    def _row(self, time: Nanoseconds, taken: Mapping[str, Value]) -> list[Deed]:
        self._run.act_live(time)
        self._run.row(time, taken, ())
        deeds = [replace(each.deed, reason=each.reason()) for each in self._run.done]
        self._run.done.clear()
        self._run.taken.clear()
        return deeds

    def _table(self, keys: tuple[str, ...]) -> FromTable:
        """What reads rows with these keys. Raises RecordingError, and UnusableInput for a name that means nothing."""
        if keys not in self._tables:
            found = FromTable(NAME, GivenTable(NAME, [dict.fromkeys(keys)]), self._signals)
            topics = {topic for signal in self._signals.values() for topic in topics_of(signal)}
            for key in found.heads:
                if key not in found.cells and not key.startswith(tuple(f"{topic}/" for topic in topics)):
                    hint = did_you_mean(key, self._signals) or f"the names are {', '.join(self._signals)}"
                    raise UnusableInput((), f"no guard reads `{key}`; {hint}")
            self._tables[keys] = found
        return self._tables[keys]


def guarding_of(prepared: Prepared, *, keeps_messages: bool = False) -> Guarding:
    """The guards of what was `prepared`, solved; as `Guarding`. Raises UnusableInput."""
    specification = prepared.specification
    if not specification.guards:
        raise UnusableInput((), f"{specification.source.name} has no guard")
    try:
        return Guarding(specification, solved(specification, prepared.compiled), keeps_messages)
    except TooManyPlacesError as error:
        raise UnusableInput((), f"the game of the guards {error}") from None


def solved(specification: Specification, compiled: Sequence[Compiled]) -> list[Solved]:
    """The guards of `specification`, those together that share properties. Raises TooManyPlacesError."""
    properties = [Property(each.specification, each.formula, each.monitor) for each in compiled]
    found = []
    for guards in together(specification.guards, specification.properties):
        arena = arena_of(guards, properties)
        conditions = conditions_held(guards, specification.properties)
        solution = solve(arena)
        found.append(Solved(guards, arena, solution.region(), conditions, Reasons(solution, conditions)))
    return found
