"""Junctions of round shafts, by axisymmetric finite elements and a table of what they say."""
