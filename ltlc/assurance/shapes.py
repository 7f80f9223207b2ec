"""What is judged once for all properties that, with their code, differ only in names."""

from __future__ import annotations

from collections.abc import Mapping

from ltlc.compiler import Compiled
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.conditions import Conditions
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.specification.shapes import Shape, renamed


def shape_of(compiled: Compiled) -> Shape:
    """The shape of a property with its monitor and its conditions; its code is to be added."""
    shape = Shape()
    shape.add_property(compiled.specification, compiled.formula)
    shape.add(compiled.specification.slicing)
    shape.add((compiled.encoding.name, compiled.specification.alphabet, compiled.monitor))
    return shape


def renamed_certificate(certificate: Certificate, names: Mapping[str, str], compiled: Compiled) -> Certificate | None:
    """`certificate` with other names for its atoms, if it then is about the formula and the monitor of `compiled`."""
    found: Certificate = renamed(certificate, names)
    numbers = Conditions().number
    alphabet = compiled.specification.alphabet.restricted_to(compiled.monitor.atoms)
    is_about = (
        found.monitor == compiled.monitor
        and numbers(found.formula) == numbers(compiled.formula)
        and set(timed_atoms(found.formula)) == set(timed_atoms(compiled.formula))
        and numbers(found.assumption) == numbers(alphabet.as_formula())
    )
    return found if is_about else None
