"""A property that is judged from each message on, as what it says of the whole run: `always (new s implies P)`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ltlc.monitoring.columns.prepared import Prepared
from ltlc.monitoring.columns.session import ByBlocks
from ltlc.runtime import sampling
from ltlc.runtime.properties import MonitoredProperty
from ltlc.runtime.session import Plan, Session
from ltlc.semantics.properties import After, Always, Implies, Now
from ltlc.specification.atoms import with_reads
from ltlc.specification.expressions import New, Read
from ltlc.specification.specification import Instances, PropertySpecification


def of_whole_run(of: PropertySpecification) -> PropertySpecification:
    """What `of` says of the whole run, if it is judged from each message on. Coq: `each_step`."""
    if not isinstance(of.slicing, Instances):
        return of
    assert isinstance(of.property, After)
    mark, news = New(of.slicing.mark), New(of.slicing.signal)

    def of_any(read: Read) -> Read:
        return news if read == mark else read

    atoms = tuple(replace(atom, condition=with_reads(atom.condition, of_any)) for atom in of.atoms)
    said = Always(Implies(Now(of.property.event), of.property.body))
    return replace(of, atoms=atoms, property=said, slicing=None)


def whole_runs(
    plan: Plan, specifications: Sequence[PropertySpecification], prepared: Sequence[Prepared]
) -> ByBlocks | None:
    """What takes, as of one run, the properties of `plan` that are judged from each message on; None if none is.

    It is there for the samples that it keeps, and its verdicts are of no use.
    """
    found = [
        (_without_mark(each, of.slicing), replace(needed, tables=None))
        for each, of, needed in zip(plan.properties, specifications, prepared, strict=True)
        if isinstance(of.slicing, Instances)
    ]
    if not found:
        return None
    properties, needed = zip(*found, strict=True)
    marks = (of.slicing.mark for of in specifications if isinstance(of.slicing, Instances))
    silent = {mark.name: sampling.Reading(mark.name, mark.name, "boolean") for mark in marks}
    signals = (*plan.signals, *silent.values())
    return ByBlocks(Session(replace(plan, signals=signals, properties=properties, guards=())), needed)


def _without_mark(of: MonitoredProperty, slicing: Instances) -> MonitoredProperty:
    mark, news = sampling.New(slicing.mark.name), sampling.New(slicing.signal.name)
    return replace(of, slicing=None, inputs=tuple(news if wanted == mark else wanted for wanted in of.inputs))
