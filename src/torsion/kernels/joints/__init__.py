"""Universal joints: kinematics of one joint and of chains of joints, on arrays."""
