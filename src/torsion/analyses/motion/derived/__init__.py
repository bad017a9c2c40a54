"""What follows from motions: orders, resonances passed, fatigue, the worst case, exact peaks. No train is built here."""
