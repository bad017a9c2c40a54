"""Engines: harmonics of their cylinders, sums of phasors, varying inertia, and the misfire of each cylinder."""
