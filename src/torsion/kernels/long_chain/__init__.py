"""The lowest modes of chains of 1e5 to 1e6 spans, with their enclosures."""
