"""With a rate, the ticks of a property begin with what it reads itself: whether those of emitted C do."""

from __future__ import annotations

from collections.abc import Sequence

from pycparser import c_ast

from ltlc.assurance.reading.c.paces import Pace
from ltlc.assurance.reading.c.samples import Samples
from ltlc.assurance.reading.c.text import Definitions, disjuncts, shown
from ltlc.assurance.reading.language import NotUnderstoodError
from ltlc.assurance.reading.letters import Judged
from ltlc.semantics.timed_atoms import timed_atoms
from ltlc.specification.expressions import New
from ltlc.specification.specification import topics


def check_ticks(definitions: Definitions, all_samples: Sequence[Samples]) -> None:
    """Raise NotUnderstoodError unless the ticks at each pace begin as those of each property that is judged at it."""
    topic_of = {flag: topic for samples in all_samples for flag, topic in samples.topic_of_flags().items()}
    for samples in all_samples:
        flags = _flags(definitions, samples.pace)
        found = None if flags is None else frozenset(topic_of.get(flag) for flag in flags)
        if any(_begins(judged) != found for judged in samples.judged if judged.specification.inputs()):
            raise NotUnderstoodError(f"ticks of `{samples.pace.function}` begin otherwise than those of its properties")


def _begins(judged: Judged) -> frozenset[str] | None:
    """The topics with which the ticks of a property begin; None: with the session."""
    reads_news = all(isinstance(each, New) for each in judged.specification.inputs())
    return None if reads_news and timed_atoms(judged.formula) else frozenset(topics(judged.specification))


def _flags(definitions: Definitions, pace: Pace) -> list[str] | None:
    """The flags of the samples with which ticks begin; None: with the session."""
    has_begun = f"monitors->{pace.signals}.ticks.have_begun"
    if "begin_session" in definitions:
        begun = definitions.function("begin_session").body.block_items
        if any(shown(node) == f"{has_begun} = true" for node in begun):
            return None
    for node in definitions.function(f"{definitions.prefix}_step").body.block_items:
        match node:
            case c_ast.If(cond=c_ast.BinaryOp(op="&&", left=left, right=right)) if shown(left) == f"!{has_begun}":
                return [flag.removeprefix("samples->") for flag in disjuncts(right)]
    return []
