"""Tables of CSV files stand for the lists that they are named in, with the same validation and the same faults."""

import contextlib
import csv
import hashlib
import io
import json
import re
from itertools import cycle
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.contracts.frozen import SCENES, solved
from tests.for_all import for_all

import torsion
from torsion.errors import Fault, InputError
from torsion.findings import Findings
from torsion.output.blocks import Paragraph, Verbatim
from torsion.output.chapters.closing import input_file
from torsion.output.stored.results_json import results
from torsion.schema.scene_reader import located
from torsion.schema.scene_tables import with_tables
from torsion.schema.table_rows import MAPPINGS, PAIRS
from torsion.schema.yaml_source import parse_source
from torsion.study import Study

SI = {
    "inertia": "kg*m**2",
    "stiffness": "N*m/rad",
    "mesh_stiffness": "N*m/rad",
    "flexibility": "rad/(N*m)",
    "length": "m",
    "diameter": "m",
    "bore": "m",
    "radius": "m",
    "arm": "m",
    "damping": "N*m*s/rad",
    "power": "W",
    "viscous": "N*m*s/rad",
    "rated_torque": "N*m",
    "vibratory_torque": "N*m",
    "max_torque": "N*m",
    "capacity": "N*m",
    "max_torque_rare": "N*m",
    "max_torque_range": "N*m",
    "heat_limit": "W",
    "torque": "N*m",
    "hysteresis_torque": "N*m",
    "entrained": "kg*m**2",
    "housing": "kg*m**2",
    "ring": "kg*m**2",
    "frequency": "Hz",
    "crank_inertia": "kg*m**2",
}
NUMBER = re.compile(r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)(?: (.*))?")
BESIDE = (  # other files lie beside theirs
    "design_coupling",
    "keyed_shaft",
    "library_coupling",
    "measured_drive",
    "reciprocating_compressor",
)
DIALECTS = {"commas": (",", "."), "semicolons": (";", ","), "tabs": ("\t", ".")}


def as_csv(entries: list[dict[str, Any]], separator: str, sign: str) -> str:
    """Mappings as a table whose header has the unit of a column where all its cells have one, or the SI unit."""
    keys = list(dict.fromkeys(key for entry in entries for key in entry))
    units = {key: unit_of(key, [entry[key] for entry in entries if key in entry]) for key in keys}
    target = io.StringIO()
    write = csv.writer(target, delimiter=separator, lineterminator="\r\n")
    write.writerow([f"{key} [{units[key]}]" if units[key] else key for key in keys])
    for entry in entries:
        write.writerow([cell(entry[key], units[key], sign) if key in entry else "" for key in keys])
    return target.getvalue()


def unit_of(key: str, values: list[Any]) -> str:
    found = [NUMBER.fullmatch(value) if isinstance(value, str) else None for value in values]
    units = {one[2] or "" if one else "" for one in found}
    if len(units) == 1 and units != {""} and key not in ("name", "note", "source"):
        return units.pop()
    is_bare = [
        isinstance(one, int | float)
        for value in values
        for one in (value if isinstance(value, list) else [value])
    ]
    return SI.get(key, "") if any(is_bare) else ""


def cell(value: Any, unit: str, sign: str) -> str:
    if isinstance(value, dict | list):
        return json.dumps(value, ensure_ascii=False)
    text = str(value).lower() if isinstance(value, bool) else str(value)
    number = NUMBER.fullmatch(text)
    if number and unit and number[2] == unit:
        text = number[1]
    return text.replace(".", sign, 1) if number else text


def row(kind: str, body: dict[str, Any] | None) -> dict[str, Any]:
    return {"kind": kind} | {
        "joint.kind" if key == "kind" else key: value for key, value in (body or {}).items()
    }


def in_table(scene: str, dialect: str, folder: Path, text: str) -> Study:
    """A scene whose train stands in a table, and its excitations in another."""
    data = with_tables(parse_source(text, str(SCENES[scene]))).data
    (folder / "line.csv").write_text(
        as_csv([row(*entry) for one in data["train"] for entry in one.items()], *DIALECTS[dialect]),
        encoding="utf-8-sig",
    )
    data["train"] = {"table": "line.csv"} if dialect == "commas" else [{"table": "line.csv"}]
    if "excitations" in data:
        (folder / "torques.csv").write_text(
            as_csv(data["excitations"], *DIALECTS[dialect]), encoding="utf-8"
        )
        data["excitations"] = {"table": "torques.csv"}
    (folder / f"{scene}.yaml").write_text(json.dumps(data), encoding="utf-8")
    return torsion.read(folder / f"{scene}.yaml")


@for_all(  # the dialects in turn: none depends on the scene
    ("scene", "dialect"),
    zip((name for name in SCENES if name not in BESIDE), cycle(DIALECTS), strict=False),
)
def test_every_scene_as_a_table_is_the_same_train(scene: str, dialect: str, tmp_path: Path) -> None:
    text = SCENES[scene].read_text(encoding="utf-8")
    written, table = (
        torsion.parse(text, str(SCENES[scene])),
        in_table(scene, dialect, tmp_path, text),
    )
    assert repr(table.train) == repr(written.train)


def without_file(found: Findings) -> dict[str, Any]:
    made = results(found)
    for key in ("file", "sha256", "tables"):
        made["scene"].pop(key)
    made.pop("plan", None)
    return made


@pytest.mark.parametrize("scene", ["haixun_06402", "usv", "pump_1200kw", "toothed_coupling"])
def test_results_of_a_table_are_those_of_the_scene_to_the_last_digit(
    scene: str, tmp_path: Path
) -> None:
    text = SCENES[scene].read_text(encoding="utf-8")
    table = in_table(scene, "semicolons", tmp_path, text)
    assert without_file(torsion.run(table)) == without_file(solved(scene))


HEAD = "name: x\noperation: {speeds: {from: 300 rpm, to: 900 rpm}, rated: {speed: 900 rpm, power: 9 kW}}\n"
GOOD = "kind,name,inertia [kg*m**2],stiffness [kN*m/rad]\ndisc,a,1,\ncoupling,,,20\ndisc,b,2,\n"


def study(folder: Path, table: str | bytes, train: str = "train: {table: line.csv}\n") -> Study:
    content = table if isinstance(table, bytes) else table.encode()
    (folder / "line.csv").write_bytes(content)
    return torsion.parse(HEAD + train, str(folder / "scene.yaml"))


def faults(
    folder: Path, table: str | bytes, train: str = "train: {table: line.csv}\n"
) -> list[str]:
    with pytest.raises(InputError) as caught:
        study(folder, table, train)
    return [
        part.split("\n")[0].removeprefix(f"{folder}/") for part in str(caught.value).split("\n\n")
    ]


def test_a_table_stands_for_its_rows_between_components_of_the_scene(tmp_path: Path) -> None:
    line = "train:\n- motor: {inertia: 3}\n- table: line.csv\n- propeller: {inertia: 4}\n"
    assert [part.name for part in study(tmp_path, GOOD, line).train.parts] == [
        "motor-1",
        "a",
        "coupling-1",
        "b",
        "propeller-1",
    ]


def test_a_train_of_seventy_two_lines_is_one_file_also_on_branches(tmp_path: Path) -> None:
    rows = "".join(f"disc,d{k},0.{k + 1},\ncoupling,c{k},,{k + 1}\n" for k in range(36))
    made = study(tmp_path, "kind,name,inertia [kg*m**2],stiffness [kN*m/rad]\n" + rows).train
    assert len(made.parts) == 72
    assert [spring.flexibility for spring in made.springs] == [
        1.0 / (1e3 * (k + 1)) for k in range(36)
    ]
    branch = (
        "train:\n- disc: {inertia: 1}\n- branch: {train: {table: line.csv}}\n- disc: {inertia: 1}\n"
    )
    gear = "train:\n- disc: {inertia: 1}\n- gear: {teeth: [20, 40], branches: [{teeth: 30, train: {table: line.csv}}]}\n"
    for train in (branch, gear):
        assert {
            part.depth for part in study(tmp_path, GOOD, train).train.parts if part.name in "ab"
        } == {1}


@pytest.mark.parametrize(
    "table",
    [
        "sep=;\r\n" + GOOD.replace(",", ";").replace("\n", "\r\n"),
        GOOD.replace(",", "\t").replace("\n", "\r"),
        "\ufeff# from the drawing\n\n,,,\n" + GOOD.replace("\n", '\n# next; a 5" shaft\n,,,\n'),
        GOOD.replace("disc,a,1,", '"disc","a"," 1 ",""'),
        GOOD.replace("[kg*m**2]", "[kg m2]")
        .replace("inertia", " Inertia ")
        .replace("disc", "Disc"),
        GOOD.replace("stiffness [kN*m/rad]", "coupling.stiffness (kNm/rad)").replace(
            ",20", ",2.0e1"
        ),
        GOOD.replace("\n", ",,\n"),
        GOOD.replace(",20", ",20 kNm/rad").rstrip("\n"),
        GOOD.replace("coupling,,,20", '"coupling","","","20000 N*m/\nrad"'),
    ],
)
def test_every_way_of_spreadsheets_gives_the_same_train(tmp_path: Path, table: str) -> None:
    assert repr(study(tmp_path, table).train) == repr(study(tmp_path, GOOD).train)


def test_a_decimal_comma_is_a_point_where_cells_are_parted_by_semicolons(tmp_path: Path) -> None:
    table = "kind;inertia [kg*m**2];stiffness [N*m/rad];psi\ndisc;1,5;;\ncoupling;[0,1; 0,25];2,5E4;80,5 %\ndisc;0,5;;\n"
    made = study(tmp_path, table.replace("[0,1; 0,25]", '"[0,1; 0,25]"')).train
    assert [one.given for one in made.inertias] == [1.5, 0.1, 0.25, 0.5]
    assert made.springs[0].flexibility == 1 / 2.5e4
    assert made.parts[1].damping == ("psi", 0.805)


def test_torques_and_loads_are_tables_too(tmp_path: Path) -> None:
    (tmp_path / "ripple.csv").write_text("order,torque [%],phase [deg]\n6,1,30\n21/8,0.5,0\n")
    (tmp_path / "load.csv").write_text("speed [rpm],torque [kN*m]\n300,0.1\n900,0.2\n")
    here = str(tmp_path / "scene.yaml")
    rows = "[{order: 6, torque: 1 %, phase: 30 deg}, {order: 21/8, torque: 0.5 %, phase: 0 deg}]"
    pairs = "[[300 rpm, 0.1 kN*m], [900 rpm, 0.2 kN*m]]"
    text = "name: x\nOPERATION\ntrain: [motor: {inertia: 1, ripple: RIPPLE}, disc: {inertia: 2}]\n"
    text += "excitations: [{at: disc-1, order: 2, torque: LOAD}]\n"
    text = text.replace(
        "OPERATION", "operation: {speeds: {from: 300 rpm, to: 900 rpm}, load: LOAD}"
    )
    tables = text.replace("LOAD", "{table: load.csv}").replace("RIPPLE", "{table: ripple.csv}")
    one, other = (
        torsion.parse(tables, here),
        torsion.parse(text.replace("LOAD", pairs).replace("RIPPLE", rows), here),
    )
    assert (one.operation, repr(one.train)) == (other.operation, repr(other.train))
    assert [name for name, _ in one.tables] == ["load.csv", "ripple.csv"]


@for_all(
    ("good", "bad", "expected"),
    [
        (
            "stiffness",
            "stifness",
            "line.csv:1:29: unknown column `stifness` (did you mean `stiffness`?)",
        ),
        (
            "stiffness [kN*m/rad]",
            "stiffness [kN*m]",
            "line.csv:1:29: the unit of the column `stiffness`: '1 kN*m' is a torque or energy, a stiffness in",
        ),
        (
            "inertia [kg*m**2]",
            "inertia",
            "line.csv:1:11: the column `inertia` has no unit (write `inertia [kg*m**2]`)",
        ),
        (  # its first figure is in the second row
            "stiffness [kN*m/rad]",
            "stiffness",
            "line.csv:1:29: the column `stiffness` has no unit (write `stiffness [",
        ),
        (
            "stiffness [kN*m/rad]",
            "inertia [kg*m**2]",
            "line.csv:1:29: the column `inertia` stands twice (a list is one cell: [0.9, 0.6])",
        ),
        ("kind,", "art,", "line.csv:1:1: unknown column `art`"),
        (
            "coupling,,,20",
            "coupling,,20",
            "line.csv:3:1: this row has 3 cells, the first row 4 (leave cells empty, not out)",
        ),
        ("disc,a,1,", "disc,a,1,5,", "line.csv:2:1: this row has 5 cells"),
        (
            "disc,a,1,",
            "disc,a,1,,5",
            "line.csv:2:1: this row has 5 cells, the first row 4 (with decimal commas the cells",
        ),
        (
            "disc,b,2,",
            "disc,b,#N/A,",
            "line.csv:4:8: `#N/A` is an error of the spreadsheet, no figure",
        ),
        ("disc,b,2,", "#REF!,b,2,", "line.csv:4:1: unknown component `#ref!`"),
        ("disc,b,2,", "disc,b,nan,", "line.csv:4:8: 'nan' is not a finite number"),
        (
            "disc,b,2,",
            "disc,b,-2,",
            "line.csv:4:8: -2 kg*m**2 is out of range (must be at least 0 kg*m**2)",
        ),
        ("disc,b,2,", 'disc,b,"2,5",', "line.csv:4:8: '2,5' has a comma in its number"),
        (
            "disc,b,2,",
            "disc,a,2,",
            "line.csv:4:6: the name 'a' is taken in line 2, `disc,a,1,` (names are unique)",
        ),
        ("disc,b,2,", "dics,b,2,", "line.csv:4:1: unknown component `dics` (did you mean `disc`?)"),
        ("disc,b,2,", ",b,2,", "line.csv:4:2: the row has no `kind`"),
        ("disc,b,2,", "disc,b,,", "line.csv:4:1: `inertia` is missing (give `inertia`, or"),
        ("disc,b,2,", "disc,b,2,,", "line.csv:4:1: this row has 5 cells"),
        ("disc,b,2,", 'disc,"b,2,', "line.csv:4:6: this quote is not closed"),
        (
            "disc,b,2,",
            'disc,"b"c,2,',
            "line.csv:4:6: text follows the closing quote (quotes within",
        ),
        ("disc,b,2,", 'disc,b,"[1, 2",', "line.csv:4:8: '[1, 2' has no closing bracket"),
        (
            "name",
            "joint.angle [deg]",
            "line.csv:2:6: this column is of `joint`, and the row is a `disc`",
        ),
    ],
)
def test_a_fault_of_a_table_is_told_where_it_stands(
    tmp_path: Path, good: str, bad: str, expected: str
) -> None:
    assert good in GOOD
    assert any(fault.startswith(expected) for fault in faults(tmp_path, GOOD.replace(good, bad)))


def test_all_faults_of_scene_and_tables_are_told_at_once(tmp_path: Path) -> None:
    table = (
        GOOD.replace("disc,a,1", "disc,a,x")
        .replace(",20", ",-20")
        .replace("disc,b,2", "disc,b,#DIV/0!")
    )
    train = "train:\n- motor: {inertia: -1}\n- table: line.csv\n"
    assert [fault.split(": ")[0] for fault in faults(tmp_path, table, train)] == [
        "scene.yaml:4:20",
        "line.csv:2:8",
        "line.csv:3:12",
        "line.csv:4:8",
    ]


@for_all(
    ("table", "expected"),
    [
        (b"", "line.csv:1:1: the table has nothing"),
        (b"kind,name\r\n", "line.csv:1:1: the table has no rows below its names of columns"),
        (
            "kind\ndisc ü".encode("latin-1"),
            "line.csv:2:6: the file is not UTF-8 text (save it as `CSV UTF-8`)",
        ),
        (GOOD.encode("utf-16"), "line.csv:1:1: the file is UTF-16 text (save it as `CSV UTF-8`)"),
        (b"PK\x03\x04 a workbook", "line.csv:1:3: the character U+0003 is not allowed"),
        (
            b"kind;inertia [kg*m**2]\ndisc;1,5\ndisc;2.5\ndisc;3.5\n",
            "line.csv:2:6: `1,5` here, and `2.5` in line 3: two decimal signs in one table",
        ),
        (b"name,inertia [kg*m**2]\na,1\n", "line.csv:1:1: the column `kind` is missing"),
    ],
)
def test_a_file_that_is_no_table_is_refused(tmp_path: Path, table: bytes, expected: str) -> None:
    assert faults(tmp_path, table)[0].startswith(expected)


def test_a_table_that_does_not_exist_is_refused_where_it_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"scene.yaml:2:18: the table 'no.csv' does not exist"):
        torsion.parse(
            "name: x\ntrain: {table: no.csv}\n".replace("train: ", "train:   "),
            str(tmp_path / "scene.yaml"),
        )
    with pytest.raises(InputError, match=r"the table '\.' cannot be read"):
        torsion.parse("name: x\ntrain: {table: .}\n", str(tmp_path / "scene.yaml"))


def test_what_is_found_after_reading_is_told_in_the_table_as_it_was_read(tmp_path: Path) -> None:
    made = study(tmp_path, GOOD)
    (tmp_path / "line.csv").unlink()
    fault = Fault(("train", 1, "coupling", "stiffness"), "too soft")
    assert str(located(InputError([fault]), made)).startswith(
        f"{tmp_path}/line.csv:3:12: too soft\n    coupling,,,20\n"
    )


def test_lists_that_a_table_can_stand_for_are_those_of_the_schema() -> None:
    from torsion.schema.json_schema import json_schema

    def named(body: Any) -> Any:
        if isinstance(body, dict):
            for key, one in body.get("properties", {}).items():
                if "'#/$defs/table'" in repr(one):
                    yield key
            for one in body.values():
                yield from named(one)

    schema = json_schema()
    assert {*named(schema), *named(schema["$defs"])} == {*MAPPINGS, *PAIRS}
    assert schema["$defs"]["train"]["anyOf"][1] == {"$ref": "#/$defs/table"}
    assert schema["$defs"]["train"]["anyOf"][0]["items"]["properties"]["table"]["type"] == "string"


def test_the_report_prints_the_tables_and_the_checksum_is_that_of_all_texts(tmp_path: Path) -> None:
    found = torsion.run(study(tmp_path, "\ufeff" + GOOD))
    printed = [block for block in input_file(found) if isinstance(block, Verbatim)]
    text = HEAD + "train: {table: line.csv}\n"
    assert [block.text for block in printed] == [text, GOOD]
    assert results(found)["scene"]["sha256"] == hashlib.sha256((text + GOOD).encode()).hexdigest()
    words = next(
        block.text
        for block in input_file(found)
        if isinstance(block, Paragraph) and "Table" in block.text
    )
    assert words == f"Table line.csv, SHA-256 {hashlib.sha256(GOOD.encode()).hexdigest()}:"


@given(
    st.lists(
        st.sampled_from(
            [
                "kind",
                "disc",
                "inertia [kg]",
                ",",
                ";",
                "\t",
                '"',
                "\n",
                "\r\n",
                "#",
                "1,5",
                "[",
                "]",
                "{",
                "#N/A",
                "inertia [kg*m**2]",
                "stiffness",
                "1e999",
                "sep=",
                "joint.kind",
                "x",
            ]
        ),
        max_size=40,
    )
)
@settings(max_examples=300, deadline=None)
def test_no_table_ends_in_a_traceback(
    tmp_path_factory: pytest.TempPathFactory, pieces: list[str]
) -> None:
    folder = tmp_path_factory.getbasetemp()
    for table in ("".join(pieces), GOOD.partition("\n")[0] + "\n" + "".join(pieces)):
        with contextlib.suppress(InputError):
            study(folder, table)


@pytest.mark.parametrize(
    ("train", "expected"),
    [
        (
            "train: [table: 5]\n",
            "scene.yaml:3:9: unknown component `table` (`- table: line.csv` contains only a file)",
        ),
        (
            "train: {table: line.csv, disc: {inertia: 1}}\n",
            "scene.yaml:3:26: a mapping is not a list of components",
        ),
        (
            "train: [coupling: {table: line.csv}]\n",
            "scene.yaml:3:27: 'line.csv' is not a mapping of keys",
        ),
        (
            "train: {table: line.csv}\nrules: {table: line.csv}\n",
            "scene.yaml:4:8: a mapping is not a list",
        ),
    ],
)
def test_a_table_where_none_can_stand_is_refused(tmp_path: Path, train: str, expected: str) -> None:
    assert any(fault.startswith(expected) for fault in faults(tmp_path, GOOD, train))


CASES = "cases:\n  soft: {scale: {coupling-1.stiffness: 50 %}}\n  heavy: {set: {b.inertia: 5}}\n"


def test_a_case_changes_what_a_table_states(tmp_path: Path) -> None:
    found = study(tmp_path, GOOD, f"train: {{table: line.csv}}\n{CASES}")
    soft, heavy = found.cases["soft"], found.cases["heavy"]
    assert soft.train.springs[0].flexibility == pytest.approx(
        2.0 * found.train.springs[0].flexibility, rel=1e-15
    )
    assert [one.inertia for one in heavy.train.inertias] == [1.0, 5.0]
    assert [one.before for case in (soft, heavy) for one in case.case.changes] == [
        "20 kN*m/rad",
        "2 kg*m**2",
    ]
    made = torsion.run(found)
    whole = hashlib.sha256((found.text + GOOD).encode()).hexdigest()
    assert {results(one)["scene"]["sha256"] for one in made.each.values()} == {whole}
    assert made.cases["soft"].results["modes"].frequency[0] == pytest.approx(
        made.results["modes"].frequency[0] / 2.0**0.5, rel=1e-12
    )


def test_a_case_takes_rows_of_a_table_away(tmp_path: Path) -> None:
    longer = f"{GOOD}coupling,c,,7\ndisc,d,3,\n"
    found = study(tmp_path, longer, "train: {table: line.csv}\ncases: {short: {remove: [c, d]}}\n")
    assert [part.name for part in found.cases["short"].train.parts] == ["a", "coupling-1", "b"]


def test_what_a_case_states_wrongly_of_a_table_is_quoted_where_the_case_states_it(
    tmp_path: Path,
) -> None:
    line = "train: {table: line.csv}\ncases:\n  x: {set: {b.inertia: 5 N}}\n"
    (said,) = faults(tmp_path, GOOD, line)
    assert said.startswith("scene.yaml:5:24: case 'x': ")
    (said,) = faults(tmp_path, GOOD, line.replace("5 N", "5, b.inerta: 1"))
    assert said.startswith("scene.yaml:5:27: case 'x': ")


def test_a_case_names_a_table_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "load.csv").write_text("speed [rpm],torque [N*m]\n300,10\n900,90\n")
    line = "train: {table: line.csv}\ncases: {x: {set: {operation.load: {table: load.csv}}}}\n"
    found = study(tmp_path, GOOD, line + "rules: []\n")
    assert len(found.cases["x"].operation.load.table) == 2
    assert [name for name, _ in found.tables] == ["line.csv", "load.csv"]
