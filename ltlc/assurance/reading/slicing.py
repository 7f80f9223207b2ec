"""How an emitted node judges a property for each id, or each message."""

from __future__ import annotations

import ast

from ltlc.assurance.reading.python import PythonFile
from ltlc.assurance.reading.signals import data, require_signals
from ltlc.assurance.reading.trees import NotUnderstoodError
from ltlc.program.as_new import states_as_new
from ltlc.program.machine import Machine
from ltlc.specification.expressions import Field, Signal
from ltlc.specification.specification import MOST_IDS, Instances, PropertySpecification, Slicing, gone_name, topics_of


def require_slicing(
    file: PythonFile, said: ast.expr | None, machine: Machine, specification: PropertySpecification
) -> None:
    """Raises NotUnderstoodError unless a property is judged for each id, each message or none, as it is specified."""
    match said, specification.slicing:
        case None, None:
            return
        case ast.Call(ast.Name("Slicing"), [], keywords), Slicing() as slicing:
            right = _of_ids(slicing, machine, specification)
        case ast.Call(ast.Name("Instances"), [], keywords), Instances() as instances:
            right = _of_messages(instances)
        case _:
            raise NotUnderstoodError(f"`{machine.label}` is wrongly judged, or not judged, for each id")
    found = {each.arg: each.value for each in keywords}
    require_signals(file, found.pop("signals", None), (wanted.signal for wanted in specification.inputs()))
    if {name: data(value) for name, value in found.items()} != right:
        raise NotUnderstoodError(f"`{machine.label}` is not sliced as it should be")


def _of_ids(slicing: Slicing, machine: Machine, specification: PropertySpecification) -> dict[str, object]:
    """What slices a run by its ids."""
    return {
        "keys": tuple(_key(key, slicing, specification) for key in slicing.keys),
        "variable": slicing.variable,
        "limit": slicing.limit or MOST_IDS,
        "as_new": ("frozenset", sorted(states_as_new(machine, specification, slicing))),
    }


def _of_messages(instances: Instances) -> dict[str, object]:
    """What opens instances."""
    return {
        "name": instances.signal.heard,
        "topic": topics_of(instances.signal)[0],
        "mark": instances.mark.name,
        "limit": instances.limit or MOST_IDS,
    }


def _key(key: Signal, slicing: Slicing, specification: PropertySpecification) -> tuple[object, ...]:
    """The ids of a topic, in the runtime's terms."""
    assert isinstance(key.definition, Field)
    topic = key.definition.topic
    arrays = [a for a in slicing.arrays if isinstance(a.definition, Field) and a.definition.topic == topic]
    elements = {array.name: slicing.element_of(array) for array in arrays}
    gone = gone_name(key.name)
    is_asked = any(wanted.signal.name == gone for wanted in specification.inputs())
    return (
        "Key",
        topic,
        key.name,
        *([("elements", elements)] if elements else []),
        *([("gone", gone)] if is_asked else []),
    )
