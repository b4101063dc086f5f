"""This chapter resolves impacts in the plane."""
