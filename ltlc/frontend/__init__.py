"""From the text of a specification to its typed form, and back to text."""
