"""Contact modes in space."""
