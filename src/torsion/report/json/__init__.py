"""The results as JSON: one subject a file."""
