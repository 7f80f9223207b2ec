"""`ltlc serve`: a page to try properties on, and the small server behind it; nothing leaves the machine."""
