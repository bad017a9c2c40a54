"""Figures of the file chosen for the greatest margin to every limit, or for a natural frequency."""
