"""The file of results: what is written into it, and the report that is read back from it. No other file."""
