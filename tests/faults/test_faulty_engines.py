"""Every fault of an engine is refused where it stands; faulty_engines.txt has one line for each."""

from tests.faults.test_faulty_files import HERE, faults_of, rows
from tests.for_all import for_all

from torsion.schema.scene_reader import parse

GOOD = (HERE / "engine.yaml").read_text(encoding="utf-8")


def test_good_file_has_throws_and_crank_spans() -> None:
    parts = parse(GOOD).train.parts
    assert [part.kind for part in parts if part.name.startswith("main engine")] == [
        "engine",
        "throw",
        *(kind for _ in range(5) for kind in ("crank", "throw")),
    ]


@for_all(("place", "good", "bad", "words"), rows("faulty_engines.txt"))
def test_a_faulty_engine_is_refused_at_the_fault_and_only_there(
    place: str, good: str, bad: str, words: str
) -> None:
    assert GOOD.count(good) == 1
    faults, _ = faults_of(GOOD.replace(good, bad))
    assert [f"{fault.line}:{fault.column}" for fault in faults] == [place]
    assert [
        word for word in words.split() if word not in f"{faults[0].message} ({faults[0].hint})"
    ] == []
