"""What changes when parameters change: variants of a train, sweeps, designs and fits over them.

A single train as the file gives it is answered in `analyses`.
"""
