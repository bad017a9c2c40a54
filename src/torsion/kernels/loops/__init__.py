"""Trains with closed loops: a spanning tree of the stiffest spans, and chords."""
