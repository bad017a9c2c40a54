"""Examples of every kind of component, analysis and rule, and the groups of keys of long kinds."""

EXAMPLES = {
    "disc": "- disc: {name: flywheel, inertia: 2.075 kg*m**2, source: drawing}",
    "motor": "- motor: {inertia: 8.5}\n"
    "- motor: {inertia: 8.5, power: 400 kW, ripple: [{order: 6, torque: 1 %, phase: 30 deg}]}",
    "turbine": "- turbine: {inertia: 1800 kg*m**2, source: drawing}",
    "generator": "- generator: {inertia: 95, power: 1200 kW}\n"
    "- generator: {inertia: 95, power: 1200 kW, load: constant-power, ripple: [{order: 2, torque: 1 %}]}",
    "pump": "- pump: {inertia: 3, power: 400 kW}\n"
    "- pump: {inertia: 3, entrained: 20 %, power: 400 kW, load: {exponent: 2, at_rest: 20 %}, blades: 6,\n"
    "         excitation: [{blade_order: 1, torque: 2 %}]}",
    "fan": "- fan: {inertia: 45 kg*m**2, power: 200 kW, speed: 1470 rpm}",
    "machine": "- machine: {inertia: 2600, torque: 30 kN*m}\n"
    "- machine: {name: mill, inertia: 2600, torque: 30 kN*m, load: constant,\n"
    "           excitation: [{order: 3, torque: 5 %}]}",
    "propeller": "- propeller: {inertia: 42}\n"
    "- propeller: {inertia: 42, entrained: 25 %, blades: 4, damping: {model: archer, factor: 30},\n"
    "              excitation: [{blade_order: 1, torque: 6 %}, {blade_order: 2, torque: 2 %}]}",
    "damper": "- damper: {housing: 1.5, ring: 4, damping: 600 N*m*s/rad}\n"
    "- damper: {housing: 1.5, ring: 4, silicone: {viscosity: 0.15 m**2/s, shape: 5 m**3, temperature: 75 degC}}",
    "pendulum": "- pendulum: {mass: 1.2 kg, number: 4, arm: 80 mm, order: 3, inertia: 0.02}",
    "shaft": "- shaft: {length: 4.5 m, diameter: 150 mm}\n"
    "- shaft: {length: 4.5 m, diameter: [150 mm, 140 mm], bore: 40 mm, role: propeller, features: shrink fit}",
    "coupling": "- coupling: {stiffness: 40 kN*m/rad, psi: 0.9}\n"
    "- coupling: {stiffness: 40 kN*m/rad, inertia: [0.9, 0.6], psi: 0.9, vibratory_torque: 1.2 kN*m}\n"
    "- coupling: {stiffness: 70 kN*m/rad, psi: 1.1, max_torque: 15 kN*m, max_torque_rare: 45 kN*m}\n"
    "- coupling: {stiffness: 2 MN*m/rad, clearance: {angle: 0.2 deg, viscous: 40}}\n"
    "- coupling: {stiffness: 950, hysteresis_torque: 7 N*m, stages: [{from: 12 deg, stiffness: 4000}]}\n"
    "- coupling: {stiffness: 80 kN*m/rad, capacity: 400 N*m}",
    "gear": "- gear: {ratio: 3}\n"
    "- gear: {teeth: [31, 93], inertia: [0.25, 14], branches: [{teeth: 62, train: [disc: {inertia: 2}]}]}\n"
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
SETTINGS = {  # an example of every analysis and rule
    "modes": "modes: {count: 8}",
    "response": "response: {orders: [2, 21/8], frequencies: {from: 1 Hz, to: 200 Hz, steps: 400}}",
    "stability": "stability: {speeds: {from: 300 rpm, to: 1800 rpm}, map: {over: angle, from: 1 deg, to: 20 deg}}",
    "joints": "joints: {optimise: phase, torque: 800 N*m}",
    "lateral": "lateral: {modes: 4, shear: true}",
    "transient": "transient: {duration: 2 s, events: [{at: motor-1, time: 0.1 s, step: {torque: 100 N*m}}]}",
    "tolerances": "tolerances: {aim: [{mode: 2, frequency: 40 Hz}]}",
    "sweep": "sweep: {vary: {coupling-1.stiffness: {uniform: +-15 %}, disc-1.inertia: {normal: 2 %}}, samples: 256}",
    "fit": "fit:\n  vary: {coupling-1.stiffness: 20 %, disc-1.inertia: 5 %}\n  measured:\n"
    "  - {mode: 1, frequency: 17.9 Hz, within: 0.5 %}\n"
    "  - {torsiogram: [{speed: 600 rpm, amplitude: 0.1 deg}], at: motor-1, order: 2, quantity: angle, within: 5 %}",
    "design": "design: {choose: {shaft-1.diameter: {from: 55 mm, to: 80 mm}},\n"
    "         keep: [{mode-2.frequency: {outside: [30 Hz, 36 Hz]}}]}",
    "check": "check: {models: [lumped, exact], tolerance: 0.1 %}",
    "iacs-m68": "iacs-m68: {drive: electric, tachometer: 2 %}",
    "iacs-m53": "iacs-m53: {pin: 200 mm, journal: 200 mm, pin_fillet: 12 mm, journal_fillet: 12 mm,\n"
    "           web_thickness: 70 mm, web_width: 260 mm, radius: 140 mm, bending: 40 MPa, shear: 5 MPa, strokes: 4}",
    "kr": "kr: {strokes: 4, arrangement: in-line, cylinders: 6, duty: generator set}",
    "lr": "lr: {tachometer: 2 %}",
    "dnv": "dnv: {drive: electric}",
    "abs": "abs: {alloy: line shaft}",
    "bv": "bv: {drive: slip coupling}",
    "ccs": "ccs: {tachometer: 2 %}",
    "nk": "nk: {strokes: 2, arrangement: in-line}",
    "rina": "rina: {drive: turbine}",
    "api-610": "api-610: {continuous: {from: 1450 rpm, to: 1500 rpm}, line_frequency: 50 Hz}",
    "api-617": "api-617: {line_frequency: {nominal: 60 Hz, tolerance: 2 %}}",
    "api-618": "api-618: {continuous: {from: 980 rpm, to: 990 rpm}, line_frequency: 50 Hz}",
    "api-684": "api-684: {continuous: {from: 3000 rpm, to: 3600 rpm}}",
    "mil-std-167": "mil-std-167: {continuous: {from: 400 rpm, to: 1200 rpm}}",
    "engine-maker": "engine-maker: {crank_stress: 40 MPa}",
    "nvh": "nvh: {at: gearbox, acceleration: 300 rad/s**2, fluctuation: 15 rpm, order: 3}",
    "coupling-maker": "coupling-maker: {continuous: {from: 400 rpm, to: 1800 rpm}}",
    "gear-hammer": "gear-hammer: {limit: 0.35}",
    "fillets": "fillets: {continuous: {from: 600 rpm, to: 1500 rpm}}",
    "shrink-fits": "shrink-fits: {safety: 2}",
    "ice": "ice: {factor: 1.3}",
    "universal-joints": "universal-joints: {speed_angle: 17000}",
}
GROUPS = {  # headings of the keys of long kinds
    "coupling": {
        "Stiffness": (
            "stiffness",
            "flexibility",
            "table",
            "prony",
            "fractional",
            "temperature",
        ),
        "Inertia and damping": (
            "inertia",
            "viscous",
            "loss_factor",
            "psi",
            "magnifier",
        ),
        "Ratings of the manufacturer": (
            "rated_torque",
            "vibratory_torque",
            "max_torque",
            "max_torque_rare",
            "max_torque_range",
            "heat_limit",
            "heat_limit_misfire",
            "tolerance",
        ),
        "Backlash, friction, stages, clutch": (
            "clearance",
            "hysteresis_torque",
            "stages",
            "capacity",
        ),
        "Library": (
            "from",
            "size",
        ),
    },
    "shaft": {
        "Dimensions": (
            "length",
            "diameter",
            "bore",
            "section",
            "sections",
        ),
        "Material and model": (
            "material",
            "loss_factor",
            "segments",
        ),
        "Details and strength": (
            "role",
            "features",
            "step",
            "notches",
            "hub",
            "endurance",
        ),
        "Bending": ("support",),
    },
    "gear": {
        "Ratio": (
            "ratio",
            "teeth",
            "planetary",
            "sense",
            "referred",
        ),
        "Inertia and stiffness": (
            "inertia",
            "mesh_stiffness",
        ),
        "Further wheels": (
            "branches",
            "differential",
        ),
        "Ratings": (
            "application_factor",
            "max_torque",
        ),
        "Tooth geometry": (
            "module",
            "pitch_diameter",
            "helix_angle",
            "pressure_angle",
        ),
    },
    "engine": {
        "Cylinders and firing": (
            "cylinders",
            "strokes",
            "firing_order",
            "firing_angles",
            "throws",
            "reverse",
            "phase",
        ),
        "Crankshaft": (
            "inertia",
            "crank_inertia",
            "stiffness",
            "damping",
            "loss_factor",
            "journal",
            "pin",
            "material",
            "web",
        ),
        "Excitation": (
            "geometry",
            "masses",
            "gas",
            "power",
            "mechanical_efficiency",
            "orders",
        ),
        "Misfire and imbalance": (
            "misfire",
            "cut_out",
            "keep_power",
            "imbalance",
        ),
    },
    "propeller": {
        "Inertia and damping": (
            "inertia",
            "held",
            "tolerance",
            "entrained",
            "damping",
        ),
        "Power and load": (
            "power",
            "torque",
            "speed",
            "load",
            "drive",
        ),
        "Geometry": (
            "blades",
            "diameter",
            "pitch",
            "pitch_ratio",
            "hub_ratio",
            "area_ratio",
            "ducted",
        ),
        "Excitation": ("excitation",),
    },
}
