"""Whether evidence is about a specification: its properties, and for each atom by its name what it is as data.

The judge sees names only, `recorded.py` sees data only. That the two mean the same is compared here with what the front
end makes of the specification, which is what has to be trusted for it.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest

from ltlc.assurance.evidence.conditions import (
    NotCoveredError,
    numbered_scopes,
    opening_atom,
    stated_atoms,
    stated_counts,
    stated_key,
    stated_signals,
)
from ltlc.assurance.evidence.document import Claim, Document, condition_text
from ltlc.specification.specification import Specification


def differences(document: Document, specification: Specification) -> Iterator[str]:
    """Where `document` as a whole is not about `specification`: its digest, settings, and its properties."""
    head = document.head
    if head.specification[1] != specification.source.sha256:
        yield f"it is about a specification with another SHA-256: {head.specification[1]}"
    rate = None if specification.rate is None else repr(specification.rate)
    if head.rate != rate:
        yield f"it has the rate {head.rate}, the specification {rate}"
    if head.timeout != specification.timeout:
        yield f"it has the timeout {head.timeout}, the specification {specification.timeout}"
    if head.signals and head.signals != stated_signals(specification.properties):
        yield "the signals of its table are others than those of the specification"
    for stated, of in zip_longest(document.properties, specification.properties):
        if stated is None or of is None or stated.label != of.label:
            names = ["no property" if each is None else f"`{each.label}`" for each in (stated, of)]
            yield f"it has {names[0]} where the specification has {names[1]}"
            return


def difference(claim: Claim, specification: Specification) -> str | None:
    """Where `claim` differs from the property of its name in `specification`; None if it is about that."""
    of = next((each for each in specification.properties if each.label == claim.label), None)
    if of is None:
        return "the specification has no such property"
    if claim.text != of.text:
        return f"the specification says `{of.text}`"
    requirement = of.requirement
    verified = () if requirement is None else tuple(requirement.attributes.get("verifies", ()))
    if (claim.requirement, claim.verifies) != (None if requirement is None else requirement.id, verified):
        return "the specification states another requirement"
    try:
        stated = stated_atoms(of)
    except NotCoveredError as error:
        return f"evidence does not cover it: {error}"
    if [name for name, _ in claim.atoms] != [name for name, _ in stated]:
        return "it has other atoms"
    for (name, condition), (_, right) in zip(claim.atoms, stated, strict=True):
        if condition_text(condition) != condition_text(right):
            return f"`{name}` is {condition_text(right)}"
    if claim.opens != opening_atom(of):
        return "instances are opened by something else"
    if claim.key != stated_key(of):
        return "ids come from somewhere else"
    if claim.counts != stated_counts(of):
        return "it counts something else"
    if [scope.number for scope in claim.scopes] != [*numbered_scopes(of).values()]:
        return "it takes values at the opening of other scopes"
    return None
