"""Shafts that bend, as beams."""
