"""This chapter finds contact modes in space."""
