"""Chapters on the train and its natural frequencies. No calculation."""
