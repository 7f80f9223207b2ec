"""A specification as a plan of the runtime, made by running the code that is emitted for nodes, too."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Collection, Iterable, Sequence
from types import ModuleType
from typing import Any

from ltlc.backends.names import Names, input_name
from ltlc.backends.python.code import flat
from ltlc.backends.python.expressions import python_speller
from ltlc.backends.python.monitors import MODULE_NAMES
from ltlc.backends.python.plan import RUNTIME_NAMES, plan_code
from ltlc.compiler import Compiled
from ltlc.program.expressions import Expression as TypedExpression
from ltlc.program.guards import GuardProgram
from ltlc.program.lowering import condition, lowered, read
from ltlc.runtime import functions, guard_plans, properties, sampling, session, slices, times
from ltlc.runtime.sampling import Value
from ltlc.runtime.session import Plan
from ltlc.semantics import verdicts
from ltlc.specification.expressions import Condition, Expression, Read
from ltlc.specification.specification import Specification


def load_function(expression: Expression, wanted: Sequence[Read]) -> Callable[..., Value]:
    """`expression` as a function of what it reads, which is `wanted`."""
    function = _loaded([lowered(expression)], wanted)
    return lambda *values: function(*values)[0]


def load_conditions(conditions: Iterable[Condition], wanted: Sequence[Read]) -> Callable[..., Sequence[bool]]:
    """Whether each of `conditions` holds, as a function of what they read, which is `wanted`."""
    return _loaded(map(condition, conditions), wanted)


def _loaded(expressions: Iterable[TypedExpression], wanted: Sequence[Read]) -> Callable[..., Any]:
    """The values of `expressions` as a function of what they read."""
    local = Names(RUNTIME_NAMES | MODULE_NAMES)
    names: dict[TypedExpression, str] = {read(each): local.unique(input_name(read(each))) for each in wanted}
    speller = python_speller(names)
    code = "".join(f"{flat(speller.code(each))}, " for each in expressions)
    function: Callable[..., Any] = eval(f"lambda {', '.join(names.values())}: ({code})", _namespace(functions))
    return function


def load_plan(
    compiled: Sequence[Compiled],
    specification: Specification,
    given: Collection[str] = (),
    guards: Sequence[GuardProgram] = (),
) -> Plan:
    """The plan of a run in which the signals called `given` come in themselves, and `guards` keep properties."""
    namespace = _namespace(verdicts, functions, times, sampling, guard_plans, properties, session, slices)
    code = "from __future__ import annotations\n" + plan_code(compiled, specification, given, guards=guards)
    exec(compile(code, "<plan>", "exec"), namespace)
    plan = namespace["plan"]()
    assert isinstance(plan, Plan)
    return plan


def _namespace(*modules: ModuleType) -> dict[str, Any]:
    """What emitted code may call."""
    names: dict[str, Any] = {"INFINITY": math.inf, "deque": deque, "math": math}
    for module in modules:
        names |= vars(module)
    return names
