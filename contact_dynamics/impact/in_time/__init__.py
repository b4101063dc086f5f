"""Strikes one after another in time, with free flight between them."""
