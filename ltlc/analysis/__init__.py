"""What `ltlc check` finds in a specification before it ever runs. The only package that imports z3."""
