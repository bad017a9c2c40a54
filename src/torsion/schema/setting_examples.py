"""An example of the settings of every analysis and rule."""

SETTINGS = {
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
