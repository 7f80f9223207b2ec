"""The game of a guard: its moves, where it may rest, and what `check` says of it."""
