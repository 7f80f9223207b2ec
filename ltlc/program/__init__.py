"""What lies between a specification and whatever runs it: typed expressions and the table of their functions."""
