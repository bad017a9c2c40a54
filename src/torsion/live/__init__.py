"""`torsion live`: a page on this machine that follows a file, and a slider for every figure of it that may vary."""
