"""What a run has shown, of each property and of all: the result of `ltlc.run`, and of a monitor that is finished."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import Any

from ltlc.base.diagnostics import Diagnostic
from ltlc.base.errors import UnusableInput
from ltlc.dataclass import dataclass
from ltlc.monitoring.columns.curves import Curve
from ltlc.monitoring.judging.run import RunReport
from ltlc.runtime import reports
from ltlc.runtime.properties import Failure, Moment
from ltlc.runtime.session import Session
from ltlc.runtime.tracking import Track
from ltlc.semantics.verdicts import Verdict

MOST_STEPS = 1_000_000
"""A run with more steps is not drawn in a notebook, where it would take seconds; `page` draws it."""


@dataclass(frozen=True, slots=True)
class PropertyResult:
    """What is known of one property: its verdict after `steps`, and how many episodes opened, None without scopes.

    `decided` has when and on which values the verdict became permanent, and because of what, or is None; what is owed
    has been so since `open_since`. As text, it is what a node would say: of a violation, the failing state.
    """

    label: str
    line: int
    text: str
    verdict: Verdict
    steps: int
    episodes: int | None
    decided: Failure | None
    open_since: Moment | None
    told: str

    def __str__(self) -> str:
        return self.told


def result_of(session: Session, track: Track) -> PropertyResult:
    """What is known of the property that `track` follows in `session`."""
    is_violated = track.verdict is Verdict.VIOLATED
    told = reports.figure(session, track).rstrip() if is_violated else reports.sentence(session, track)
    of = track.property
    return PropertyResult(
        of.label, of.line, of.text, track.verdict, track.steps, track.episodes, track.decided_at, track.open_since, told
    )


def violations_of(session: Session) -> list[PropertyResult]:
    """The properties that are violated, in the order in which they were."""
    found = [track for track in session.tracks if track.verdict is Verdict.VIOLATED]
    return [result_of(session, t) for t in sorted(found, key=lambda t: t.decided_at.time if t.decided_at else 0)]


@dataclass(frozen=True)
class Run(Mapping[str, PropertyResult]):
    """What a run has shown: a `PropertyResult` for each property, by its label.

    If it `is_damaged`, it was judged up to the damage, which the last of the `diagnostics` is about.
    """

    _report: RunReport
    _page: Callable[[bool], str] | None = None
    _measured: Callable[[], Mapping[str, Curve]] | None = None

    def __getitem__(self, label: str) -> PropertyResult:
        return self._results[label]

    def __iter__(self) -> Iterator[str]:
        return iter(self._results)

    def __len__(self) -> int:
        return len(self._results)

    def __str__(self) -> str:
        return self.text()

    __repr__ = __str__

    @cached_property
    def _results(self) -> dict[str, PropertyResult]:
        session = self._report.session
        tracks = () if session is None else session.tracks
        return {track.property.label: result_of(session, track) for track in tracks if session is not None}

    @property
    def verdicts(self) -> dict[str, Verdict]:
        """The verdict of each property at the end, by its label."""
        return {label: result.verdict for label, result in self.items()}

    @property
    def violations(self) -> list[PropertyResult]:
        """The properties that are violated, in the order in which they were."""
        return [] if self._report.session is None else violations_of(self._report.session)

    @cached_property
    def robustness(self) -> Mapping[str, Curve]:
        """By how much each property holds, or is violated, by its label; see `Curve`.

        `run.robustness["slow"].margins` is a numpy array with a number for each step. The recording is read again for
        it. Raises UnusableInput of a run that was stepped, whose rows are not kept.
        """
        if self._measured is None:
            raise UnusableInput((), "a monitor does not keep its rows; use `ltlc.run` to measure them")
        return self._measured()

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Further findings about the recording."""
        return self._report.diagnostics

    @property
    def is_damaged(self) -> bool:
        """Whether the recording could be read in part only."""
        return self._report.is_damaged

    @property
    def exit_code(self) -> int:
        """As of `ltlc run`: 0 all hold; 1 one is violated; 2 damaged; 3 one has an obligation open or never started."""
        return self._report.exit_code

    def text(self) -> str:
        """What `ltlc run` prints: each violation with its failing state, and a line for each property."""
        return self._report.text()

    def document(self) -> dict[str, Any]:
        """What `ltlc run --format json` prints."""
        return self._report.document()

    def junit(self) -> str:
        """What `ltlc run --format junit` prints."""
        return self._report.junit()

    def page(self) -> str:
        """The page of `ltlc run --report`, without English and examples: verdicts over the signals, and the monitors.

        The recording is read again for it. Raises UnusableInput of a run that was stepped, whose rows are not kept.
        """
        if self._page is None:
            raise UnusableInput((), "a monitor does not keep its rows; use `ltlc.run` to draw them")
        return self._page(False)

    def _repr_html_(self) -> str:
        from ltlc.interfaces.api.display import run_html

        framed = self._page if self._report.session and self._report.session.steps <= MOST_STEPS else None
        return run_html(self._report, "" if framed is None else framed(True))
