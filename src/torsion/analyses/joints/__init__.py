"""Universal joints by themselves and in lines: kinematics, couples, the best phase."""
