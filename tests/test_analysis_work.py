"""What is asked of z3 ends after so much work, not after so much time: the answers are the same at any load."""

from __future__ import annotations

from functools import reduce

import pytest

from ltlc.analysis import lassos, solving
from ltlc.base.source import Source
from ltlc.frontend.language import load_text
from ltlc.semantics.alphabet import Alphabet
from ltlc.semantics.ltl import And, Atom, Formula, Not, Or


def test_letters_that_take_more_work_than_allowed_are_left_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "decl x /x Float64.data\ndecl y /y Float64.data\nnever x * y > 1 and x + y < 1 and x * x - y * x == 3\n"
    specification, _ = load_text(Source("props.txt", text))
    assert specification is not None
    atoms = specification.properties[0].atoms
    assert solving.valuations(atoms) is not None
    monkeypatch.setattr(solving, "WORK", 1)
    assert solving.valuations(atoms) is None


def test_a_search_for_a_run_that_takes_more_work_than_allowed_gives_up(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not gives_up(pigeons=7, holes=6)
    monkeypatch.setattr(lassos, "WORK", 1_000)
    assert gives_up(pigeons=7, holes=6)


def gives_up(pigeons: int, holes: int) -> bool:
    """Whether the search gives up on a run in which each pigeon has a hole of its own, of which there are too few."""
    rows = [[Atom(f"p{pigeon}_{hole}") for hole in range(holes)] for pigeon in range(pigeons)]
    together = [And(a, b) for k, row in enumerate(rows) for other in rows[:k] for a, b in zip(row, other, strict=True)]
    formulas: list[Formula] = [*(reduce(Or, row[1:], row[0]) for row in rows), *map(Not, together)]  # type: ignore[arg-type]
    search = lassos.LassoSearch(formulas, Alphabet(tuple(a.name for row in rows for a in row), ()), 1)
    assert search.find(dict.fromkeys(range(len(formulas)), True)) is None
    return search.gave_up
