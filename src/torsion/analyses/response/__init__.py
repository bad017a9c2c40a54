"""Forced response over speed and over frequency, what excites it, and its synthesis."""
