"""A reference written from the definition, and a campaign that compares all that ltlc makes with it."""
