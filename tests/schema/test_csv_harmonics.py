"""CSV files stand for the harmonics of an engine's gas torque, with the faults of their own lines and columns."""

import hashlib
from pathlib import Path

import pytest
from tests.faults.test_faulty_files import HERE
from tests.for_all import for_all

import torsion
from torsion.errors import InputError
from torsion.kernels.engine.gas_torque import CylinderOrder
from torsion.output.chapters.closing import input_file
from torsion.output.write import inputs
from torsion.primitives import Torque
from torsion.study import Study

GOOD = (HERE / "engine.yaml").read_text(encoding="utf-8")
TABLE = "{table: [[1.5, 420 N*m, -80 deg], [3, 3 bar, 5 deg]], at: {imep: 18 bar}}"
POLAR = "order,amplitude [bar],phase [deg]\n0.5,7.25,-43.5\n3,5.75,-98\n"
WRITTEN = "[[0.5, 7.25 bar, -43.5 deg], [3, 5.75 bar, -98 deg]]"
DIAGRAM = "angle [deg], pressure [bar]\n-360, 2.4\n0, 40\n20, 120\n360, 2.4\n"


@pytest.fixture
def read(tmp_path: Path):
    """The study of an engine with a gas torque, and CSV files by name."""

    def made(gas: str, more: str = "", **files: str) -> Study:
        for name, text in files.items():
            (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
        scene = tmp_path / "engine.yaml"
        scene.write_text(GOOD.replace(TABLE, gas) + more, encoding="utf-8")
        return torsion.read(scene)

    return made


def law(torque: Torque) -> tuple[object, ...]:
    one = torque.cylinder
    assert isinstance(one, CylinderOrder)
    assert one.gas is not None
    motored = () if one.gas.motored is None else one.gas.motored.tolist()
    return (
        torque.station,
        torque.order,
        one.turned,
        one.load,
        one.gas.at.tolist(),
        one.gas.firing.tolist(),
        motored,
    )


@pytest.mark.parametrize(
    "text",
    [
        POLAR,
        "# of the maker\norder;amplitude [bar];phase [deg]\n0,5;7,25;-43,5\n3,0;5,75;-98,0\n",
        "phase [deg]\tamplitude [MPa]\torder\n-43.5\t0.725\t0.5\n-98\t0.575\t3\n",
        "order,amplitude,phase [deg]\n0.5,7.25 bar,-43.5\n3,5.75 bar,-98\n",
    ],
    ids=["commas", "semicolons", "tabs", "units in the cells"],
)
def test_a_file_of_harmonics_is_the_table_that_it_holds(text: str, read) -> None:
    own = read("{table: h.csv, motored: h.csv, at: {imep: 18 bar}}", h=text)
    written = read(f"{{table: {WRITTEN}, motored: {WRITTEN}, at: {{imep: 18 bar}}}}")
    assert [law(one) for one in own.train.torques] == [law(one) for one in written.train.torques]
    assert own.tables == (("h.csv", text),)


def test_a_file_of_cosines_and_sines_is_the_table_that_it_holds(read) -> None:
    own = read(
        "{table: h.csv, at: {imep: 18 bar}}", h="order,a [N*m],b [N*m]\n0.5,70,410\n3,-5,60\n"
    )
    rows = "[{order: 0.5, a: 70 N*m, b: 410 N*m}, {order: 3, a: -5 N*m, b: 60 N*m}]"
    written = read(f"{{table: {rows}, at: {{imep: 18 bar}}}}")
    assert [law(one) for one in own.train.torques] == [law(one) for one in written.train.torques]


def test_one_file_holds_the_tables_of_several_loads(read) -> None:
    rows = POLAR.splitlines()[1:]
    every = [f"{load},{row}" for load in (1, 30) for row in rows]
    text = "\n".join(["imep [bar],order,amplitude [bar],phase [deg]", *every])
    each = "{imep: 1 bar, rows: h.csv}, {imep: 30 bar, rows: " + WRITTEN + "}"
    one, several = read("{tables: t.csv}", t=text), read(f"{{tables: [{each}]}}", h=POLAR)
    assert [law(torque) for torque in one.train.torques] == [
        law(torque) for torque in several.train.torques
    ]
    assert several.tables == (("h.csv", POLAR),)


def test_a_case_has_a_file_of_its_own(read) -> None:
    more = "cases: {test bed: {set: {main engine.gas.table: other.csv}}}\n"
    found = read(
        "{table: h.csv, at: {imep: 18 bar}}", more, h=POLAR, other=POLAR.replace("5.75", "6")
    )
    assert law(found.train.torques[0]) != law(found.cases["test bed"].train.torques[0])


FAULTS = {  # file; line and column; words
    "unit": (POLAR.replace("bar", "kg"), "1:7", "mass"),
    "no unit": (POLAR.replace(" [deg]", ""), "1:23", "`phase` no unit"),
    "column": (POLAR.replace("phase", "angle"), "1:1", "`phase` missing"),
    "unknown column": (POLAR.replace("order", "ordre"), "1:1", "ordre order"),
    "amplitude": (POLAR.replace("7.25", "much"), "2:5", "neither torque pressure"),
    "negative": (POLAR.replace("5.75", "-5.75"), "3:3", "negative"),
    "order": (POLAR.replace("\n3,", "\nthird,"), "3:1", "'third' number"),
    "not of four strokes": (POLAR.replace("\n3,", "\n3.2,"), "3:1", "16/5 multiple of 1/2"),
    "twice": (POLAR.replace("\n3,", "\n0.5,"), "3:1", "1/2 twice"),
    "empty cell": (POLAR.replace("-98", ""), "3:1", "no `phase`"),
    "short row": (POLAR.replace(",-98", ""), "3:1", "2 cells"),
    "sine": ("order,a [bar],b [bar]\n1,5,\n2,3,4\n", "2:1", "no `b`"),
    "nothing": ("", "1:1", "nothing"),
    "head alone": ("order,amplitude [bar],phase [deg]\n", "1:1", "no rows"),
}


@for_all("case", FAULTS)
def test_a_fault_stands_at_its_line_and_column_of_the_file(case: str, read) -> None:
    text, place, words = FAULTS[case]
    with pytest.raises(InputError) as error:
        read("{table: h.csv, at: {imep: 18 bar}}", h=text)
    first = error.value.faults[0]
    assert (Path(first.file).name, f"{first.line}:{first.column}") == ("h.csv", place)
    assert [word for word in words.split() if word not in f"{first.message} ({first.hint})"] == []


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("imep [bar],order,amplitude [bar],phase [deg]\n2,3,5,0\n,6,2,0\n", "3:2", "no `imep`"),
        ("imep [bar],order,amplitude [bar],phase [deg]\n2,3,5,0\n9,3,5\n", "3:1", "3 cells"),
        ("order,amplitude [bar],phase [deg]\n2,3,5\n", "1:1", "`imep` missing"),
        (
            "imep [bar],order,amplitude [bar],phase [deg]\n2,3,5,0\n9,6,2,0\n",
            "16:21",
            "order 3 some of the tables",
        ),
    ],
)
def test_a_fault_of_several_loads_stands_at_its_place(
    text: str, place: str, words: str, read
) -> None:
    with pytest.raises(InputError) as error:
        read("{tables: t.csv}", t=text)
    first = error.value.faults[0]
    assert [word for word in words.split() if word not in f"{first.message} ({first.hint})"] == []
    assert f"{first.line}:{first.column}" == place


def test_files_of_an_engine_are_read_files_with_their_checksums(read, tmp_path: Path) -> None:
    own = "{diagram: p.csv, tdc: 0 deg, absolute: true}"
    for gas, name, text in (
        (own, "p", DIAGRAM),
        ("{table: h.csv, at: {imep: 18 bar}}", "h", POLAR),
    ):
        study = read(gas, **{name: text})
        assert tmp_path / f"{name}.csv" in inputs(study)
        page = " ".join(str(block) for block in input_file(torsion.run(study, only=["modes"])))
        assert hashlib.sha256(text.encode()).hexdigest() in page
