"""Trees with distributed inertia (shafts as continua or finite elements): laws of spans, passes, counts, modes."""
