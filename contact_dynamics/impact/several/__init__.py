"""Impacts at several contacts at once."""
