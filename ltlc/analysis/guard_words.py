"""Guards in plain English: what they let through, what they send instead, and for which properties."""

from __future__ import annotations

from collections.abc import Sequence

from ltlc.analysis.wording import listed
from ltlc.semantics.durations import duration_text
from ltlc.specification.expressions import New
from ltlc.specification.guards import Fallback, Guard
from ltlc.specification.specification import Specification, topics
from ltlc.specification.text import text


def sentences(specification: Specification, guard: Guard) -> str:
    """What `guard`, one of `specification`, does."""
    kept = listed([f"`{each.label}`" for each in specification.kept_by(guard)], "or")
    lets = f"Lets a command from {guard.raw} through to {guard.out}, unless {kept} could be violated after it"
    if not guard.fallbacks:
        return f"{lets}. Instead of such a command it sends nothing."
    sent = listed([f"`{each.name}`" for each in guard.fallbacks], "or")
    first = " (the first that helps)" if len(guard.fallbacks) > 1 else ""
    by_itself = f"sends it by itself where only that keeps a deadline, {duration_text(specification.lead)} ahead of it"
    return f"{lets} whatever the guard does. It then sends {sent} instead{first}, or nothing. It also {by_itself}."


def contents(fallback: Fallback) -> str:
    """The fields of `fallback` that are not zero, false or empty."""
    given = [f"{'.'.join(path)} = {text(value)}" for path, value in fallback.values.items()]
    rest = "the rest zero, false or empty" if given else "all fields zero, false or empty"
    return ", ".join([*given, rest])


def waits_for(specification: Specification, guard: Guard) -> Sequence[str]:
    """The topics on which a message has to come before anything leaves `guard`: not those of ages and news alone."""
    read = [*specification.kept_by(guard), *(each for each in specification.properties if each.is_assumed)]
    with_values = (each for each in read if not all(isinstance(part, New) for part in each.inputs()))
    found = (topic for each in with_values for topic in topics(each))
    return [topic for topic in dict.fromkeys(found) if topic != guard.out]
