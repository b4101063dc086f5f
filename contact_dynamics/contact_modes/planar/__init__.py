"""This chapter finds contact modes in the plane."""
