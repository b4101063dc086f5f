"""Random values of all that travels in messages, by chapter."""
