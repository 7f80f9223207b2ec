"""From monitors to what is written: the code of a target, and what the gate says of it."""
