"""A property that is judged for each id, in C: a table of ids with monitors of their own, without a heap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ltlc.backends.c.samples import Samples
from ltlc.backends.c.types import type_name
from ltlc.backends.inputs import require_no_instances
from ltlc.backends.spelling import NotInTargetError
from ltlc.backends.trees import Text
from ltlc.compiler import Compiled
from ltlc.program.as_new import states_as_new
from ltlc.program.lowering import read
from ltlc.program.types import Scalar, type_of
from ltlc.specification.expressions import Signal
from ltlc.specification.specification import Slicing, Specification, topics, topics_of

MOST = 1 << 24
"""How many ids a table has places for, at most."""

NAMES = """
ids ids_advance ids_init ids_next_deadline ids_share ids_step ids_verdict left_out_of size slice slice_of
"""
"""What is declared for a table, after the prefix."""


@dataclass(frozen=True)
class Table:
    """The table of at most `limit` ids of type `key`, each with the monitors of one property.

    A slice in one of the states `as_new` is dropped. Samples have messages of a slice where one of `own` holds, and of
    all slices where one of `shared` does.
    """

    limit: int
    key: str
    as_new: tuple[int, ...]
    own: Sequence[Text]
    shared: Sequence[Text]

    @property
    def places(self) -> int:
        """How many there are: half of them are free, so that a search ends."""
        return 2 * self.limit

    def text(self) -> list[str]:
        """All that is particular of it, in C."""
        flags = (code.text for code in (*self.own, *self.shared))
        return [self.key, *map(str, (self.limit, *self.as_new)), *flags]


def table_of(compiled: Sequence[Compiled], samples: Samples) -> Table | None:
    """The table of ids, if there are ids; `samples` are those of all properties."""
    slicing = compiled[0].specification.slicing if compiled else None
    if not isinstance(slicing, Slicing):
        return None
    [one] = compiled
    assert slicing.limit is not None
    as_new = states_as_new(one.machine, one.specification, slicing)
    return Table(
        slicing.limit,
        type_name(_scalar(slicing.keys)),
        tuple(sorted(as_new)),
        samples.news(slicing.topics),
        samples.news(shared_topics(one, slicing)),
    )


def shared_topics(compiled: Compiled, slicing: Slicing) -> list[str]:
    """The topics whose messages all slices get."""
    return [topic for topic in topics(compiled.specification) if topic not in slicing.topics]


def require_a_table(compiled: Sequence[Compiled], specification: Specification) -> None:
    """Raise NotInTargetError if a property is judged for each id, and a table cannot be all that is needed for it."""
    require_no_instances(compiled)
    for each in compiled:
        if not isinstance(slicing := each.specification.slicing, Slicing):
            continue
        if slicing.limit is None:
            raise NotInTargetError("`each` without a limit", instead="write `limit N`: memory is reserved for N ids")
        if slicing.limit > MOST:
            raise NotInTargetError(f"`limit {slicing.limit}`, more than {MOST} ids")
        if len(compiled) > 1:
            raise NotInTargetError("`each` beside other properties: in C it needs a file of its own")
        if specification.rate is not None or specification.timeout is not None:
            raise NotInTargetError("`each` with `_rate_` or `_timeout_`")
        _ = _scalar(slicing.keys)
        _require_readable(each, slicing)


def _scalar(keys: Sequence[Signal]) -> Scalar:
    """The type of ids that are integers. Raises NotInTargetError of others."""
    scalars = {type_of(key).scalar for key in keys}
    if other := next((key for key in keys if type_of(key).scalar.bits == 0), None):
        raise NotInTargetError(f"`each` of `{other.name}`, whose ids are not integers")
    if len(scalars) == 1:
        return scalars.pop()
    if Scalar.UINT64 in scalars:
        raise NotInTargetError("`each` of ids that are uint64 and of others of another type")
    return Scalar.INT64


def _require_readable(compiled: Compiled, slicing: Slicing) -> None:
    """Raise NotInTargetError of what a slice knows and no message says, and of a slice that others might begin."""
    inputs = compiled.specification.inputs()
    made = next((i.signal.name for i in inputs if i.signal.name in slicing.made), None)
    if made == slicing.variable:
        raise NotInTargetError(f"`{made}`, an id that is read as a value")
    if made is not None:
        raise NotInTargetError(f"`{made}`")
    shared = shared_topics(compiled, slicing)
    ages = any(clock.age is not None for clock in compiled.machine.clocks)
    waited = (i.signal for i in inputs if read(i) in compiled.machine.waits_for)
    waits = any(not slicing.topics.isdisjoint(topics_of(signal)) for signal in waited)
    if shared and (ages or not waits):
        raise NotInTargetError(
            f"`each` with ages, or that waits for no value with an id, beside {shared[0]}, which has none"
        )
