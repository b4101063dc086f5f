"""Tosses are read from files, and velocities, flights and events are found in them."""
