"""Recordings of tosses that come with the package; `scripts/record_toss.py` makes them."""
