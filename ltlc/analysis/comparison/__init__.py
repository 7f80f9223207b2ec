"""Formulas side by side: how encodings of one sentence relate, what tells them apart, and what they cost."""
