"""Trains with joints by their full equations of motion: periodic orbits, Floquet stability, ranges and maps."""
