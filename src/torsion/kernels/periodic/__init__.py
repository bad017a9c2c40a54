"""Equations with periodic coefficients: harmonic balance, Hill's matrix, Floquet multipliers by monodromy."""
