"""Trees of stations and spans: their order, what is eliminated and condensed, and their response. Arrays only."""
