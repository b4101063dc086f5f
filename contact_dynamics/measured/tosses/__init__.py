# SPDX-License-Identifier: Apache-2.0
"""These recordings of tosses come with the package. `scripts/record_toss.py` makes them."""
