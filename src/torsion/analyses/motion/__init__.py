"""Motion over time: starts, shocks, short circuits, ice."""
