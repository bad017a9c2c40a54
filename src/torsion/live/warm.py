"""What a process that solves begins with where it is forked from another: a scene solved and drawn once, here."""

import gc

from torsion.live.pictures import modes_of, whole_of
from torsion.live.sliders import shown
from torsion.schema import template
from torsion.schema.scene_reader import movable, parse

study = parse(template("example.yaml"))
shown(movable(study), {})
modes_of(study)
whole_of(study, (), lambda what, share: None)
gc.collect()
gc.freeze()
