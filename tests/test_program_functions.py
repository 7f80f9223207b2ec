"""The table of functions: every spelling in Python and in C is run on edge values against the reference for values."""

from __future__ import annotations

import ctypes
import math
import random
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import program_reference as reference
import pytest
from conditions_support import EVERY, ROUNDS, cases, conditions, hostile, wanted

from ltlc.backends.c.expressions import C
from ltlc.backends.c.functions import texts
from ltlc.backends.c.types import plural, pointer
from ltlc.backends.operators import flat as flat_in_c
from ltlc.backends.python.code import flat
from ltlc.backends.python.expressions import python_speller
from ltlc.backends.spelling import NotInTargetError
from ltlc.program.expressions import Apply, Each, Expression, makes_nan, parts
from ltlc.program.functions import ROWS, Nan, Primitive
from ltlc.program.lowering import condition, read
from ltlc.program.types import Scalar, Type, type_of
from ltlc.runtime import functions
from ltlc.specification.evaluation import is_true
from ltlc.specification.expressions import Condition, Read


@pytest.mark.parametrize("text", EVERY)
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


@pytest.mark.parametrize("text", EVERY)
def test_a_result_is_nan_where_its_row_says(text: str) -> None:
    chance = random.Random(text)
    for what in conditions(text):
        whole = [part for part in parts(condition(what)) if isinstance(part, Apply) and part.type.is_number]
        applied = [part for part in whole if not any(isinstance(inner, Each) for inner in parts(part))]
        for values in [hostile(what, chance) for _ in range(ROUNDS)]:
            given: dict[Expression, Any] = {read(each): value for each, value in values.items()}
            for part in applied:
                of_nan = any(reference.is_nan(reference.value(argument, given)) for argument in part.arguments)
                passes = of_nan and ROWS[part.primitive].nan in (Nan.STRICT, Nan.PARTIAL)
                found = reference.is_nan(reference.value(part, given))
                assert found >= passes, (part, values)
                assert found <= (passes or makes_nan(part)), (part, values)


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
    for text in EVERY:
        for what in conditions(text):
            for holds in (True, False):
                try:
                    body = _function(target, what, holds, f"f{len(bodies)}")
                except NotInTargetError:
                    continue
                names[what, holds] = f"f{len(bodies)}"
                bodies.append(body)
    source = folder / "all.c"
    source.write_text("\n".join([*_head(target, bodies), *bodies]), encoding="utf-8")
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


def _head(target: C, bodies: Sequence[str]) -> Iterator[str]:
    yield from ("#include <float.h>", "#include <math.h>", "#include <stdbool.h>")
    yield from ("#include <stddef.h>", "#include <stdint.h>")
    for type_ in target.arrays:
        yield f"typedef struct {{ {pointer(type_)}elements; size_t length; }} m_{plural(type_)};"
    counts = [text for _, text in target.counts.values()]
    yield from (*texts("\n".join([*bodies, *counts]), target.arrays, "m"), *counts)


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


@pytest.mark.parametrize("text", EVERY)
def test_every_spelling_in_c_is_what_the_reference_says(text: str, in_c: InC) -> None:
    for what, values in cases(text):
        for holds in (True, False):
            function = in_c(what, holds)
            if function is not None:
                assert function(values) is (is_true(what, values) == holds), (text, holds, values)


def test_the_conditions_have_every_primitive() -> None:
    whole = (condition(what) for text in EVERY for what in conditions(text))
    assert {part.primitive for each in whole for part in parts(each) if isinstance(part, Apply)} == set(Primitive)
