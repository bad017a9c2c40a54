"""Shafts, with their steps, hubs and notches. No assembly of their segments."""
