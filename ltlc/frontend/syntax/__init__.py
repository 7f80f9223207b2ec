"""Text to a syntax tree: the grammar, the parser with its tables, and what to say of text that does not parse."""
