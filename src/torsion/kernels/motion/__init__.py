"""Motion over time: modes exactly under torques that are ramps and exponentials of time."""
