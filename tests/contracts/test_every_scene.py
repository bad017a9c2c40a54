"""Every scene of shafting_specs, solved once, holds every law of scenes."""

from collections.abc import Callable

import pytest
from tests.contracts import scene_laws, test_tables_recomputed
from tests.contracts.frozen import SCENES
from tests.contracts.test_frozen_digits import (
    digits_are_the_frozen_ones,
    every_figure_is_an_element_with_all_its_lines_and_a_name_of_its_own,
)
from tests.contracts.test_tables_are_results import (
    every_number_of_a_table_is_a_declared_result,
)
from tests.for_all import for_all

LAWS = (
    scene_laws.is_valid_against_the_json_schema,
    scene_laws.every_frequency_is_certified_and_inside_its_bounds,
    scene_laws.the_table_of_scenes_says_what_is_computed,
    scene_laws.every_response_is_finite_with_a_status_and_a_small_residual,
    scene_laws.the_report_read_from_its_results_is_the_one_of_solve,
    scene_laws.every_motion_over_time_balances_its_energy_and_can_be_trusted,
    scene_laws.every_rule_of_the_scene_gives_a_verdict_on_a_finite_value,
    digits_are_the_frozen_ones,
    every_figure_is_an_element_with_all_its_lines_and_a_name_of_its_own,
    every_number_of_a_table_is_a_declared_result,
    *test_tables_recomputed.LAWS,
)


# Half of the time of all: tests/scenes/test_slow_scenes.py holds the same laws for these.
SLOW = (
    "diesel_misfire",
    "ice_thruster",
    "idling_gearbox",
    "locked_train",
    "small_truck",
    "six_stations",
    "tripod_drive",
    "truck_gears",
    "twin_diesel_ferry",
    "two_stroke_ship",
    "v12_generator_set",
)


@pytest.mark.parametrize("scene", [name for name in SCENES if name not in SLOW])
@for_all("law", LAWS)
def test_a_scene_holds_every_law(law: Callable[[str], None], scene: str) -> None:
    law(scene)
