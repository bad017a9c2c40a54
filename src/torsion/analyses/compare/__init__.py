"""Models and methods of one train compared: errors against the exact model, and error against run time."""
