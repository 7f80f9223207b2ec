"""The messages that a guard may send, as they are sent, and as a recording of them would be read."""

from __future__ import annotations

from collections.abc import Mapping

from ltlc.inputs.messages.definitions import MessageTypes
from ltlc.inputs.messages.texts import defined
from ltlc.inputs.recordings.bags.definitions import Defined
from ltlc.inputs.recordings.bags.messages import batch_of
from ltlc.inputs.recordings.bags.plan import TopicReader
from ltlc.inputs.recordings.bags.written import nested, written
from ltlc.inputs.recordings.blocks import Block
from ltlc.runtime.sampling import Value
from ltlc.specification.expressions import Field, Signal
from ltlc.specification.guards import Fallback, Guard


def data_of(fallback: Fallback, guard: Guard, definition: str) -> bytes:
    """`fallback`, which `guard` may send, in CDR; its type is defined by the text `definition`."""
    types = defined(guard.message, "ros2msg", definition)
    return written(guard.message, types, nested({path: each.value for path, each in fallback.values.items()}))


def message_of(guard: Guard, values: Mapping[Signal, Value]) -> bytes:
    """A message that `guard` lets through, in CDR, with the single `values` that are known of it, else zero."""
    fields = [(each.definition.path, v) for each, v in values.items() if isinstance(each.definition, Field)]
    single = {
        tuple(map(str, path)): value
        for path, value in fields
        if path and not isinstance(value, tuple) and all(isinstance(step, str) for step in path)
    }
    return written(guard.message, defined(guard.message, "ros2msg", guard.definition), nested(single))


def samples_in(fallback: Fallback, guard: Guard, signals: Mapping[str, Signal]) -> dict[str, Value]:
    """The samples of `signals`, which are fields of what `guard` sends, in `fallback`, by name."""
    types = MessageTypes(defined(guard.message, "ros2msg", guard.definition))
    fields = {n: (signal, signal.definition) for n, signal in signals.items() if isinstance(signal.definition, Field)}
    reader = TopicReader(Defined(types, ()), guard.message, False, fields)
    rows = reader.rows(batch_of([data_of(fallback, guard, guard.definition)], [0], [0]))
    ((_, names, values, _),) = Block(rows.times, rows.samples, {}).rows({*fields})
    return dict(zip(names, values, strict=True))
