"""Every fault of a damper or pendulum is refused where it stands; faulty_dampers.txt has one line for each."""

from tests.faults.test_faulty_files import HERE, faults_of, rows
from tests.for_all import for_all

from torsion.schema.scene_reader import parse

GOOD = (HERE / "dampers.yaml").read_text(encoding="utf-8")


def test_good_file_has_dampers_of_every_law_and_a_pendulum() -> None:
    tables = [spring.table for spring in parse(GOOD).train.springs]
    assert [table.key for table in tables if table is not None] == [
        "silicone",
        "table",
        "silicone",
        "",
    ]


@for_all(("place", "good", "bad", "words"), rows("faulty_dampers.txt"))
def test_a_faulty_damper_is_refused_at_the_fault_and_only_there(
    place: str, good: str, bad: str, words: str
) -> None:
    assert GOOD.count(good) == 1
    faults, _ = faults_of(GOOD.replace(good, bad))
    assert [f"{fault.line}:{fault.column}" for fault in faults] == [place]
    assert [
        word for word in words.split() if word not in f"{faults[0].message} ({faults[0].hint})"
    ] == []
