"""Titles and first sentences of the manual's pages of analyses and rules."""

ANALYSES_AND_RULES = {
    "modes": (
        "natural frequencies and mode shapes",
        "Computes undamped natural frequencies with guaranteed bounds, mode shapes and damped modes.",
    ),
    "response": (
        "forced vibration over speed and frequency",
        "Computes the vibratory torques, angles and stresses of every order, and the total vibratory torque.",
    ),
    "stability": (
        "parametric stability of trains with joints",
        "Finds the speeds at which small deviations from the periodic motion grow.",
    ),
    "tolerances": (
        "frequency bands, sensitivities and target frequencies",
        "Computes guaranteed bounds of natural frequencies, sensitivities, and stiffnesses for target frequencies.",
    ),
    "joints": (
        "kinematics of universal joints and optimum phase",
        "Computes speed fluctuation, accelerations and secondary couples of joints, and the optimum phase or angle.",
    ),
    "lateral": (
        "bending and whirl of shafts between joints and supports",
        "Computes bending frequencies of shafts, whirl over speed and the response to secondary couples.",
    ),
    "transient": (
        "transient response: start-up, short circuit, clutch, ice",
        "Computes the motion of the train over time, after events at its points.",
    ),
    "sweep": (
        "parameter study, Monte Carlo and Sobol indices",
        "Solves many variants of the file, and computes failure probabilities and sensitivities.",
    ),
    "design": (
        "optimisation of couplings, shafts and joints",
        "Finds values of the design variables with the largest margin, within constraints.",
    ),
    "fit": (
        "model updating from measured frequencies and torsiograms",
        "Updates parameters of the model to measurements, with their deviations.",
    ),
    "check": (
        "comparison of lumped, finite-element and exact models",
        "Compares the shaft models with the exact model, and fails if an error exceeds the tolerance.",
    ),
    "iacs-m68": (
        "IACS UR M68, propulsion shafts",
        "Checks stresses, barred speed ranges and minimum diameters of shafts by IACS UR M68 (Rev. 3, 2021).",
    ),
    "iacs-m53": (
        "IACS UR M53, crankshafts",
        "Checks the fillets and the oil bore of a crankshaft. Nominal bending stresses come from the manufacturer.",
    ),
    "kr": ("Korean Register, shafts and crankshafts", ""),
    "lr": ("Lloyd's Register, shafts", ""),
    "dnv": ("DNV, shafts", ""),
    "abs": ("American Bureau of Shipping, shafts", ""),
    "bv": ("Bureau Veritas, shafts", ""),
    "ccs": ("China Classification Society, shafts", ""),
    "nk": ("ClassNK, shafts and crankshafts", ""),
    "rina": ("RINA, shafts", ""),
    "api-610": ("API 610 separation margins, pumps", ""),
    "api-617": ("API 617 separation margins, compressors", ""),
    "api-618": ("API 618 separation margins, reciprocating compressors", ""),
    "api-684": ("API 684 separation margins, rotor dynamics", ""),
    "mil-std-167": (
        "MIL-STD-167 torsional vibration, type III",
        "Checks vibratory stresses of shafts and vibratory torques of gears by MIL-STD-167.",
    ),
    "engine-maker": (
        "crankshaft stress by the engine manufacturer",
        "Checks the nominal stress of the crankshaft against the limit of the engine manufacturer.",
    ),
    "nvh": (
        "angular acceleration and speed fluctuation",
        "Checks angular acceleration and speed fluctuation at a station against limits of the file (gear rattle).",
    ),
    "coupling-maker": (
        "coupling ratings T_KN, T_KW, T_Kmax and P_KW (DIN 740-2)",
        "Checks the torques and the power loss of couplings against the ratings of the manufacturer.",
    ),
    "gear-hammer": (
        "vibratory torque in gear meshes",
        "Checks the vibratory torque in a mesh against its rating (K_A) and against the mean torque.",
    ),
    "fillets": (
        "endurance of shaft fillets and notches",
        "Checks the vibratory shear stress in fillets and notches against the endurance limit of the file.",
    ),
    "shrink-fits": (
        "slip torque of shrink fits",
        "Checks the maximum torque of a shaft in a hub against the slip torque.",
    ),
    "ice": (
        "peak torques in ice",
        "Checks maximum torques in ice against the yield of shafts and the ratings of couplings and gears.",
    ),
    "universal-joints": (
        "manufacturer's limits of cardan shafts",
        "Checks speed fluctuation, accelerations, speed times angle and tube speed of joints.",
    ),
}
SAME_SENTENCE = {  # first words of a name: of rules that share one class
    "api": "Checks that natural frequencies keep a margin from every possible excitation over the operating range.",
    "": "Checks line shafts by IACS UR M68. Crankshafts and generator shafts follow the table of the society, if the "
    "program has it; the report lists what is not checked.",
}


def title_and_sentence(name: str, otherwise: str) -> tuple[str, str]:
    """Return title and first sentence of an analysis or a rule; `otherwise` stands in for an unlisted name."""
    if name not in ANALYSES_AND_RULES:
        return otherwise, ""
    title, sentence = ANALYSES_AND_RULES[name]
    return title, sentence or SAME_SENTENCE.get(name.partition("-")[0], SAME_SENTENCE[""])
