"""Reciprocating engines: crank kinematics, harmonics of the torque of a cylinder, cycles, sums of phasors."""
