"""Settings of motion over time, and the kinds of events: keys, refusals and torques of a file. No train is built here."""
