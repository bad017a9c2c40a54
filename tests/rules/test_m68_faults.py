"""What a file lacks for `iacs-m68`, stated where it stands."""

from torsion.model.component import STEEL, Material
from torsion.rules.class_rules import m68
from torsion.rules.class_rules.m68_shafts import classed_shafts

BLADES = [{"blade_order": 1, "torque": 10.0}]
SCREW = (
    "propeller",
    {"name": "screw", "inertia": 5.0, "pitch": "fixed", "blades": 4, "excitation": BLADES},
)


def line(role="intermediate", **shaft):
    body = {"name": "line", "length": 1.0, "diameter": 0.1, "role": role, **shaft}
    return [("motor", {"inertia": 3.0}), ("shaft", body), SCREW]


def messages(scene, requested):
    return {fault.path: fault.message for fault in m68.M68(requested).faults(scene)}


def test_a_whole_file_has_no_fault(study) -> None:
    assert list(m68.M68(m68.M68Settings()).faults(study(line()))) == []


def test_strength_that_is_missing_is_told_at_the_shaft(study) -> None:
    soft = {"soft": Material(shear_modulus=79e9, density=7850.0)}
    found = messages(study(line(material="soft"), materials=soft), m68.M68Settings())
    assert "tensile_strength" in found["train", 1, "shaft", "material"]


def test_built_in_steel_counts_as_the_softest_shaft_steel_and_says_so(study) -> None:
    plain = study(line(material="steel"), materials={"steel": STEEL})
    assert list(m68.M68(m68.M68Settings()).faults(plain)) == []
    (shaft,) = classed_shafts(plain, m68.M68Settings())
    assert shaft.strength == 400.0
    assert "none stated" in shaft.notes[0]


def test_rated_speed_and_speeds_that_are_missing_are_told(study) -> None:
    found = messages(study(line(), rated=None, speeds=None), m68.M68Settings())
    assert {("operation", "rated"), ("operation", "speeds")} == set(found)


def test_train_that_nothing_excites_cannot_be_judged(study) -> None:
    requested = m68.M68Settings()
    quiet = [*line()[:2], ("disc", {"inertia": 1.0})]
    assert (
        "nothing excites"
        in messages(study(quiet, [("iacs-m68", requested)]), requested)["rules", 0]
    )


def test_train_without_a_role_cannot_be_judged(study) -> None:
    requested = m68.M68Settings()
    assert "role" in messages(study(line(None), [("iacs-m68", requested)]), requested)["rules", 0]


def test_settings_name_shafts_that_exist(study) -> None:
    requested = m68.M68Settings.model_validate(
        {"alloy": ["lime"], "slots": {"line": {"length": 0.07, "width": 0.02}}}
    )
    found = messages(study(line(), [("iacs-m68", requested)]), requested)
    assert set(found) == {
        ("rules", 0, "iacs-m68", "alloy", 0),
        ("rules", 0, "iacs-m68", "slots", "line"),
    }


def test_settings_of_the_shafts_that_are_judged_are_no_fault(study) -> None:
    requested = m68.M68Settings.model_validate(
        {"alloy": ["line"], "slots": {"line": {"length": 0.07, "width": 0.02}}}
    )
    assert (
        list(m68.M68(requested).faults(study(line(features=["slot"]), [("iacs-m68", requested)])))
        == []
    )


def test_a_setting_that_names_no_shaft_is_pointed_at_with_the_shafts_there_are(study) -> None:
    slots = {"lime": {"length": 0.07, "width": 0.02}}
    requested = m68.M68Settings.model_validate({"alloy": ["line", "screw", "lime"], "slots": slots})
    parts = [
        *line()[:2],
        ("shaft", {"name": "tail", "length": 1.0, "diameter": 0.1, "role": "propeller"}),
        SCREW,
    ]
    scene = study(parts, [("other", None), ("iacs-m68", requested)])
    found = list(m68.M68(requested).faults(scene))
    where = "rules", 1, "iacs-m68"
    assert [(fault.path, fault.at_key) for fault in found] == [
        ((*where, "alloy", 1), False),
        ((*where, "alloy", 2), False),
        ((*where, "slots", "lime"), True),
    ]
    assert {fault.hint for fault in found} == {"there is line, tail"}
    assert found[1].message == "no shaft with a role is called 'lime'"
    assert found[2].message == "no shaft with a role and the feature `slot` is called 'lime'"


def test_strength_that_is_missing_is_asked_for_as_the_file_writes_it(study) -> None:
    soft = {"soft": Material(shear_modulus=79e9, density=7850.0)}
    (fault,) = list(m68.M68(m68.M68Settings()).faults(study(line(material="soft"), materials=soft)))
    assert fault.hint == "materials: {soft: {..., tensile_strength: 600 MPa}}"
    assert (
        fault.message
        == "`tensile_strength` of 'soft' is not given, and iacs-m68 needs it for 'line'"
    )
    stated = {"soft": Material(shear_modulus=79e9, density=7850.0, tensile_strength=410e6)}
    assert (
        list(m68.M68(m68.M68Settings()).faults(study(line(material="soft"), materials=stated)))
        == []
    )
