"""From monitors to what is written: the code of a target, and the gate's answer about it."""
