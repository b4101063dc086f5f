"""Where a flight ends: the first contact with planes and obstacles."""
