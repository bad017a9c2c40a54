"""Error against run time for one train: every model and method."""
