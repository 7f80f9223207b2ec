"""`ltlc.dataclass` does what `dataclasses.dataclass` does."""

from __future__ import annotations

import ast
import copy
import dataclasses
import inspect
import operator
import pickle
from collections.abc import Callable, Mapping
from dataclasses import field
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import pytest

from ltlc.dataclass import dataclass

PROJECT = Path(__file__).parents[1]
STANDING_ALONE = (
    "ltlc/backends/ros2/node",
    "ltlc/assurance/evidence/recorded.py",
)
"""What is written into files that need no ltlc."""

Classes = Mapping[str, Any]


def classes(decorator: Callable[..., Any], **options: bool) -> Classes:
    """Classes of all kinds, made by `decorator`."""
    decorated = decorator(frozen=True, **options)

    @decorated
    class Empty:
        """No fields."""

    @decorated
    class Point:
        """Two fields, one with a default."""

        x: float
        y: float = 0.5

    @decorated
    class Named(Point):
        """Fields of its own after those of another; two are not compared."""

        names: list[str] = field(default_factory=list, compare=False)
        note: str = field(default="", repr=False, compare=False)
        last: int = field(default=7, kw_only=True)

    @decorated
    class Sum:
        """Fields that the caller does not give."""

        parts: tuple[int, ...]
        total: int = field(init=False)
        kind: str = field(init=False, default="sum")
        seen: dict[int, int] = field(init=False, default_factory=dict, compare=False)

        def __post_init__(self) -> None:
            object.__setattr__(self, "total", sum(self.parts))

    @decorated
    class Alike:
        """Fields whose names are alike, and like those of what sets them."""

        set: list[int] = field(default_factory=list)
        _set: int = 1
        missing: int = 2
        _missing: int = 3

    @decorated
    class Own:
        """Methods of its own."""

        x: int

        def __repr__(self) -> str:
            return "own"

        def __eq__(self, other: object) -> bool:
            return isinstance(other, Own) and other.x % 10 == self.x % 10

        def __hash__(self) -> int:
            return self.x % 10

    @decorated
    class Equal:  # noqa: PLW1641  the hash is made
        """An equality of its own, beside which a hash is made."""

        x: int

        def __eq__(self, other: object) -> bool:
            return self is other

    return {each.__name__: each for each in (Empty, Point, Named, Sum, Alike, Own, Equal)}


def instances(of: Classes) -> list[Any]:
    """Some of each class, some of them equal."""
    numbers = [(x, y) for x in ("0", "1", "nan") for y in ((), ("0.5",), ("nan",))]
    points = [of["Point"](float(x), *map(float, y)) for x, y in numbers]  # each NaN is another, as in any two messages
    named = [of["Named"](1.0, names=["a"], last=1), of["Named"](1.0, 0.5, ["b"], "c", last=1), of["Named"](1.0)]
    rest = [
        of["Empty"](),
        of["Empty"](),
        of["Sum"]((1, 2)),
        of["Sum"](parts=(3,)),
        of["Own"](1),
        of["Own"](11),
        of["Alike"](),
        of["Alike"]([1], 2, 3, 4),
    ]
    return [*points, *named, *rest, of["Equal"](1), of["Equal"](1)]


def is_by_identity(instance: object) -> bool:
    """Whether an instance is hashed as an object is."""
    return type(instance).__hash__ is object.__hash__


def outcome(function: Callable[..., object], *arguments: object) -> object:
    """What comes of a call: its result, or the type of its error."""
    try:
        return function(*arguments)
    except Exception as error:
        return type(error)


@pytest.fixture(
    params=[{}, {"slots": True}, {"eq": False}, {"slots": True, "eq": False}, {"slots": True, "order": True}],
    ids=" ".join,
)
def both(request: pytest.FixtureRequest) -> tuple[Classes, Classes]:
    """The same classes, made by ltlc and by the standard library."""
    return classes(dataclass, **request.param), classes(dataclasses.dataclass, **request.param)


def test_instances_are_shown_and_hashed_alike(both: tuple[Classes, Classes]) -> None:
    made, defined = map(instances, both)
    assert list(map(repr, made)) == list(map(repr, defined))
    told = [[each for each in all_ if "nan" not in repr(each)] for all_ in (made, defined)]  # whose hash is its address
    hashed = [[is_by_identity(each) or outcome(hash, each) for each in all_] for all_ in told]
    assert hashed[0] == hashed[1]


@pytest.mark.parametrize("compare", [operator.eq, operator.ne, operator.lt, operator.le, operator.gt, operator.ge])
def test_instances_compare_alike(both: tuple[Classes, Classes], compare: Callable[[Any, Any], bool]) -> None:
    made, defined = ([outcome(compare, a, b) for a in all_ for b in all_] for all_ in map(instances, both))
    assert made == defined
    assert compare not in (operator.eq, operator.ne) or {True, False} <= set(made)


def test_fields_are_given_and_matched_alike(both: tuple[Classes, Classes]) -> None:
    for name, made in both[0].items():
        defined = both[1][name]
        given = [
            tuple((p.name, p.kind, p.annotation) for p in inspect.signature(each).parameters.values())
            for each in (made, defined)
        ]
        assert given[0] == given[1]
        assert made.__match_args__ == defined.__match_args__
        assert made.__init__.__qualname__ == defined.__init__.__qualname__
        assert hasattr(made, "__slots__") == hasattr(defined, "__slots__")
    wrongs: list[dict[str, float]] = [{}, {"x": 1, "z": 2}]
    for wrong in wrongs:
        assert [outcome(partial(each["Point"], **wrong)) for each in both] == [TypeError, TypeError]


def test_an_instance_cannot_be_changed_but_replaced(both: tuple[Classes, Classes]) -> None:
    point = both[0]["Named"](1.0, names=["a"])
    changes: list[Callable[[], None]] = [
        partial(setattr, point, "x", 2.0),
        partial(setattr, point, "new", 1),
        partial(delattr, point, "x"),
    ]
    for change in changes:
        with pytest.raises(dataclasses.FrozenInstanceError):
            change()
    assert dataclasses.asdict(dataclasses.replace(point, x=2.0)) == dataclasses.asdict(point) | {"x": 2.0}


def test_a_default_is_made_anew_for_each_instance(both: tuple[Classes, Classes]) -> None:
    for name, attribute, argument in (("Named", "names", 1.0), ("Sum", "seen", (1,))):
        first, second = (both[0][name](argument) for _ in range(2))
        assert getattr(first, attribute) is not getattr(second, attribute)


@dataclass(frozen=True, slots=True)
class Kept:
    """To be copied."""

    x: int
    values: list[int] = field(default_factory=list)


@dataclass(frozen=True)
class Computed:
    """To be copied, without slots."""

    x: int

    @cached_property
    def double(self) -> int:
        return 2 * self.x


@pytest.mark.parametrize("one", [Kept(1, [2]), Computed(3)])
def test_copies_and_pickles_are_equal(one: Any) -> None:
    for again in (copy.copy(one), copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
        assert again == one
        assert again is not one


def test_a_class_that_is_not_frozen_can_be_changed() -> None:
    @dataclass
    class Counter:
        """Counts."""

        count: int = 0

    counter = Counter()
    counter.count += 1
    assert counter == Counter(1)


def test_every_class_of_ltlc_is_made_quickly() -> None:
    slow = []
    for path in sorted((PROJECT / "ltlc").rglob("*.py")):
        name = str(path.relative_to(PROJECT))
        if name.startswith(STANDING_ALONE) or name == "ltlc/dataclass.py":
            continue
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.ImportFrom) and node.module == "dataclasses":
                slow += [f"{name}:{node.lineno}" for alias in node.names if alias.name == "dataclass"]
    assert slow == []
