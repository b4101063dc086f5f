"""These files follow strikes one after another in time, with free flight between them."""
