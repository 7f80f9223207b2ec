"""The gate: nothing is emitted that has not been certified, cross-checked against the reference, and replayed."""
