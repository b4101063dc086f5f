"""Recorded motion: tosses read from files, velocities, flights and events found in them."""
