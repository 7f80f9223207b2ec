"""What ltlc's language means: no Spot, no ROS, no solver; slow and obvious, the oracle of everything else."""
