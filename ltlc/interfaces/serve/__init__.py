"""`ltlc serve`: a page for trying out properties, and the small server behind it; nothing leaves the machine."""
