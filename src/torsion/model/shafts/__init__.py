"""Shafts, with their steps, hubs and notches. No division into segments (see assembly)."""
