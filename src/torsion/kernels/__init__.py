"""Mathematics of trees, chains and loops of torsional springs and shafts: arrays only, nothing of components or files.

Structure: `tree`, `reduction` (rigid spans), `spanning_forest`, `loops`. Laws of spans with inertia:
`distributed`. One elimination, z -> z/(1 + h z) toward the root and back: `sturm` counts, brackets and proves;
`elimination` gives `mode_shapes` and `repeated` ones; `factors` start what `natural_modes` polishes. With sources or
damping it gives `tree_response` and the modes of `damping`. `bracketed_search` finds roots and minima.
By themselves: `periodic`, `motion`, `engine`, `joints`, `round_sections`.
"""
