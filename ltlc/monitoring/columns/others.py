"""What all slices of a run share by columns: messages on topics that are not sliced."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ltlc.dataclass import dataclass
from ltlc.inputs.recordings.blocks import Block, Places
from ltlc.monitoring.columns.bits import Bytes
from ltlc.monitoring.columns.messages import letters_of, rows_with
from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.series import Columns, UnsupportedError
from ltlc.monitoring.columns.values import not_numbers
from ltlc.program.expressions import Expression, News, reads_of
from ltlc.runtime.sampling import Input, New, Reading, Value, Wanted
from ltlc.runtime.session import Session
from ltlc.runtime.slice_keys import Cut


@dataclass(frozen=True)
class Shared:
    """The steps of all slices in a block: the `rows`, ascending, and the letter at each.

    From the row `first` on, all that is shared has a value; what holds of it `before` these rows is a letter, too. The
    bits in `news` are gone after a step, and so are those in `own_news` of messages with an id.
    """

    signals: frozenset[str]
    columns: Columns
    rows: Places
    letters: Bytes
    first: int
    before: int
    news: int
    own_news: int

    @cached_property
    def by_row(self) -> Bytes:
        """The letter of what is shared in each row of the block."""
        held = np.append(np.uint8(self.before), self.letters & np.uint8(0xFF ^ self.news))
        found = held.repeat(np.diff(self.rows, prepend=0, append=self.columns.count))
        found[self.rows] = self.letters
        return found

    def held(self, letters: Bytes) -> Bytes:
        """What of the `letters` of messages with an id holds after them; and, at -1, something."""
        return np.append(letters & np.uint8(0xFF ^ self.own_news), np.uint8(0))

    def value(self, wanted: Wanted, row: int) -> Value:
        """What a slice reads in a row."""
        if isinstance(wanted, New):
            return row in self.columns.listed(self.columns.heard(wanted.signal))
        return self._latest(wanted.signal, row)

    def _latest(self, name: str, row: int) -> Value:
        series = self.columns.series[name]
        number = row if series.rows is None else int(series.rows.searchsorted(row, "right")) - 1
        return series.value(number) if number >= 0 or series.before else None

    def load(self, cut: Cut, row: int) -> None:
        """Slices see what there is in a row."""
        for name in self.columns.series:
            cut.sampler.known[cut.sampler.samples[name].first] = self._latest(name, row)


class Others:
    """What a property of slices reads on other topics than those that are sliced."""

    def __init__(self, session: Session, cut: Cut, of: Prepared) -> None:
        self._cut, self._of = cut, of
        self.topics = cut.window.read.difference(cut.keys)
        self._fields = {topic: session.fields.get(topic, ()) for topic in sorted(self.topics)}
        self._inputs = [i for i in cut.window.inputs if self.reads(i.signal)]
        self._readings = [s for s in cut.signals if isinstance(s, Reading) and self.reads(s.name)]
        self.atoms = [n for n, atom in enumerate(of.atoms) if any(map(self.reads, _signals(atom.holds)))]
        self._guards = [guard for guard in of.guards if any(map(self.reads, _signals(guard)))]
        told = [n for n, atom in enumerate(of.atoms) if isinstance(atom.holds, News)]
        self._own_news = sum(1 << n for n in told if n not in self.atoms)
        self._news = sum(1 << n for n in told if n in self.atoms)
        self._held = 0

    def reads(self, signal: str) -> bool:
        """Whether it is a signal that slices share."""
        topics = self._cut.sampler.topics[signal]
        return signal != self._cut.variable and bool(topics) and topics.isdisjoint(self._cut.keys)

    def refusal(self) -> str:
        """Why columns cannot judge the property; empty if they can."""
        of, cut = self._of, self._cut
        read = [_signals(each) for each in (*(atom.holds for atom in of.atoms), *of.guards)]
        is_mixed = any(len({self.reads(signal) for signal in signals}) > 1 for signals in read)
        is_mixed |= any(not cut.sampler.topics[s.name] <= cut.keys.keys() for s in cut.signals if cut.is_own(s.name))
        is_simple = all(isinstance(i, New) or (isinstance(i, Input) and not i.ago) for i in self._inputs)
        is_simple &= {i.signal for i in self._inputs} <= {reading.name for reading in self._readings}
        if is_mixed:
            return "conditions on messages with an id and on others"
        if not is_simple:
            return "history, or what is computed, of topics that are not sliced"
        return "" if cut.ages <= cut.own_ages else "ages of topics that are not sliced"

    def of(self, block: Block) -> Shared:
        """What there is of it in a block. Raises UnsupportedError."""
        heard = {topic: rows_with(block, topic, read) for topic, read in self._fields.items()}
        given = Block(block.times, block.samples, heard)
        columns = Columns(given, self._cut.sampler, self._readings)
        steps = columns.steps(self._inputs, sorted(self._cut.window.topics & self.topics))
        if not_numbers(self._guards, steps) is not None:
            raise UnsupportedError("messages that make no step on topics that are not sliced")
        first = 0
        if any(not columns.series[i.signal].before for i in self._inputs if not isinstance(i, New)):
            first = steps.row(0) if len(steps) else len(block.times)
        letters = letters_of(self._of, steps, self.atoms)
        signals = frozenset(i.signal for i in self._inputs)
        return Shared(signals, columns, steps.rows(), letters, first, self._held, self._news, self._own_news)

    def keep(self, shared: Shared) -> None:
        """Slices go on from the end of a block."""
        shared.load(self._cut, shared.columns.count - 1)
        if len(shared.letters):
            self._held = int(shared.letters[-1]) & ~self._news


def _signals(expression: Expression) -> Sequence[str]:
    return [read.signal for read in reads_of(expression)]
