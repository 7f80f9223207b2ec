"""Runs that show something: steps with numbers, checked against the reference before they are shown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ltlc.analysis.groups import reads_of
from ltlc.analysis.letters import Letters, steps_of
from ltlc.analysis.thresholds import Values
from ltlc.dataclass import dataclass
from ltlc.semantics.durations import Nanoseconds
from ltlc.semantics.instants import Instant
from ltlc.semantics.openings import open_part
from ltlc.semantics.timed_atoms import Clock
from ltlc.semantics.words import Lasso, Letter, Word
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import letter
from ltlc.specification.expressions import New, Opening
from ltlc.specification.text import read_texts


@dataclass(frozen=True, slots=True)
class Example:
    """A run: for each step the values of the signals, headed by `signals`, and a remark, which may be empty.

    If `loop` is not None, the steps from that one on repeat forever. Of a run in time, `times` has the time of each
    row, and a row whose number is in `by_time` is no step: there, something changes because time has passed.
    """

    caption: str
    signals: tuple[str, ...]
    steps: tuple[tuple[Any, ...], ...]
    remarks: tuple[str, ...]
    loop: int | None = None
    times: tuple[Nanoseconds, ...] = ()
    by_time: frozenset[int] = frozenset()

    def as_json(self) -> dict[str, Any]:
        """The form in which JSON output and diagnostics carry it."""
        steps: list[dict[str, Any]] = [
            {"values": dict(zip(self.signals, values, strict=True)), "remark": remark}
            for values, remark in zip(self.steps, self.remarks, strict=True)
        ]
        for row, time in enumerate(self.times):
            steps[row] |= {"time_ns": time, "by_time": row in self.by_time}
        return {"caption": self.caption, "steps": steps, "loop": self.loop}


@dataclass(frozen=True, slots=True)
class Setting:
    """What numbers for an example are found with: the atoms it is about, and the letters of the file.

    If `linked`, every step is a sample of every signal, so that history follows from the steps before. `openings` are
    the values at an opening that are read, with the clocks that start where they are taken. If it `counts`, no numbers
    are found: letters do not have how often something occurred.
    """

    atoms: tuple[Atom, ...]
    letters: Letters
    linked: bool
    openings: Mapping[Opening, Clock]
    counts: bool


def example_of(
    setting: Setting, word: Word, caption: str, remarks: Sequence[str] = (), loop: int | None = None
) -> Example | None:
    """An example whose steps have the letters of `word`; None if no numbers for it are found.

    The values are evaluated again here: a step is shown only if it has the letter that it is to have. Where nothing but
    time comes between two rows, the second is shown only if its remark is another one, or if it is all that repeats.
    """
    rows = values_of(setting, word, loop)
    if rows is None:
        return None
    said = tuple(remarks) or ("",) * len(word)
    numbers = telling(word, said, loop)
    return Example(
        caption,
        tuple(rows[0]),
        tuple(tuple(rows[n].values()) for n in numbers),
        tuple(said[n] for n in numbers),
        None if loop is None else sum(n < loop for n in numbers),
        tuple(letter.time for n in numbers if isinstance(letter := word[n], Instant)),
        frozenset(row for row, n in enumerate(numbers) if is_held(word[n])),
    )


def is_held(letter: Letter) -> bool:
    """Whether there is no step, but time passes while a letter is held."""
    return isinstance(letter, Instant) and letter.by_time


def telling(word: Word, said: Sequence[object], loop: int | None) -> list[int]:
    """The numbers of the letters of `word` that are shown, if `said` is what is to be said at each."""
    shown = [n for n, letter in enumerate(word) if not is_held(letter) or said[n] != said[n - 1]]
    return shown if loop is None or any(n >= loop for n in shown) else [*shown, loop]


def values_of(setting: Setting, word: Word, loop: int | None) -> list[dict[str, Any]] | None:
    """What each signal is, for people, at each letter of `word`; None if no numbers for it are found."""
    rows = rows_of(setting, word, loop)
    return None if rows is None else shown(setting, rows)


def shown(setting: Setting, rows: Sequence[Values]) -> list[dict[str, Any]]:
    """`rows` by the names of the signals, for people."""
    reads = list(dict.fromkeys(value for atom in setting.atoms for value in reads_of(atom.condition)))
    named = list(zip(read_texts(reads), reads, strict=True))
    return [{name: for_people(row[value]) for name, value in named} for row in rows]


def rows_of(setting: Setting, word: Word, loop: int | None) -> list[Values] | None:
    """Values that give the letters of `word`, held without news where nothing but time comes between two rows.

    None if no numbers are found.
    """
    if setting.counts:
        return None
    held = list(map(is_held, word))
    names = {atom.name for atom in setting.atoms}
    steps = tuple(letter & names for letter, by_time in zip(word, held, strict=True) if not by_time)
    taken = _taken(setting.openings, word, held, loop)
    if taken is None:
        return None
    found = steps_of(setting.atoms, steps, setting.letters, setting.linked and loop is None, taken)
    if found is None:
        return None
    rows: list[Values] = []
    following = iter(found)
    for by_time in held:
        rows.append(_without_news(rows[-1]) if by_time else next(following))
    return rows if _is_exact(setting.atoms, rows, word) else None


def _taken(
    openings: Mapping[Opening, Clock], word: Word, held: Sequence[bool], loop: int | None
) -> dict[tuple[Opening, int], int] | None:
    """At which step each value at an opening was taken; None where that differs from one turn of the loop to another.

    A scope is open or not after a turn as it is after any later one, once every scope has had a turn to settle.
    """
    turn = [] if loop is None else list(range(loop, len(word)))
    places = [*range(len(word)), *(turn * (len(openings) + 1))]
    steps = [sum(not by_time for by_time in held[: place + 1]) - 1 for place in places]
    run = tuple(word[place] for place in places)
    found: dict[tuple[Opening, int], int] = {}
    for opening, clock in openings.items():
        for now, step in enumerate(steps):
            part = open_part(run[:now], clock)
            source = step if part is None else steps[now - len(part)]
            if found.setdefault((opening, step), source) != source and not held[places[now]]:
                return None
    return found


def _without_news(values: Values) -> Values:
    return {value: False if isinstance(value, New) else given for value, given in values.items()}


def example_of_lasso(setting: Setting, lasso: Lasso, caption: str) -> Example | None:
    """An example that repeats the loop of `lasso` forever."""
    return example_of(setting, lasso.stem + lasso.loop, caption, loop=len(lasso.stem))


def _is_exact(atoms: tuple[Atom, ...], steps: Sequence[Values], word: Word) -> bool:
    names = {atom.name for atom in atoms}
    return all(letter(atoms, values) == wanted & names for values, wanted in zip(steps, word, strict=True))


def for_people(value: Any) -> Any:
    """A value for people and JSON: whole numbers without a point, arrays as lists."""
    if isinstance(value, tuple):
        return [for_people(element) for element in value]
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return int(value)
    return value
