"""A conformance suite for runtime verification of robots: numbered cases, and a score of how many a tool gets right."""
