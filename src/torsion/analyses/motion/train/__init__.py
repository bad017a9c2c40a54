"""The train in modes with all that acts on it, ready to be moved: its start, couplings and joints. No curve is read here."""
