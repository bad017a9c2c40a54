"""Figures as data: what one holds, and one function for each kind, from plain values to the figure."""
