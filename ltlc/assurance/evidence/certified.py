"""The certificates of a specification: those that `ltlc build` writes, made where nothing else is built."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from ltlc.assurance.exactness import checked_certificate
from ltlc.base.limits import Budget, run_all
from ltlc.compiler import Compiled
from ltlc.runtime.properties import stated
from ltlc.runtime.reports import printable
from ltlc.semantics.certificate import Certificate
from ltlc.semantics.certificate_text import Entry, to_text
from ltlc.semantics.control import Followed
from ltlc.semantics.intervals import without_intervals


def entry_of(compiled: Compiled, certificate: Certificate, program: Followed | None = None) -> Entry:
    """The certificate of a property as files have it, and what runs."""
    of = compiled.specification
    document = {} if of.requirement is None else of.requirement.document()
    remarks = tuple(f"{name}: {printable(value)}" for name, value in stated(document))
    said = without_intervals(of.property)
    return Entry(of.label, of.line, said, compiled.encoding.name, certificate, program, remarks)


def certificates(compiled: Sequence[Compiled], budget: Budget) -> tuple[str, dict[str, str]]:
    """The text of the certificates of properties, and by label why others have none; each has that `budget`."""
    made = run_all([partial(checked_certificate, each) for each in compiled], budget)
    pairs = list(zip(compiled, made, strict=True))
    entries = [entry_of(each, found) for each, found in pairs if isinstance(found, Certificate)]
    reasons = {e.specification.label: found.reason for e, found in pairs if not isinstance(found, Certificate)}
    return to_text(entries), reasons
