"""Torques on a motion: by time, as polynomials of a step, and by how a station turns. No modes are known here."""
