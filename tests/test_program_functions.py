"""The table of functions: every spelling in Python and in C is run on edge values against the reference for values."""

from __future__ import annotations

import ctypes
import math
import random
import shutil
import struct
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from language_support import compiled

from ltlc.backends.c.code import flat as flat_in_c
from ltlc.backends.c.expressions import C
from ltlc.backends.c.functions import texts
from ltlc.backends.c.types import plural, pointer
from ltlc.backends.python.code import flat
from ltlc.backends.python.expressions import python_speller
from ltlc.backends.spelling import NotInTargetError
from ltlc.program.expressions import Apply, Expression, parts
from ltlc.program.functions import Primitive
from ltlc.program.lowering import condition, read
from ltlc.program.types import Scalar, Type, type_of
from ltlc.runtime import functions
from ltlc.specification.atoms import Comparison, Condition, operands
from ltlc.specification.evaluation import is_true, is_undefined
from ltlc.specification.expressions import Current, Read, Signal, reads
from ltlc.specification.expressions import Expression as Computed

FIELDS = {
    "i8": "Int8", "u8": "UInt8", "i16": "Int16", "i32": "Int32", "u32": "UInt32", "i64": "Int64", "j64": "Int64",
    "u64": "UInt64", "w64": "UInt64", "s": "Float32", "t": "Float32", "x": "Float64", "y": "Float64", "z": "Float64",
    "on": "Bool", "off": "Bool", "mode": "String", "other": "String", "scan": "Float32MultiArray",
    "xs": "Float64MultiArray", "ids": "Int64MultiArray", "uids": "UInt64MultiArray", "bytes": "UInt8MultiArray",
}  # fmt: skip
DECLARED = "\n".join(
    [
        *(f"decl {name} /{name} std_msgs/{type_}.data" for name, type_ in FIELDS.items()),
        "decl names /joints JointState.name",
        "model robot: position /odom Odometry.pose.pose.position orientation /odom Odometry.pose.pose.orientation ;",
        "object sign at (1, 2, 3)",
        "object cart /cart Odometry",
        "",
    ]
)
PROPERTIES = """\
i8 > 2.5 | i8 >= -2.5 | u8 < 256 | u8 == 0.5 | u8 <= 3 | 3 < u8 | u8 >= 2.5 | u8 == u8 | i8 < i8 | i16 < i32 | u32 <= 7
i64 < j64 | i64 < u64 | u64 <= i64 | u64 > w64 | i64 == 9007199254740993 | i64 > 2.5 | i64 < x | x >= u64 | s < i64
i32 < i64 | u8 < u64 | u32 >= i64 | i8 == u64 | i64 == u64 | u64 == x | i64 == x | u64 > 18446744073709551614
s <= 0.3 | s > 0.5 | 0.5 < s | s < x | s == t | s =={0.1} 0.5 | x =={0.1} 0 | 0 =={0.5} x | x =={0.1} y | s =={0.1} t
x <{0.5} y | x >{0.5} 2 | abs(i64) > 5 | abs(i64) + 1 > x | -i64 < 3 | -u8 < 3 | abs(i8) > 3 | -s < t | abs(s) > 0.3
min(i64, j64) > 5 | min(i64, 3) > x | max(x, y, 3) > 5 | max(u64, i64) + 1 > 4 | min(s, 0.3) < 0.2 | min(u8, i8) < 1
max(i64, 3, j64) - x > 2 | sqrt(x) > 1.5 | x / y > 3 | x / 2 > 3 | x * y - 3 + s > 3 | (x + y) * (x - 1) < 0 - y
1 / x > 3 | on | on == off | on == true | on == false | mode == "a" | mode == other | mode in {"a", "b"} | mode == mode
min(scan) < 0.3 | max(scan[1:]) > 2 | sum(scan) > 2 | sum(bytes) > 201 | len(scan[1:-1]) < 3 | len(mode_names) > 1
min(ids) == 9007199254740993 | min(ids) + 1 > 5 | max(uids) / 2 > x | min(bytes) < 3 | max(ids) < i64 | sum(ids) > x
any(scan < 0.3) | all(scan < 0.3) | count(scan < 0.3) >= 2 | any(scan < x) | any(not scan < x) | any(scan > i64)
any(i64 <= scan) | any(abs(scan) > u64) | count(-scan < y) == 1 | any(ids == 5 or ids < j64) | any(uids > i64)
all(xs == x) | any(bytes > i8) | any(sqrt(xs) > 1) | any(mode_names == mode) | count(xs * x > y) > 1
any(xs[1:] > xs) | any(ids > x) | count(not (xs < y or xs == x)) > 0 | all(min(xs, y) < 1) | any(-ids > i64)
any(xs / y > x)
robot.distance.cart < 1 | robot.distanceZ.cart < 1 | robot.orientation.roll > 1 | robot.orientation.pitch > 1
robot.orientation.yaw > 1 | robot.orientation_between.cart < 1 | robot.distance.sign > 1
""".replace("mode_names", "names")
CONDITIONS = [text.strip() for line in PROPERTIES.splitlines() for text in line.split("|")]
ROUNDS = 60

EDGES = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.3,
    0.30000001192092896,
    0.1,
    0.5,
    2.0,
    2.5,
    1e-320,
    1e300,
    math.inf,
    -math.inf,
    2.0**53,
]
WIDE = [0, 1, 5, 2**53, 2**53 + 1, 2**63 - 1, 2**62]


@cache
def conditions(text: str) -> list[Condition]:
    """The conditions of `never TEXT`; of a signal that is computed, of what it is computed as."""
    (found,) = compiled(f"{DECLARED}never {text}\n").properties
    return [_written_out(atom.condition) for atom in found.atoms]


def _written_out(what: Condition) -> Condition:
    match what:
        case Comparison(Current(Signal(definition=Computed() as definition))):
            return replace(what, left=definition)
    return what


def wanted(what: Condition) -> list[Read]:
    """What a condition reads."""
    return list(dict.fromkeys(each for operand in operands(what) for each in reads(operand)))


def drawn(type_: Type, chance: random.Random) -> Any:
    """A value of a type, likely to be on an edge."""
    if type_.is_array:
        count = chance.choice([0, 1, 2, 3])
        nan = type_.scalar in (Scalar.SINGLE, Scalar.DOUBLE) and chance.random() < 1 / 3
        found = [drawn(type_.element, chance) for _ in range(count)]
        return tuple(math.nan if nan and chance.random() < 1 / 2 else value for value in found)
    match type_.scalar:
        case Scalar.BOOL:
            return chance.random() < 1 / 2
        case Scalar.TEXT:
            return chance.choice(["a", "b", "", "ä", "ab"])
        case Scalar.SINGLE:
            value = chance.choice(EDGES)
            return struct.unpack("f", struct.pack("f", value if abs(value) < 1e38 or math.isinf(value) else 1.0))[0]
        case Scalar.DOUBLE:
            return chance.choice([*EDGES, float(2**63), float(2**64)])
    numbers = type_.scalar.integers
    assert numbers is not None
    pool = [*WIDE, *(-n for n in WIDE), int(numbers.least), int(numbers.most), 2, 3]
    value = chance.choice([n for n in pool if numbers.least <= n <= numbers.most])
    return value if type_.scalar.is_wide else float(value)


def cases(text: str) -> Iterator[tuple[Condition, dict[Read, Any]]]:
    """Values at which a condition is asked for: none that it compares is NaN."""
    chance = random.Random(text)
    for what in conditions(text):
        for _ in range(ROUNDS):
            values = {each: drawn(type_of(each.signal), chance) for each in wanted(what)}
            if not is_undefined(what, values):
                yield what, values


@pytest.mark.parametrize("text", CONDITIONS)
def test_every_spelling_in_python_is_what_the_reference_says(text: str) -> None:
    namespace = {**vars(functions), "INFINITY": math.inf, "math": math}
    asked = 0
    for what, values in cases(text):
        names: dict[Expression, str] = {read(each): f"v{n}" for n, each in enumerate(values)}
        given = {names[read(each)]: value for each, value in values.items()}
        for holds in (True, False):
            code = flat(python_speller(names).code(condition(what), holds))
            assert eval(code, {**namespace, **given}) is (is_true(what, values) == holds), (code, given)
        asked += 1
    assert asked > ROUNDS / 4


InC = Callable[[Condition, bool], Callable[[dict[Read, Any]], bool] | None]


@pytest.fixture(scope="module")
def in_c(tmp_path_factory: pytest.TempPathFactory) -> InC:
    """Each condition, and each negation, as a function of C; None for what is refused."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("there is no C compiler here")
    folder = tmp_path_factory.mktemp("spellings")
    target = C("m")
    bodies: list[str] = []
    names: dict[tuple[Condition, bool], str] = {}
    for text in CONDITIONS:
        for what in conditions(text):
            for holds in (True, False):
                try:
                    body = _function(target, what, holds, f"f{len(bodies)}")
                except NotInTargetError:
                    continue
                names[what, holds] = f"f{len(bodies)}"
                bodies.append(body)
    source = folder / "all.c"
    source.write_text("\n".join([*_head(target), *bodies]), encoding="utf-8")
    command = [compiler, "-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "-ffp-contract=off", "-fPIC", "-shared"]
    done = subprocess.run(
        [*command, "all.c", "-o", "all.so", "-lm"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.stderr == ""
    library = ctypes.CDLL(str(folder / "all.so"))

    def function(what: Condition, holds: bool) -> Callable[[dict[Read, Any]], bool] | None:
        if (what, holds) not in names:
            return None
        found = getattr(library, names[what, holds])
        found.restype = ctypes.c_bool
        return lambda values: bool(found(*(_argument(type_of(e.signal), v) for e, v in values.items())))

    return function


def _function(target: C, what: Condition, holds: bool, name: str) -> str:
    names: dict[Expression, str] = {read(each): f"v{n}" for n, each in enumerate(wanted(what))}
    code = flat_in_c(target.speller(names).code(condition(what), holds))
    given = [target.declared(type_of(each.signal), f"v{n}") for n, each in enumerate(wanted(what))]
    used = " ".join(f"(void)v{n};" for n in range(len(given)))
    return f"bool {name}({', '.join(given)});\nbool {name}({', '.join(given)}) {{ {used} return {code}; }}"


def _head(target: C) -> Iterator[str]:
    yield from ("#include <float.h>", "#include <math.h>", "#include <stdbool.h>")
    yield from ("#include <stddef.h>", "#include <stdint.h>")
    for type_ in target.arrays:
        yield f"typedef struct {{ {pointer(type_)}elements; size_t length; }} m_{plural(type_)};"
    yield from texts(sorted(target.called), target.arrays, "m")
    yield from (text for _, text in target.counts.values())


class _Array(ctypes.Structure):
    _fields_ = (("elements", ctypes.c_void_p), ("length", ctypes.c_size_t))


def _argument(type_: Type, value: Any) -> Any:
    if not type_.is_array:
        return _scalar(type_)(_plain(type_, value))
    elements = (_scalar(type_) * max(1, len(value)))(*(_plain(type_, each) for each in value))
    found = _Array(ctypes.cast(elements, ctypes.c_void_p), len(value))
    found.kept = elements
    return found


def _scalar(type_: Type) -> Any:
    known = {
        Scalar.BOOL: ctypes.c_bool,
        Scalar.TEXT: ctypes.c_char_p,
        Scalar.SINGLE: ctypes.c_float,
        Scalar.DOUBLE: ctypes.c_double,
    }
    return known.get(type_.scalar) or getattr(ctypes, f"c_{type_.scalar.value}")


def _plain(type_: Type, value: Any) -> Any:
    return int(value) if type_.scalar.is_integer else value.encode() if isinstance(value, str) else value


@pytest.mark.parametrize("text", CONDITIONS)
def test_every_spelling_in_c_is_what_the_reference_says(text: str, in_c: InC) -> None:
    for what, values in cases(text):
        for holds in (True, False):
            function = in_c(what, holds)
            if function is not None:
                assert function(values) is (is_true(what, values) == holds), (text, holds, values)


def test_the_conditions_above_have_every_primitive() -> None:
    whole = (condition(what) for text in CONDITIONS for what in conditions(text))
    assert {part.primitive for each in whole for part in parts(each) if isinstance(part, Apply)} == set(Primitive)
