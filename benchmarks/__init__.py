"""Benchmarks: error against run time, peers side by side. One thread, set here before numpy is first imported."""

import os

THREAD_VARIABLES = (
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)

for _variable in THREAD_VARIABLES:
    os.environ[_variable] = "1"
