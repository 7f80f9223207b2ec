"""What programs, notebooks and tests ask for: the functions of `ltlc`, and what commands share with them."""
