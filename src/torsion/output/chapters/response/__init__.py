"""Chapters on mean torque and on the response over speed. No calculation."""
