"""Impact in space."""
