"""Mathematics of trees, chains and loops of torsional springs and shafts; arrays only.

Structure: `tree`, `layers`, `reduction` (rigid spans), `loops`. Laws of spans with inertia:
`distributed`. One recurrence, z -> 1/(h + 1/z) toward the root and back: `sturm` counts, brackets and proves,
`two_sides` give `mode_shapes` and `repeated` ones; `factors` start what `natural_modes` polishes. With sources or
damping, `sweeps` give `tree_response` and the modes of `damping`. Back ends: `long_chain`, `lapack`. By themselves:
`periodic`, `round_sections`.
"""
