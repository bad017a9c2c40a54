"""`python -m torsion` is the command `torsion`."""

from torsion.cli import main

main()
