"""Planar problems, and the way between space and a plane of motion."""
