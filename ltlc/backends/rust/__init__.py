"""Monitors in Rust: one file for all properties, without the standard library, a heap or a function of libm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from ltlc import __version__
from ltlc.backends.inputs import require_no_first_values, require_whole_runs
from ltlc.backends.names import Names, class_name, variable
from ltlc.backends.rust.code import comment
from ltlc.backends.rust.functions import texts
from ltlc.backends.rust.monitors import PropertyWriter, verdict_name
from ltlc.backends.rust.names import RESERVED
from ltlc.backends.rust.signals import Signals
from ltlc.backends.spelling import NotInTargetError
from ltlc.backends.templates import template
from ltlc.backends.wording import MEANINGS
from ltlc.compiler import Compiled
from ltlc.runtime.times import NEVER
from ltlc.specification.specification import Specification

__all__ = ["File", "emit", "file_of"]


@dataclass(frozen=True, slots=True)
class File:
    """The text of a file, and the signals that it was made from."""

    text: str
    signals: Signals


def emit(compiled: Sequence[Compiled], specification: Specification) -> str:
    """The file for `compiled`. Raises NotInTargetError."""
    return file_of(compiled, specification).text


def file_of(compiled: Sequence[Compiled], specification: Specification) -> File:
    """The same, with its signals. Raises NotInTargetError."""
    require_whole_runs(compiled)
    require_no_first_values(compiled)
    if specification.rate is not None:
        raise NotInTargetError("ticks of `_rate_`")
    signals = Signals([each.specification for each in compiled])
    members, types = Names(RESERVED), Names(RESERVED)
    properties = [
        PropertyWriter(
            each,
            members.unique(variable(each.specification.label)),
            types.unique(class_name(each.specification.label)),
            signals,
        )
        for each in compiled
    ]
    taken = signals.taken()
    code = "\n".join([*taken, *(line for each in properties for line in each.methods)])
    text = template(__name__, "template.rs.jinja").render(
        about=_about(compiled, specification),
        never=NEVER,
        verdicts=[(verdict_name(verdict), meaning) for verdict, meaning in MEANINGS.items()],
        properties=properties,
        lifetime="<'a>" if signals.borrows else "",
        samples=list(signals.samples()),
        signals=list(signals.members()),
        taken=taken,
        heard=signals.heard.values(),
        functions=texts(code),
        has_arrays=any(kept.has_arrays for kept in signals.kept.values()),
        timeout=specification.timeout,
        counts=any(each.counts for each in properties),
        ages=any(each.ages for each in properties),
    )
    return File(text, signals)


def _about(compiled: Sequence[Compiled], specification: Specification) -> list[str]:
    source = PurePath(specification.source.name).name
    first = f"Runtime monitors for the properties of {source}, made by ltlc {__version__}."
    of_each = [f"{c.specification.label}: {c.specification.text}" for c in compiled]
    return comment("//!", first, *of_each, "No heap, no recursion, no globals, nothing but `core`.")
