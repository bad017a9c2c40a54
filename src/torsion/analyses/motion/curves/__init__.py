"""Torques and speeds over time, read from a motion with their exact peaks. Nothing is judged here."""
