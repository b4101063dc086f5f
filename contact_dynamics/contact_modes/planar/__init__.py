"""Contact modes in the plane."""
