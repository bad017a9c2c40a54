"""What one file says of several trains: cases, and figures that vary. No solution of them (see what_if)."""
