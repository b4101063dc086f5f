"""Contacts: given, or found from shapes; their curvatures, frames and friction."""
