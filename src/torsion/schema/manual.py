"""The manual of the file, as Markdown, from the same declarations that read it and that make the JSON Schema."""

from collections.abc import Iterator, Mapping
from fractions import Fraction
from string import Template
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from torsion import units
from torsion.analyses import MODELS, UNBUILT, settings_classes
from torsion.components import KINDS, component
from torsion.components.component import Component
from torsion.components.harmonic_torques import Excitation
from torsion.components.material import STEEL, Material
from torsion.fields import SHARE_OF_MEAN, Amount, Declared, OneOrMany, Quantity
from torsion.rules import RULES
from torsion.rules import settings as rule_settings
from torsion.schema import template
from torsion.schema.cases import CaseKeys
from torsion.schema.declaration_reader import items_of, keys_of, mappings_of
from torsion.schema.scene_reader import LINKS, Scene
from torsion.study import FiniteElements, FrontMatter, ModalDamping, Operation

PLAIN = {
    str: "text", bool: "`true` or `false`", int: "a whole number", float: "a number",
    Fraction: "an exact number: `2`, `0.5` or `21/8`", Amount: "N*m, `5 %` or `{of_mean: 5 %}`",
}  # fmt: skip
COMPONENT, MAPPING = "a component", "a mapping, below"
SEVERAL = {COMPONENT: "components", MAPPING: "mappings, below"}
EXAMPLES = {
    "disc": "- disc: {name: flywheel, inertia: 2.075 kg*m**2, source: drawing}",
    "motor": "- motor: {inertia: 8.5, power: 400 kW, ripple: [{order: 6, torque: 1 %, phase: 30 deg}]}",
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
NOTES = {  # what the keys of a kind need of each other
    "disc": "Give `inertia`, or `held: true`.",
    "motor": "Give `inertia`, or `held: true` (and then no `ripple`). The mean torque enters at the motors; "
    "`power` says their shares of it, never its size, which follows from `operation`.",
    "propeller": "The mean torque leaves at the propellers. `excitation` needs `blades`, ice of a class "
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


def manual() -> str:
    """The text of docs/format.md."""
    return Template(template("manual.md")).substitute(
        quantities=_quantities(),
        top=_table(Scene).replace("see meaning", "section below"),
        document=_table(FrontMatter),
        material=_table(Material),
        steel=f"G {STEEL.shear_modulus / 1e9:g} GPa, E {(STEEL.youngs_modulus or 0.0) / 1e9:g} GPa, "
        f"rho {STEEL.density:g} kg/m**3",
        operation=_with_parts(Operation),
        damping=_table(ModalDamping),
        common=_table(Component),
        kinds="\n".join(_kind(kind) for kind in KINDS),
        links=_words(LINKS),
        excitation=_with_parts(Excitation),
        models=_words(MODELS),
        fem=_table(FiniteElements),
        analyses="\n".join(_settings("analysis", name, kind) for name, kind in settings_classes().items()),
        rules="\n".join(_settings("rule", name, rule_settings(name)) for name in RULES),
        cases=_table(CaseKeys),
        unbuilt=_unbuilt(),
    )


def _kind(kind: str) -> str:
    """The section of one kind: what it is, its keys, an example."""
    declared = component(kind)
    sort = {"point": "a point", "link": "a link", "line": "points and links in a row", "none": "is carried by a point"}[
        declared.sort
    ]
    example = f"```yaml\n{EXAMPLES[kind]}\n```\n"
    words = " ".join([(declared.__doc__ or "").strip().splitlines()[0], *([NOTES[kind]] if kind in NOTES else [])])
    return f"### `{kind}`: {sort}\n\n{words}\n\n{_with_parts(declared, Component)}\n{example}"


def _settings(what: str, name: str, declared: type[Declared]) -> str:
    """The section of an analysis or a rule."""
    example = f"\n```yaml\n{SETTINGS[name]}\n```\n" if name in SETTINGS else ""
    return f"### {what} `{name}`\n\n{_with_parts(declared)}{example}"


def _with_parts(declared: type[Declared], common: type[Declared] | None = None) -> str:
    """The keys of a declaration, then those of every mapping in it and in these, once; `common` has others."""
    text, parts, left = _table(declared, common), dict[type[Declared], str](), [declared]
    while left:
        for key, field in sorted(keys_of(left.pop(0)).items(), key=lambda entry: not entry[1].is_required()):
            for part in mappings_of(field):
                if not issubclass(part, Component) and part not in parts:
                    parts[part] = key
                    left.append(part)
    return text + "".join(f"\nKeys of `{key}`:\n\n{_table(part)}" for part, key in parts.items())


def _words(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def declarations() -> dict[str, type[Declared]]:
    """Every declaration of the format by its word in the file."""
    return {
        **{kind: component(kind) for kind in KINDS},
        "document": FrontMatter,
        "material": Material, "operation": Operation, "damping": ModalDamping, "excitation": Excitation,
        "fem": FiniteElements, "case": CaseKeys,
        **settings_classes(), **{name: rule_settings(name) for name in RULES},
    }  # fmt: skip


def _quantities() -> str:
    """Every SI unit of the format with what it measures."""
    every = (quantity for declared in declarations().values() for quantity in _quantities_of(declared))
    rows = ["| quantity | SI unit | a bare number |", "|---|---|---|"]
    for unit in dict.fromkeys(quantity.unit for quantity in every):
        bare = "is an error" if units.needs_unit(unit) else "is in the SI unit" if unit != "1" else "or a percentage"
        rows.append(f"| {units.speak(unit)} | {'' if unit == '1' else f'`{unit}`'} | {bare} |")
    return "\n".join(rows) + "\n"


def _unbuilt() -> str:
    """What the format has a word for and the program refuses, as a list."""
    rows = [f"- keys of `{kind}`: {_words(component(kind).unbuilt)}" for kind in KINDS if component(kind).unbuilt]
    rows += [f"- analyses: {_words(UNBUILT)}"]
    return "\n".join(rows) + "\n"


def _quantities_of(declared: type[Declared]) -> Iterator[Quantity]:
    """Every quantity in a declaration and in its mappings, components left out."""
    for field in declared.model_fields.values():
        yield from (item for item in items_of(field) if isinstance(item, Quantity))
        for part in mappings_of(field):
            if not issubclass(part, Component):
                yield from _quantities_of(part)


def _table(declared: type[Declared], without: type[Declared] | None = None) -> str:
    """A Markdown table of the keys, the required ones first, but for those that `without` has already."""
    known = set(without.model_fields) if without is not None else set()
    rows = ["| key | value | limits | default | meaning |", "|---|---|---|---|---|"]
    for key, field in sorted(keys_of(declared).items(), key=lambda entry: not entry[1].is_required()):
        if key not in known:
            whole = Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
            limits = ", ".join(dict.fromkeys(_limits(field)))
            cells = (f"`{key}`", _value(whole), limits, _default(field), field.description or "")
            rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows) + "\n" if len(rows) > 2 else "It has no settings.\n"


def _value(annotation: Any) -> str:
    """What may stand there, in words."""
    metadata: list[Any] = []
    while get_origin(annotation) is Annotated:
        annotation, *more = get_args(annotation)
        metadata += more
    for item in metadata:
        if isinstance(item, Quantity) and item.unit == "1":
            return "a number or %"
        if isinstance(item, Quantity):
            return f"`{item.unit}`" + (", unit required" if units.needs_unit(item.unit) else "")
        if isinstance(item, BeforeValidator):
            if item.func is OneOrMany.func:
                return f"{_value(get_args(annotation)[0])}, or a list"
            if item.json_schema_input_type not in (PydanticUndefined, Any):
                return _value(item.json_schema_input_type)
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(_value(part) for part in inner if part is not type(None)))
    if origin is Literal:
        return ", ".join(f"`{choice}`" for choice in inner)
    if origin is tuple:
        words = [_value(part) for part in inner if part is not Ellipsis]
        return f"a list of {SEVERAL.get(words[0], words[0])}" if inner[-1] is Ellipsis else f"[{', '.join(words)}]"
    if origin in (dict, Mapping):
        return f"a mapping of names to {_value(inner[1])}"
    if isinstance(annotation, type) and issubclass(annotation, Declared):
        return COMPONENT if issubclass(annotation, Component) else MAPPING
    return PLAIN.get(annotation, "see meaning")


def _limits(field: FieldInfo) -> Iterator[str]:
    for item in items_of(field):
        if isinstance(item, Quantity):
            yield from (f"{words} {limit:.5g}" for words, limit, _ in item.limits)
            if usual := item.usual_words():
                yield f"usually {usual}"
        if item is Amount:
            yield f"usually {SHARE_OF_MEAN.usual_words()} of the mean"
        for words, name in (("at least", "ge"), ("at most", "le")):
            if isinstance(limit := getattr(item, name, None), int):
                yield f"{words} {limit}"


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "**required**"
    value = field.default
    if isinstance(value, tuple) and len(value) == 1:
        value = value[0]
    if value is None or value in ((), "", {}):
        return ""
    return f"`{str(value).lower()}`" if isinstance(value, bool | str) else f"`{value:g}`"
