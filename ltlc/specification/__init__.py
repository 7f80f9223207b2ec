"""The typed specification as data, and what it says: expressions and their values, atoms, the letters that exist."""
