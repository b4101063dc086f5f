"""Impact in the plane."""
