"""Frequencies, shapes and critical speeds of the undamped train, and what tables, hubs and tolerances do to them."""
