"""Outputs: what is selected of the declared results once, and every form in which it is shown."""
