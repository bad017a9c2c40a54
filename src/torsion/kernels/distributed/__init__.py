"""Laws of spans with distributed inertia: shafts as continua or finite elements."""
