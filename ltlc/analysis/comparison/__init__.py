"""Formulas side by side: how encodings of one sentence relate, what distinguishes them, and what they cost."""
