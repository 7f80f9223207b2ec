"""`ltlc mine`: the tightest values of thresholds and bounds with which every recording passes."""
