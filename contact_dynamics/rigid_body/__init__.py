"""Rigid bodies (Mason, lectures 24 and 25): mass properties, states, momenta and energies."""
