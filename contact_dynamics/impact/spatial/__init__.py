"""This chapter resolves impacts in space."""
