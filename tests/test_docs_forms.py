"""The table in `docs/language.md` of which form works where is so, cell by cell."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from stepping import from_text

from ltlc import backends
from ltlc.backends import c
from ltlc.backends.python.load import load_plan
from ltlc.backends.spelling import NotInTargetError
from ltlc.frontend.language.each import refusals

PAGE = (Path(__file__).parents[1] / "docs/language.md").read_text(encoding="utf-8")
LINES = re.findall(r"^\|.*\|$", PAGE.partition("\n## Where each form works\n")[2], re.MULTILINE)
HEAD, _, *ROWS = ([cell.strip() for cell in line.split("|")[1:-1]] for line in LINES)

DECLARED = """decl v /v Float64.data
decl b /b Bool.data
decl k /t JoyFeedback.id
decl val /t JoyFeedback.intensity
decl scan /scan LaserScan.ranges
decl spot /spot PointStamped.point
zone kitchen = [(0, 0), (4, 0), (4, 3)]
object cup /cup Odometry
object cat /cat Odometry
p: """

FORMS: dict[str, list[str]] = {
    "`once p N times`, `rate(s)`": ["never once b 3 times within 2 s", "always rate(v) >= 2 Hz over 1 s"],
    "`each`": ["each i of k{}: never val > 3"],
    "`each new`": ["each new v{}: eventually b within 1 s"],
    "`@{s, -n else c}`": ["always v - @{v, -1 else 0} < 2"],
    "`@{s, when p}`, `@{p, -n}` and `@{p, -n:}` of a predicate that compares what can be NaN": [
        "never v > @{v, when b}",
        "always @{v > 1, -1} or b",
        "never all(@{v > 1, -2:})",
    ],
    "`sqrt`, `exp`, `log`, `sin` and the like, `hypot`, `norm`, `sum`, `mean`, `distance(…, zone)`; "
    "angles, distances and speeds of objects": [
        *(f"never {function}(v) > 1" for function in ("sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos")),
        *("never atan2(v, 1) > 1", "never hypot(v, 1) > 1", "never norm(spot) > 1", "never sum(scan) > 1"),
        *("never mean(scan) > 1", "never distance(v, v, kitchen) > 1", "never cup.distance.cat < 1"),
        *("never cup.velocity > 1", "never cup.orientation > 1"),
    ],
}
"""Properties of each form; `{}` is where a `limit` stands."""


def loaded(text: str) -> None:
    compiled, specification = from_text(DECLARED + text)
    load_plan(compiled, specification)


def emitted(target: str, text: str) -> None:
    compiled, specification = from_text(DECLARED + text)
    if target == "c":
        c.emit(compiled, specification)
    else:
        backends.emit(target, compiled, specification)


def mined(text: str) -> None:
    _, specification = from_text(DECLARED + text)
    if refusals(specification, "mined"):
        raise NotInTargetError("`each`")


WAYS: dict[str, Callable[[str], None]] = {
    "`run`, `ltlc.monitor`": loaded,
    "node, package": lambda text: emitted("ros2", text),
    "`--target python`": lambda text: emitted("python", text),
    "C": lambda text: emitted("c", text),
    "Rust": lambda text: emitted("rust", text),
    "`mine`, `compare`": mined,
}


def cells() -> Iterator[tuple[str, str, str]]:
    """What stands in each cell: the form, the way, and whether it works."""
    for form, *said in ROWS:
        yield from ((form, way, cell) for way, cell in zip(HEAD[1:], said, strict=True))


@pytest.mark.parametrize(("form", "way", "cell"), list(cells()))
def test_a_form_works_where_the_table_says_so_and_is_refused_where_it_does_not(form: str, way: str, cell: str) -> None:
    for property_ in FORMS[form]:
        limited, unlimited = property_.replace("{}", " limit 5"), property_.replace("{}", "")
        works = {"yes": [limited, unlimited], "no": []}.get(cell, [limited])
        for text in works:
            WAYS[way](text)
        for text in {limited, unlimited}.difference(works):
            with pytest.raises(NotInTargetError):
                WAYS[way](text)
