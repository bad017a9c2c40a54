"""Trains with joints by their full equations of motion: periodic response, stability, and its map."""
