"""One body or several strike at several contacts at once."""
