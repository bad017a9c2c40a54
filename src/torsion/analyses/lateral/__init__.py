"""Bending of the shafts of a Cardan line, and the rigid misaligned shaft."""
