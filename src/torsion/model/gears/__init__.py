"""Gears, planetary stages and differentials, one component a file. No forces on teeth (see analyses)."""
