"""The typed specification as data, and its meaning: expressions and their values, atoms, the letters that exist."""
