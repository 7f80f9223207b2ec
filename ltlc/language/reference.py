"""Moved to `ltlc.semantics.values`."""

from ltlc.semantics.values import Value as Value
from ltlc.semantics.values import evaluate as evaluate
from ltlc.semantics.values import is_true as is_true
from ltlc.semantics.values import letter as letter
