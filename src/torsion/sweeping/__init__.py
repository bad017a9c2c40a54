"""A sweep whose chunks are kept as they come, and solved by workers of this machine or of many."""
