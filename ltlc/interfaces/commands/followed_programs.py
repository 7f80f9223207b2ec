"""`ltlc certify --program`: whether what runs follows the certified monitor of each property."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc import __version__
from ltlc.assurance.certificates import Checked, over_bound
from ltlc.assurance.controls import control_of
from ltlc.assurance.pairs import uncovered
from ltlc.compiler import Compiled
from ltlc.interfaces.commands.progress import saying
from ltlc.semantics.control import Followed
from ltlc.semantics.following import follows_monitor


def are_followed(checked: Sequence[Checked], compiled: Sequence[Compiled], quiet: bool) -> bool:
    """Say of the program of each property, by its certificate and what ltlc makes of it, whether it is right."""
    made = {each.specification.label: each for each in compiled}
    with saying("checking programs", quiet):
        objections = [_objection(each, made.get(each.label)) for each in checked]
    for each, objection in zip(checked, objections, strict=True):
        answer = "follows the certified monitor" if objection is None else f"is NOT shown to be right: {objection}"
        print(f"{each.label}: its program {answer}")
    return not any(objections)


def _objection(checked: Checked, compiled: Compiled | None) -> str | None:
    """Why the program of a property is not shown to be right, if it is not."""
    if compiled is None:
        return "there is no certified monitor to compare its program with"
    if reason := uncovered(compiled):
        return f"{reason}, which is not covered yet"
    if checked.certified is None or checked.certified.program is None:
        return "the certificate has no program; `ltlc build --program` writes it"
    return _difference(checked, checked.certified.program, compiled)


def _difference(checked: Checked, program: Followed, compiled: Compiled) -> str | None:
    answer = follows_monitor(compiled.formula, checked.assumption, compiled.monitor, program)
    if not answer.follows:
        return "the pairs do not show it" if answer.met is None else over_bound(answer.met)
    if program.control != control_of(compiled):
        return f"it follows the monitor, but differs from the program that ltlc {__version__} makes"
    return None
