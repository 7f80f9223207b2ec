"""`ltlc falsify`: parameters and inputs of a simulation with which a property is violated."""
