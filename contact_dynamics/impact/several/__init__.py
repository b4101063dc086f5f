"""Impacts at several contacts at once, of one body or of several."""
