"""Runs that show something: steps with numbers, checked against the reference before they are shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ltlc.analysis.groups import inputs_of
from ltlc.analysis.letters import Letters, steps_of
from ltlc.analysis.thresholds import Values
from ltlc.semantics.words import Lasso, Word
from ltlc.specification.atoms import Atom
from ltlc.specification.evaluation import letter
from ltlc.specification.text import text


@dataclass(frozen=True, slots=True)
class Example:
    """A run: for each step the values of the signals, headed by `signals`, and a remark, which may be empty.

    If `loop` is not None, the steps from that one on repeat for ever.
    """

    caption: str
    signals: tuple[str, ...]
    steps: tuple[tuple[Any, ...], ...]
    remarks: tuple[str, ...]
    loop: int | None = None

    def as_json(self) -> dict[str, Any]:
        """The form in which JSON output and diagnostics carry it."""
        steps = [
            {"values": dict(zip(self.signals, values, strict=True)), "remark": remark}
            for values, remark in zip(self.steps, self.remarks, strict=True)
        ]
        return {"caption": self.caption, "steps": steps, "loop": self.loop}


@dataclass(frozen=True, slots=True)
class Setting:
    """What numbers for an example are found with: the atoms it is about, and the letters of the file.

    If `linked`, every step is a sample of every signal, so that history follows from the steps before.
    """

    atoms: tuple[Atom, ...]
    letters: Letters
    linked: bool


def example_of(
    setting: Setting, word: Word, caption: str, remarks: Sequence[str] = (), loop: int | None = None
) -> Example | None:
    """An example whose steps have the letters of `word`; None if no numbers for it are found.

    The values are evaluated again here: a step is shown only if it has the letter that it is to have.
    """
    steps = steps_of(setting.atoms, word, setting.letters, setting.linked and loop is None)
    if steps is None or not _is_exact(setting.atoms, steps, word):
        return None
    inputs = list(dict.fromkeys(value for atom in setting.atoms for value in inputs_of(atom.condition)))
    rows = tuple(tuple(_shown(values[value]) for value in inputs) for values in steps)
    return Example(caption, tuple(map(text, inputs)), rows, tuple(remarks) or ("",) * len(rows), loop)


def example_of_lasso(setting: Setting, lasso: Lasso, caption: str) -> Example | None:
    """An example that repeats the loop of `lasso` for ever."""
    return example_of(setting, lasso.stem + lasso.loop, caption, loop=len(lasso.stem))


def _is_exact(atoms: tuple[Atom, ...], steps: Sequence[Values], word: Word) -> bool:
    names = {atom.name for atom in atoms}
    return all(letter(atoms, values) == wanted & names for values, wanted in zip(steps, word, strict=True))


def _shown(value: Any) -> Any:
    """A value for people and JSON: whole numbers without a point, arrays as lists."""
    if isinstance(value, tuple):
        return [_shown(element) for element in value]
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return int(value)
    return value
