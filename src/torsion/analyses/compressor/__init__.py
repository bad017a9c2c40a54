"""Reciprocating compressors of the train: balance of torque, pressures, harmonics of their throws."""
