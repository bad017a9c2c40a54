"""The kind `engine`: what the file says of it, the harmonics of its cylinders, and what it lowers to."""
