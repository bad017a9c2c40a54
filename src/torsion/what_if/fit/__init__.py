"""Measured frequencies, torsiograms and speed signals: the figures of the file that agree with them best."""
