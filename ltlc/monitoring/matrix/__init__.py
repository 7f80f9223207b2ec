"""The traceability matrix: requirements, the properties that verify them, and what recordings have shown of these."""
