"""What the manual says of the kinds of component beside their keys: an example, and what keys need of each other."""

EXAMPLES = {
    "disc": "- disc: {name: flywheel, inertia: 2.075 kg*m**2, source: drawing}",
    "motor": "- motor: {inertia: 8.5, power: 400 kW, ripple: [{order: 6, torque: 1 %, phase: 30 deg}]}",
    "turbine": "- turbine: {inertia: 1800 kg*m**2, source: drawing}",
    "generator": "- generator: {inertia: 95, power: 1200 kW, load: constant-power, ripple: [{order: 2, torque: 1 %}]}",
    "pump": "- pump: {inertia: 3, entrained: 20 %, power: 400 kW, load: {exponent: 2, at_rest: 20 %}, blades: 6,\n"
    "         excitation: [{blade_order: 1, torque: 2 %}]}",
    "fan": "- fan: {inertia: 45 kg*m**2, power: 200 kW, speed: 1470 rpm}",
    "machine": "- machine: {name: mill, inertia: 2600, torque: 30 kN*m, load: constant,\n"
    "           excitation: [{order: 3, torque: 5 %}]}",
    "propeller": "- propeller: {inertia: 42, entrained: 25 %, blades: 4, damping: {model: archer, factor: 30},\n"
    "              excitation: [{blade_order: 1, torque: 6 %}, {blade_order: 2, torque: 2 %}]}",
    "damper": "- damper: {housing: 1.5, ring: 4, damping: 600 N*m*s/rad}\n"
    "- damper: {housing: 1.5, ring: 4, silicone: {viscosity: 0.15 m**2/s, shape: 5 m**3, temperature: 75 degC}}",
    "pendulum": "- pendulum: {mass: 1.2 kg, number: 4, arm: 80 mm, order: 3, inertia: 0.02}",
    "shaft": "- shaft: {length: 4.5 m, diameter: [150 mm, 140 mm], bore: 40 mm, role: propeller, features: shrink fit}",
    "coupling": "- coupling: {stiffness: 40 kN*m/rad, inertia: [0.9, 0.6], psi: 0.9, vibratory_torque: 1.2 kN*m}\n"
    "- coupling: {stiffness: 70 kN*m/rad, psi: 1.1, max_torque: 15 kN*m, max_torque_rare: 45 kN*m}\n"
    "- coupling: {stiffness: 2 MN*m/rad, clearance: {angle: 0.2 deg, viscous: 40}}\n"
    "- coupling: {stiffness: 950, hysteresis_torque: 7 N*m, stages: [{from: 12 deg, stiffness: 4000}]}\n"
    "- coupling: {stiffness: 80 kN*m/rad, capacity: 400 N*m}",
    "gear": "- gear: {teeth: [31, 93], inertia: [0.25, 14], branches: [{teeth: 62, train: [disc: {inertia: 2}]}]}\n"
    "- gear: {teeth: [19, 57], module: 8 mm, helix_angle: 12 deg, pressure_angle: 20 deg}",
    "branch": "- branch: {train: [coupling: {stiffness: 20 kN*m/rad}, disc: {inertia: 1}]}",
    "joint": "- joint: {angle: 5 deg, phase: 90 deg}\n"
    "- joint: {kind: tripod, angle: 10 deg, radius: 30 mm, arm: 600 mm}",
    "engine": """\
- engine:
    name: main engine
    cylinders: 6
    strokes: 4
    firing_order: [1, 5, 3, 6, 2, 4]
    inertia: [0.0467, 0.0327, 0.0467, 0.0467, 0.0327, 0.0487]
    stiffness: [1.253e6, 1.253e6, 1.678e6, 1.253e6, 1.253e6]
    damping: 2 N*m*s/rad
    loss_factor: 3.5 %
    journal: {diameter: 90 mm}
    geometry: {bore: 105 mm, stroke: 137 mm, rod_length: 207 mm}
    masses: {reciprocating: 2.521 kg}
    gas: {cycle: wiebe, compression_ratio: 17, charge: 2.4 bar, exhaust: 2 bar, imep: 18 bar, p_max: 150 bar,
          duration: 60 deg}
    misfire: 3""",
    "compressor": """\
- compressor:
    name: compressor
    stroke: 180 mm
    rod_length: 430 mm
    throws:
    - {angle: 0 deg, bore: 400 mm, piston_rod: 60 mm, reciprocating: 128 kg,
       head_end: reciprocating_compressor_1_head.csv, crank_end: reciprocating_compressor_1_crank.csv}
    - {angle: 0 deg, bore: 235 mm, piston_rod: 60 mm, reciprocating: 128 kg,
       head_end: reciprocating_compressor_2_head.csv, crank_end: 3.1 bar}
    absolute: true
    mechanical_efficiency: 94 %
    crank_inertia: 1.4 kg*m**2
    stiffness: 5 MN*m/rad
    loss_factor: 1 %""",
}
NOTES = {  # what the keys of a kind need of each other
    "disc": "Give `inertia`, or `held: true`.",
    "motor": "Give `inertia`, or `held: true` (and then no `ripple`). The mean torque enters at the machines that "
    "drive. `power` of several says their shares of it; of one alone it is its rating, and the torque follows from "
    "the loads and `operation`. `load` is that of a machine that absorbs.",
    "generator": "`load: constant-power` is a converter that keeps its power; a generator at a converter of constant "
    "torque, or at a grid, keeps its torque.",
    "machine": "Without `load` its torque follows `operation.load`.",
    "propeller": "The mean torque leaves at the machines that absorb. `excitation` needs `blades`, ice of a class "
    "`blades`, `diameter`, `pitch_ratio` and `hub_ratio`. Of the models of damping "
    "`viscous` has a `value`, `schwanecke` needs `diameter`, `pitch_ratio` and `area_ratio`, others have a `factor`.",
    "shaft": "Give `diameter`, with or without `bore`, or `section`. The bore is smaller than the diameter at both "
    "ends.\n\nA section, as `section: {mesh: keyed.msh, unit: mm}`, is a mesh of triangles with 3 or 6 nodes in a file "
    "that meshio reads (Gmsh, VTK, ...), its path counted from the folder of this file. The plane of x and y is the "
    "section, the origin the axis of the shaft: the polar moment is taken about it, and a centroid far from it is "
    "refused. Torsion constant, polar moment and largest shear stress follow from the stress function and the warping "
    "by finite elements, on the mesh and on refinements of it. The torsion constant lies between bounds from both "
    "sides; these, and what the last refinement changed in the stress, are reported. What is solved is the outline as "
    "meshed: straight triangles make a polygon of a circle (64 sides: torsion constant 0.3 % too small), six-node "
    "triangles follow it with parabolas (64: 4e-7). At a sharp inner corner the stress is unbounded, and the "
    "section then has no stress modulus: round it. The class rule does not judge a shaft with a section, nor is it "
    "judged for bending as a tube.\n\nThe `role` says which limits of the rules hold: line shafts are `intermediate`, "
    "`thrust` or `propeller`; a piece of a crankshaft with the diameter of its journals is `crank`, the shaft of a "
    "generator `generator`.\n\nA `support` is a bearing on springs, one mapping or a list of them; with it the "
    "bending of the shafts is computed, also where `analyses` does not name `lateral`.",
    "coupling": "Give `stiffness`, `flexibility`, `table`, `prony` or `fractional`, and beside the first two at most "
    "one of `viscous`, `loss_factor`, `psi` and "
    "`magnifier`; a rigid coupling has none of these.\n\nA `table` gives stiffness and damping over the frequency of "
    "the vibration or over the mean torque of the coupling, linear between its points, each by itself. Over frequency "
    "every harmonic component of the response has the values of its own frequency, and every mode those of its natural "
    "frequency: exactly one root a mode where d ln k/d ln f < 2 on every piece, which is checked and reported. Damped "
    "modes have no meaning then; the modal loss factors stand for them. Motion over time, exact motion, "
    "harmonic balance, stability, damping by mode, closed loops and `check` take no such table and refuse it; the mean "
    "twist has the first stiffness of the table. Nothing is computed beyond the ends of a table but with "
    "`beyond: hold`; modes above its end are left out. Over mean torque "
    "`stiffness` is the tangent of the static curve; every speed of the response has that of its own mean torque, and "
    "a natural frequency is a curve over the speed, which an order meets nowhere, once or several times. Modes, and "
    "all that does not name a speed, motion over time among it, have the stiffness of the rated speed, else of the "
    "highest. Over vibratory torque, half range of all harmonic components together, every speed has the values of the "
    "torque that they lead to; of several such torques the largest stands, every check is judged at each, and a speed "
    "at which none settles has no answer and passes no check. Modes have the first stiffness of that table.\n\n"
    "`prony` and `fractional` are laws that hold at every complex frequency, with stiffness and damping: response and "
    "modes take them as a table over frequency that never ends, and damped modes are exact. What refuses a table "
    "refuses them.\n\n`from` names a library, a CSV file of a series, and `size` its row, whose keys stand for those "
    "of the coupling (Tables of a spreadsheet).\n\n"
    "`temperature` says how the coupling softens as it warms by its own heat, linear between its rows, and "
    "how far its heat warms it. At every speed of the response all temperatures at which it gives off what it makes "
    "are found, up to the permissible one `to`; where there is none it runs away, and `coupling-maker` fails. All "
    "other results are of the coupling as cold as its surroundings, `now`; class societies mostly accept a cold and a "
    "warm coupling as two calculations in its place.\n\n`clearance`, `hysteresis_torque`, `stages` and `capacity` "
    "make it nonlinear. Its torque over the twist u is that of a spring beyond half the play, k (u - s angle/2) + c u' "
    "on the side s, which never pulls; with stages k u and beyond the twist of each its k_i (|u| - from_i) more; "
    "friction is a spring in series with a slider beside it, and several slip one after another. A `capacity` makes it "
    "a clutch or brake: its stiffness in series with a slider, which the event `clutch` closes and opens. Motion over "
    "time takes all of them exactly, and both ends then need an inertia. `modes` take the coupling as "
    "linear: play closed, without friction, in its first stage, the clutch stuck; plan and report say so. `response` "
    "takes play, friction and stages by harmonic balance: while the vibratory torque stays below the mean torque a "
    "play is closed, beyond it opens, and its stiffness and damping act for the share of the cycle in contact. Without "
    "a mean torque a play is open at small amplitudes. Of several solutions at one speed the largest stands, and the "
    "report says so; the exact motion stands beside the peaks, and verdicts take the larger. "
    "`clearance` and `stages` exclude each other, and `capacity` all others; `psi`, `loss_factor` and `magnifier` go "
    "with stages.",
    "gear": "Give `ratio` or `teeth`, here and in each of `branches`; there the teeth of the wheel alone are enough "
    "where the gear has `teeth`.\n\n`planetary` makes it a planetary stage with one member fixed; its ratio "
    "follows from the teeth, and the speeds and the mass of the planets are referred to the carrier (of a fixed "
    "carrier, to the driven member). Between elastic meshes the planets are a point of their own, `stage planets` of a "
    "`stage`, and all planets move alike; only where the mesh of the fixed member is the softer one, at the teeth, "
    "their spin too counts at the carrier, and the report says so. Torques of the stage are those of the mesh of its "
    "sun, of a fixed sun of its ring.\n\n`differential` puts two equal halves behind the driven wheel, the case: "
    "`train` is one of them. It is lowered twice. Under its own names stand both halves together: inertia, stiffness, "
    "damping, torque and limits of each component are those of both, and each half carries half. Under the names with "
    "`opposed` behind them stand both against each other, while the case rests: these are the modes of one wheel "
    "against the other. What excites before the differential, or both halves alike, does not reach them. A torque on "
    "one half alone is two excitations: it at the point, and it at the point `opposed`. A shaft of a half stands in "
    "tables with the diameter of the circle of twice its polar moment; its stress is that of one shaft.\n\n"
    "A `module` beside `teeth`, or `pitch_diameter`, gives the nominal forces on the teeth at the rated torque: "
    "F_t = 2 T/d, F_r = F_t tan(alpha_n)/cos(beta), F_a = F_t tan(beta), without K_A. "
    "Where both are given they agree to 0.1 %. Wheels in `branches` have the module and angles of the gear.",
    "joint": "`plane` and `phase` count from the joint before it on the same shaft line. Behind a gear a joint is "
    "again the first, and has no `plane`; on a branch a first joint has no `phase` either. A cross joint excites at "
    "order 2 of its driving shaft, a tripod at order 3. A tripod needs `radius` and `arm`; its yoke is its first arm, "
    "counted from the plane on the outer side of the bend. Between the yokes of a cross joint lie 90 degrees; behind a "
    "tripod or a cv joint nothing is added: two equal cross joints with a cv joint between them still cancel.",
    "engine": "It is a list of points and links: throws are points called `main engine cylinder 1` (`main engine throw "
    "1` where two cylinders work on one), crank spans are links called `main engine crank 1-2`. The flywheel is a disc "
    "behind it. Give `firing_order`, or `firing_angles` where the cylinders do not fire evenly or work in a V: the "
    "bank angle is contained in them. Give `inertia`, or `crank_inertia` and `masses`.\n\nThe torque of every cylinder "
    "is that of its gas and that of its moving masses, the latter exact in the ratio of crank and rod. The mean torque "
    "enters at the cylinders; the harmonics of the gas follow it over `operation.load`: mean pressure and mean torque "
    "go together by `mechanical_efficiency`. A `table` without `at` is the same at every load, tables or diagrams with "
    "a `speed` have their own load. Amplitudes are in `N*m` or, as tangential pressures (torque / piston area / half "
    "the stroke), in `bar`. A diagram is a text file of two columns whose first line names their units, `angle [deg], "
    "pressure [bar]`; its last row repeats the first one cycle later, and between rows the pressure is straight. "
    "`table`, `motored`, `tables` and the `rows` of one of these may be the name of a CSV file: columns `order`, "
    "`amplitude [bar]` and `phase [deg]`, or `order`, `a [N*m]` and `b [N*m]`; for `tables` one of `imep [bar]`, "
    "`torque [N*m]` and `speed [rpm]` besides. A `cycle` finds begin and amount of the heat release from `imep` and "
    "`p_max`; at several loads `imep` is a list, and so may be `p_max`, `charge` and `exhaust`.\n\n"
    "A cylinder in `misfire` is "
    "motored: it compresses, has no heat, and its masses go on. From a diagram the compression is mirrored for that. "
    "`misfire: worst` runs the train once for every cylinder: of each check the worst stands, with its cylinder, and "
    "all else is of the cylinder with the worst check. "
    "`cut_out`: valves open, no gas torque. The mean torque falls by the share of the cylinders that do not fire, but "
    "for `keep_power: true`. Several engines in one train need a `phase` each, but for one. "
    "Where that is by chance, as behind a clutch, `phase: worst` adds magnitudes to those of all else, order by order; "
    "half ranges are then sums of the magnitudes of all orders.",
    "compressor": "It is a list of points and links: throws are points called `compressor throw 1`, crank spans are "
    "links called `compressor crank 1-2`. The mean torque leaves at its throws, in proportion to what their pressures "
    "absorb; its size follows from `operation`, and the report sets both beside each other. The harmonics are those of "
    "the pressures at every speed and load: another load is a case with its own pressures.\n\nThe pressures of an end "
    "are a text file of two columns whose first line names their units, or one constant pressure, as of an end whose "
    "valves are kept open. The first column is the volume of that end (`volume [dm3]`), the travel of the piston from "
    "the dead centre of that end (`travel [mm]`, or `stroke [%]`), or the angle of the crank (`angle [deg]`, with "
    "`tdc`). Of volume and travel the rows go once around as the piston moves, expansion and suction, compression and "
    "discharge, from any of them on, the last repeating the first; smallest and largest value are the dead centres, "
    "and must agree with bore, rods and stroke within 1 %. They become crank angles exactly, by crank and connecting "
    "rod; between rows the pressure is straight over the angle. Give `inertia`, or `crank_inertia` to which the mean "
    "of `reciprocating` is added; the torque of the moving masses is exact in the ratio of crank and rod.",
}
