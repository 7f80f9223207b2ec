"""A specification as a plan of the runtime, made by running the code that is emitted for nodes, too."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import Any

from ltlc.backends.python.plan import plan_code
from ltlc.compiler import Compiled
from ltlc.runtime import functions, sampling, session, times, tracking
from ltlc.runtime.session import Plan
from ltlc.semantics import verdicts
from ltlc.specification.specification import Specification


def load_plan(compiled: Sequence[Compiled], specification: Specification, given: Collection[str] = ()) -> Plan:
    """The plan of a run in which the signals called `given` come in themselves."""
    namespace: dict[str, Any] = {"INFINITY": math.inf}
    for module in (verdicts, functions, times, sampling, tracking, session):
        namespace |= vars(module)
    code = "from __future__ import annotations\n" + plan_code(compiled, specification, given)
    exec(compile(code, "<plan>", "exec"), namespace)
    plan = namespace["plan"]()
    assert isinstance(plan, Plan)
    return plan
