"""These recordings of tosses come with the package. `scripts/record_toss.py` makes them."""
