"""From core LTL to monitors: complete deterministic Moore machines. The only package that imports Spot."""
