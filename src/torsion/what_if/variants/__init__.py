"""Variants of a file: what may vary and how, samples of it, and what each variant answers, alone or side by side."""
