"""Signals that are computed from others, over the columns of a block."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ltlc.monitoring.columns.prepared import Definition
from ltlc.monitoring.columns.series import Columns, UnsupportedError
from ltlc.monitoring.columns.values import value
from ltlc.runtime.sampling import Derived, New, Sampler


def derive(
    columns: Columns, signals: Iterable[Derived], sampler: Sampler, definitions: Mapping[str, Definition]
) -> None:
    """Add `signals`, each after its parts, to `columns`; those that cannot be computed are lacking there."""
    for signal in signals:
        if not signal.inputs:
            columns.add_constant(signal.name)
            continue
        try:
            news = (sampler.topics[i.signal] for i in signal.inputs if isinstance(i, New))
            steps = columns.steps(signal.inputs, frozenset().union(*news))
            definition = definitions[signal.name]
            found = np.broadcast_to(value(definition.value, steps), len(steps))
            mask = None
            if signal.when is not None:  # of no booleans the kind is not known
                holds = np.asarray(value(definition.has_sample, steps), np.bool_)
                mask = np.broadcast_to(holds, len(steps))
            if definition.value.type.scalar.is_integer:  # computed as doubles, which these are
                found = found.astype(np.int64)
            columns.add(signal.name, steps, found, mask)
        except UnsupportedError as error:
            columns.lack(signal.name, str(error))
