"""From the text of a specification to its typed form: parse, resolve names, check types."""
