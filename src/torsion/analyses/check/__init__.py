"""The models of one train side by side."""
