"""Steps of a run that stand in the plan: when each is done, with which settings, and what is said of it."""
