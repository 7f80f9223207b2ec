"""What recordings show of a robot, measured for a specification to start with."""
