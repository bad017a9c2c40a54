"""What a page shows: the file as it is saved, its sliders, its faults; a solver that takes too long is stopped."""

import re
from collections.abc import Iterator
from math import pi, sqrt
from pathlib import Path
from typing import Any

import pytest

from torsion.findings import Progress
from torsion.live import session as sessions
from torsion.live.session import Session
from torsion.output.numbers import number

SCENE = """
name: pair
operation: {{speeds: {{from: 100 rpm, to: 900 rpm, steps: 21}}}}
train:
  - motor: {{name: motor, inertia: {inertia}, ripple: [{{order: 1, torque: 1 N*m}}]}}
  - coupling: {{name: link, stiffness: 12 kN*m/rad, tolerance: 10 %, loss_factor: 0.1}}
  - table: ends.csv
analyses: {{modes: {{count: 1}}, response: }}
"""


def ends(inertia: float) -> str:
    return f"kind,name,inertia [kg*m**2]\ndisc,end,{inertia:g}\n"


def shown(stiffness: float, one: float, other: float) -> str:
    """The frequency of two discs on a spring as the report prints it."""
    return number(sqrt(stiffness * (1 / one + 1 / other)) / 2 / pi, 7)


def plain(text: str) -> str:
    return re.sub("<[^>]*>", " ", text)[:800]


class Follower:
    """A page without a browser: what the session has shown it so far."""

    def __init__(self, folder: Path) -> None:
        self.file, self.table = folder / "pair.yaml", folder / "ends.csv"
        self.table.write_text(ends(3), encoding="utf-8")
        self.save()
        self.session, self.known, self.seen = Session(self.file), dict[str, Any](), 0
        self.session.start()

    def save(self, inertia: float = 2.0, text: str | None = None) -> None:
        self.file.write_text(
            SCENE.format(inertia=inertia) if text is None else text, encoding="utf-8"
        )

    def until(self, *words: str, key: str = "modes") -> str:
        """What is shown there as soon as it has these words."""
        wait, text = 0.0, ""  # what is there already first
        for _ in range(100):
            news = self.session.news(self.seen, wait)
            assert wait == 0.0 or news["seen"] > self.seen, f"{words} are not shown: {plain(text)}"
            self.seen, wait = news.pop("seen"), 60.0
            self.known |= news
            text = str(self.known.get(key, ""))
            if all(one in text for one in words):
                return text
        raise AssertionError(f"{words} are not shown")

    def move(self, **positions: float) -> int:
        return self.session.move({key.replace("_", "."): value for key, value in positions.items()})


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Follower]:
    made = Follower(tmp_path_factory.mktemp("live"))
    yield made
    made.session.end()


@pytest.fixture(autouse=True)
def afresh(page: Follower) -> None:
    """Every test begins with the picture of the same file, and a solver that waits."""
    if page.table.read_text(encoding="utf-8") != ends(3):
        page.table.write_text(ends(3), encoding="utf-8")
    if page.file.read_text(encoding="utf-8") != SCENE.format(inertia=2.0):
        page.save()
    page.session.move({})
    page.until(shown(12e3, 2, 3))
    page.until("solved", key="state")
    page.until("'text': ''", key="faults")


def test_a_saved_file_is_shown(page: Follower) -> None:
    page.save(2.5)
    page.until(shown(12e3, 2.5, 3), "Campbell diagram")
    page.until("NOT JUDGED", "Vibratory torque in link", key="report")


def test_a_saved_table_that_the_file_names_is_shown(page: Follower) -> None:
    page.table.write_text(ends(3.5), encoding="utf-8")
    page.until(shown(12e3, 2, 3.5))


def test_a_table_that_was_saved_while_it_was_read_is_read_again(
    page: Follower, monkeypatch: pytest.MonkeyPatch
) -> None:
    def read_early(*_: Any, **__: Any) -> Any:
        monkeypatch.undo()
        made = reread(*_, **__)
        page.table.write_text(ends(4.5), encoding="utf-8")
        return made

    reread = sessions.reread
    monkeypatch.setattr(sessions, "reread", read_early)
    page.save(2.25)
    page.until(shown(12e3, 2.25, 4.5))


def test_a_file_that_another_takes_the_place_of_is_shown(page: Follower) -> None:
    other = page.file.with_suffix(".new")
    other.write_text(SCENE.format(inertia=4), encoding="utf-8")
    other.replace(page.file)
    page.until(shown(12e3, 4, 3))


def test_a_moved_slider_is_the_file_with_another_figure(page: Follower) -> None:
    (one,) = page.known["sliders"]["each"]
    assert (one["name"], one["low"], one["high"], one["nominal"]) == (
        "link.stiffness",
        0.9,
        1.1,
        1.0,
    )
    turn = page.move(link_stiffness=1.07)
    page.until(shown(1.07 * 12e3, 2, 3))
    report = page.until(f"'turn': {turn}", "with another link.stiffness", key="report")
    assert "SHA-256" not in report  # which would be that of the file
    page.until("12.84 kN*m/rad (+7 %)", "'moved': True", key="sliders")
    page.save(2.5)  # what is saved is shown, and no slider stays moved
    page.until(shown(12e3, 2.5, 3))
    page.until("'moved': False", key="sliders")


@pytest.mark.parametrize(
    ("name", "at", "words"),
    [
        ("link.stiffness", 1.2, "goes from 0.9 to 1.1"),
        ("shaft.stiffness", 1.0, "has no figure 'shaft.stiffness'"),
    ],
)
def test_a_slider_that_is_not_there_is_a_fault(
    page: Follower, name: str, at: float, words: str
) -> None:
    page.session.move({name: at})
    page.until(words, key="faults")


def test_a_fault_has_its_place_and_the_last_picture_stays(page: Follower) -> None:
    before = page.known["modes"]
    page.save(text=SCENE.format(inertia=2).replace("stiffness", "stifness"))
    page.until(
        f"{page.file}:6:28: unknown key `stifness` (did you mean `stiffness`?)", key="faults"
    )
    assert page.known["modes"] == before
    page.save()
    page.until("'text': ''", key="faults")


def test_a_fault_of_a_table_is_mended_there(page: Follower) -> None:
    page.table.write_text(ends(-3), encoding="utf-8")
    page.until("ends.csv:2:10: ", key="faults")
    page.table.unlink()
    page.until("ends.csv", "does not exist", key="faults")
    page.table.write_text(ends(5), encoding="utf-8")
    page.until(shown(12e3, 2, 5))


def test_a_file_that_is_gone_is_a_fault_until_it_is_back(page: Follower) -> None:
    page.file.unlink()
    page.until("does not exist", key="faults")
    page.save(6)
    page.until(shown(12e3, 6, 3))


def test_a_solver_past_its_time_is_stopped_and_the_next_one_solves(
    page: Follower, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as short:
        short.setattr(sessions, "LIMIT", -1.0)
        page.save(text=SCENE.format(inertia=2).replace("steps: 21", "steps: 200001"))
        page.until("there is no picture within", key="faults")
    page.save(8)
    page.until(shown(12e3, 8, 3))
    page.until("'text': ''", key="faults")


def test_an_overtaken_picture_is_given_up_for_the_later_request(
    page: Follower, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn, ended = sessions.drawn, list[str]()

    def waiting(study: Any, moved: Any, progress: Progress) -> Any:
        if dict(moved) != {"link.stiffness": 1.05}:
            return drawn(study, moved, progress)
        page.session.move({"link.stiffness": 1.08})
        try:
            return drawn(study, moved, progress)
        except sessions.OvertakenError:
            ended.append("overtaken")
            raise

    monkeypatch.setattr(sessions, "drawn", waiting)
    page.move(link_stiffness=1.05)
    page.until(shown(1.08 * 12e3, 2, 3))
    page.until("solved", key="state")
    assert ended == ["overtaken"]
    assert "'text': ''" in page.until(key="faults")


def test_a_fault_of_the_program_is_said_and_the_next_picture_is_made(
    page: Follower, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: Any) -> Any:
        raise ZeroDivisionError("no number")

    with monkeypatch.context() as faulty:
        faulty.setattr(sessions, "drawn", fail)
        page.save(9)
        page.until("torsion has failed: ZeroDivisionError: no number", key="faults")
    page.save(9.5)
    page.until(shown(12e3, 9.5, 3))
    page.until("'text': ''", key="faults")
