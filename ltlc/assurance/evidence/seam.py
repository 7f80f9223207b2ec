"""The seam between letters and verdicts: what evidence says of atoms, and of what was judged, is as specified.

The judge sees the names of atoms, the reader what they are; nothing in the two ties these together. Here they are
compared with the specification, by the front end of ltlc, which is trusted for this, and by nothing else of it.
"""

from __future__ import annotations

from collections.abc import Iterator

from ltlc.assurance.evidence.conditions import NotCoveredError, stated_atoms
from ltlc.assurance.evidence.document import Claim, Document, NotCovered, condition_text
from ltlc.semantics.encodings import EPISODE, Encoding
from ltlc.specification.specification import PropertySpecification, Specification


def differences(
    document: Document, specification: Specification, sha256: str, encoding: Encoding = EPISODE
) -> Iterator[str]:
    """What `document` says otherwise than `specification`, whose file has this SHA-256: nothing if all is the same."""
    head = document.head
    if head.specification[1] != sha256:
        yield f"the specification has the SHA-256 {sha256}"
    if head.rate != (None if specification.rate is None else repr(specification.rate)):
        yield f"the specification has another `_rate_`: {specification.rate}"
    if head.timeout != specification.timeout:
        yield f"the specification has another `_timeout_`: {specification.timeout}"
    labels = [each.label for each in specification.properties]
    if [each.label for each in document.properties] != labels:
        yield f"the specification has other properties: {', '.join(labels)}"
        return
    for stated, of in zip(document.properties, specification.properties, strict=True):
        yield from (f"{of.label}: {each}" for each in _about(stated, of, encoding))


def _about(stated: Claim | NotCovered, of: PropertySpecification, encoding: Encoding) -> Iterator[str]:
    """What is said otherwise of one property."""
    if isinstance(stated, NotCovered):
        return
    if stated.text != of.text:
        yield f"it is specified as: {of.text}"
    requirement = of.requirement
    verifies = () if requirement is None else requirement.attributes.get("verifies", ())
    if (stated.requirement, stated.verifies) != (requirement and requirement.id, tuple(verifies)):
        yield "it states another requirement"
    try:
        atoms = stated_atoms(of, encoding)
    except NotCoveredError as error:
        yield f"evidence does not cover it: {error}"
        return
    if [name for name, _ in stated.atoms] != [name for name, _ in atoms]:
        yield f"its atoms are {', '.join(name for name, _ in atoms)}"
        return
    for (name, condition), (_, specified) in zip(stated.atoms, atoms, strict=True):
        if condition_text(condition) != condition_text(specified):
            yield f"`{name}` is {condition_text(specified)}"
