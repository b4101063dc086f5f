"""Shapes of bodies and of obstacles."""
