"""Whether verdicts come as soon as they can: what `build` requires of a monitor, and what runs without it report."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from ltlc.assurance.certificates import over_bound
from ltlc.assurance.certify import NotCertified, certify
from ltlc.assurance.shapes import shape_of
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.limits import Budget, Exceeded, run_all
from ltlc.base.source import Source
from ltlc.compiler import Compiled
from ltlc.semantics.certificate import Certificate, check
from ltlc.semantics.reset_machine import ResetMachine

LATE = "if one of several bounds decides the outcome of another, omit that other, or make each a separate property"
"""What to do about a verdict that can come late."""


def checked_certificate(compiled: Compiled) -> Certificate | NotCertified:
    """A certificate for the monitor of `compiled` that the checker accepts as exact."""
    certificate = certify(compiled.formula, compiled.specification.alphabet, compiled.monitor)
    if isinstance(certificate, NotCertified):
        return certificate
    answer = check(certificate)
    if answer.met is not None:
        return NotCertified(over_bound(answer.met), too_large=True)
    if not answer.certified:
        return NotCertified("the checker rejects the certificate that was made")
    if not answer.exact:
        return NotCertified("it is not shown that every verdict that could be permanent is", too_late=True)
    return certificate


def late_verdicts(source: Source, compiled: Sequence[Compiled], budget: Budget) -> list[Diagnostic]:
    """A warning for each property of `source` whose verdicts are not shown to come as soon as they can.

    Of a monitor whose words are runs in time, determinising shows it; of the others, a certificate, for which each
    shape has `budget`.
    """
    asked = [each for each in compiled if not ResetMachine(each.formula).words_are_runs]
    keys = [shape_of(each).key for each in asked]
    examples = dict(zip(reversed(keys), reversed(asked), strict=True))
    jobs = [partial(checked_certificate, each) for each in examples.values()]
    found = dict(zip(examples, run_all(jobs, budget) if jobs else (), strict=True))
    pairs = ((each, found[key]) for each, key in zip(asked, keys, strict=True))
    return [_warning(source, each, why) for each, why in pairs if not isinstance(why, Certificate)]


def _warning(source: Source, compiled: Compiled, why: NotCertified | Exceeded) -> Diagnostic:
    property_ = compiled.specification
    message = f"the verdict of `{property_.label}` may come later than it could; `ltlc build` refuses this monitor"
    if isinstance(why, NotCertified) and why.too_late:
        return diagnostic("LTL709", source, property_.span, message, help=LATE)
    reason = why.reason
    return diagnostic("LTL709", source, property_.span, f"{message}: {reason}", help="split the property into several")
