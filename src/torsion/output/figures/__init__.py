"""Figures: one function each, from plain values to an SVG element."""
