"""Figures of the file that vary: how frequencies and verdicts spread, and with which probability a check fails."""
