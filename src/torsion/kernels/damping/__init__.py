"""Damped modes of a tree."""
