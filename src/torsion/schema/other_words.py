"""Words that are no kind of the format, and what the format has for them."""

import re

KIND_FOR = {
    "alternator": "`generator: {inertia: ...}`",
    "exciter": "`generator: {inertia: ...}`",
    "blower": "`fan: {inertia: ...}`",
    "table": "`- table: line.csv` contains only a file",
    "inertia": "`disc: {inertia: ...}`",
    "mass": "`disc: {inertia: ...}`",
    "wheel": "`disc: {inertia: ...}`",
    "flange": "`disc: {inertia: ...}`",
    "brake": "`machine: {inertia: ..., power: ...}`",
    "mill": "`machine: {inertia: ..., power: ...}`",
    "compressor_rotor": "`fan: {inertia: ...}`",
    "hardy_spicer": "`joint: {angle: ...}`",
    "hooke_joint": "`joint: {angle: ...}`",
    "planetary": "`gear: {planetary: {...}}`",
    "rotor": "`motor: {inertia: ...}` or `disc: {inertia: ...}`",
}


def of_its_number(word: str, candidates: list[str]) -> list[str]:
    """The candidates with the figures of the word, in any order: iacs-m86 is a slip for iacs-m68, iacs-m54 is none."""
    figures = sorted(re.findall(r"\d", word))
    return [
        one for one in candidates if not figures or sorted(re.findall(r"\d", one)) in ([], figures)
    ]


ANALYSIS_FOR = {
    "short_circuit": "`transient: {duration: 1 s, events: [{at: ..., time: 0.1 s, short-circuit: {...}}]}`",
    "start": "`transient: {duration: 5 s, initial: {speed: 0 rpm}, events: [...]}`",
    "time": "`transient: {duration: 1 s, events: [...]}`",
    "time_domain": "`transient: {duration: 1 s, events: [...]}`",
    "natural_frequencies": "`modes`",
    "eigenvalues": "`modes`",
    "campbell": "`response`, whose critical speeds the report draws",
    "critical_speeds": "`response`, whose critical speeds the report draws",
    "forced_response": "`response`",
    "harmonic": "`response`",
    "steady_state": "`response`",
    "misfire": "`cases: {misfire: {set: {engine.misfire: 1}}}`",
    "monte_carlo": "`sweep: {samples: 128, vary: {...}}`",
    "optimisation": "`design: {choose: {...}}`",
    "floquet": "`stability`",
    "bending": "`lateral`",
}
KEY_FOR = {  # words of the trade in small letters: keys that may be meant, the likeliest first, each with its meaning
    "moment_of_inertia": {"inertia": "polar mass moment of inertia"},
    "j": {"inertia": "polar mass moment of inertia"},
    "polar_inertia": {"inertia": "polar mass moment of inertia"},
    "gd2": {"inertia": "GD²/4"},
    "wr2": {"inertia": "polar mass moment of inertia"},
    "moi": {"inertia": "polar mass moment of inertia"},
    "k": {"stiffness": "torsional stiffness"},
    "ct": {"stiffness": "torsional stiffness"},
    "torsional_stiffness": {"stiffness": "torsional stiffness"},
    "ctdyn": {"stiffness": "dynamic torsional stiffness"},
    "spring_rate": {"stiffness": "torsional stiffness"},
    "spring_constant": {"stiffness": "torsional stiffness"},
    "compliance": {"flexibility": "1/stiffness"},
    "l": {"length": "length"},
    "len": {"length": "length"},
    "d": {"diameter": "outer diameter"},
    "dia": {"diameter": "outer diameter"},
    "od": {"diameter": "outer diameter"},
    "do": {"diameter": "outer diameter"},
    "di": {"bore": "inner diameter"},
    "id": {"bore": "inner diameter"},
    "wall_thickness": {"bore": "inner diameter"},
    "g": {"material": "name of a material", "shear_modulus": "modulus"},
    "shear_modulus": {"material": "name of a material"},
    "density": {"material": "name of a material"},
    "damping_ratio": {"loss_factor": "eta, about 2 zeta", "psi": "2 pi eta"},
    "zeta": {"loss_factor": "eta, about 2 zeta", "psi": "2 pi eta"},
    "damping": {"viscous": "N*m*s/rad", "psi": "relative damping", "loss_factor": "eta"},
    "c": {"viscous": "N*m*s/rad", "damping": "N*m*s/rad"},
    "eta": {"loss_factor": "eta"},
    "kappa": {"loss_factor": "eta"},
    "m": {"magnifier": "dynamic magnifier"},
    "nominal_torque": {"rated_torque": "T_KN"},
    "tkn": {"rated_torque": "T_KN"},
    "tkw": {"vibratory_torque": "T_KW"},
    "tkmax": {"max_torque": "T_Kmax"},
    "t_kmax1": {"max_torque": "T_Kmax1"},
    "pkw": {"heat_limit": "P_KW"},
    "t_kmax2": {"max_torque_rare": "T_Kmax2"},
    "permissible_heat": {"heat_limit": "P_KW"},
    "power_loss": {"heat_limit": "P_KW"},
    "backlash": {"clearance": "backlash"},
    "play": {"clearance": "backlash"},
    "gap": {"clearance": "backlash"},
    "friction": {"hysteresis_torque": "dry friction"},
    "i": {"ratio": "speed before / speed after"},
    "reduction": {"ratio": "speed before / speed after"},
    "gear_ratio": {"ratio": "speed before / speed after"},
    "number_of_teeth": {"teeth": "[driving, driven]"},
    "z": {"teeth": "number of teeth", "blades": "number of blades"},
    "n_blades": {"blades": "number of blades"},
    "number_of_blades": {"blades": "number of blades"},
    "added_mass": {"entrained": "entrained water"},
    "added_inertia": {"entrained": "entrained water"},
    "added_water": {"entrained": "entrained water"},
    "water": {"entrained": "entrained water"},
    "grounded": {"held": "a fixed end"},
    "clamped": {"held": "a fixed end"},
    "deflection": {"angle": "angle between the shafts"},
    "bend": {"angle": "angle between the shafts"},
    "inclination": {"angle": "angle between the shafts"},
    "beta": {"angle": "angle between the shafts"},
    "stroke_cycle": {"strokes": "2 or 4"},
    "cycles": {"strokes": "2 or 4"},
    "cylinder_number": {"cylinders": "number"},
    "firing_sequence": {"firing_order": "cylinders as they fire"},
    "bank_angle": {"firing_angles": "include it"},
    "v_angle": {"firing_angles": "include the bank angle"},
    "vee_angle": {"firing_angles": "include the bank angle"},
    "torque_rating": {"rated_torque": "T_KN"},
    "continuous_torque": {"rated_torque": "T_KN"},
    "initial_speed": {"initial": "{speed: 1500 rpm}"},
    "start_speed": {"initial": "{speed: 1500 rpm}"},
    "rise_time": {"length": "duration of the rise"},
    "ramp_time": {"length": "duration of the ramp"},
    "short_circuit": {"short-circuit": "{coefficients, decay}"},
    "ignition_order": {"firing_order": "cylinders as they fire"},
    "conrod": {"rod_length": "length of the rod"},
    "connecting_rod": {"rod_length": "length of the rod"},
    "bmep": {"imep": "indicated mean effective pressure"},
    "rpm": {"speed": "with the unit rpm", "speeds": "{from, to}", "rated": "{speed, power}"},
    "mcr": {"rated": "{speed, power}"},
    "rated_speed": {"rated": "{speed, power}"},
    "rated_power": {"rated": "{speed, power}", "power": "rated power"},
    "kw": {"power": "with the unit kW"},
    "speed_range": {"speeds": "{from, to}"},
    "range": {"speeds": "{from, to}"},
    "minimum": {"from": "first value"},
    "min": {"from": "first value"},
    "max": {"to": "last value"},
    "maximum": {"to": "last value"},
    "amplitude": {"torque": "amplitude (zero to peak)"},
    "harmonic": {"order": "cycles per revolution"},
    "freq": {"frequency": "with a unit"},
    "number_of_modes": {"count": "number of modes"},
    "n": {"count": "number"},
    "uts": {"tensile_strength": "tensile strength"},
    "yield": {"yield_strength": "yield strength"},
    "e": {"youngs_modulus": "Young's modulus"},
    "rho": {"density": "density"},
    "fillet": {"step": "corner to the next shaft", "notches": "details of the shaft"},
    "title": {"name": "title"},
    "keyway": {"features": "features: keyway"},
    "units": {"unit": "unit"},
    "components": {"train": "components"},
    "elements": {"train": "components", "segments": "number"},
    "system": {"train": "components"},
    "scenarios": {"cases": "variants"},
    "load_cases": {"cases": "variants"},
    "output": {"analyses": "results"},
}


def key_for(word: str, keys: list[str]) -> str:
    """Return what to write for a word of the trade among these keys; empty for a word that means none of them.

    A word without an entry means the last key that is a part of it.

    >>> key_for("gear_teeth", ["teeth", "ratio"])
    'write `teeth`'
    """
    spelled = word.casefold().replace("-", "_").replace(" ", "_")
    meant = KEY_FOR.get(spelled, {})
    possible = [f"`{key}` ({meaning})" for key, meaning in meant.items() if key in keys]
    if not possible:
        possible = [f"`{part}`" for part in spelled.split("_") if part in keys][-1:]
    return f"write {' or '.join(possible)}" if possible else ""
