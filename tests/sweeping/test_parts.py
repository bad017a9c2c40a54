"""Chunks of a sweep, their parts and their folder: the same to the last bit however they are cut, kept and sent."""

import json
import pickle
import shutil
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.for_all import for_all
from typer.testing import CliRunner

import torsion
from torsion.cli import app
from torsion.columns import NotInColumns
from torsion.errors import BAD_INPUT, Fault, InputError, SolveError
from torsion.sweeping import cluster, sweep_folder, sweeper, worker_task
from torsion.sweeping.cluster import Workplace, check_workplace, unprotected
from torsion.sweeping.sweep_folder import SweepFolder
from torsion.sweeping.sweeper import Stopped, Sweeper
from torsion.what_if.sweep import sweep_run
from torsion.what_if.sweep.sweep_results import Sweep
from torsion.what_if.variants import frequencies
from torsion.what_if.variants.chunks import Answers, chunks

pytest.importorskip("pyarrow", reason="parts need pip install -e '.[sweep]'")
SCENE = """name: drive
operation: {speeds: {from: 300 rpm, to: 1500 rpm, steps: 5}, rated: {speed: 1500 rpm, power: 100 kW}}
train:
- motor: {inertia: 1.2, ripple: [{order: 2, torque: 2 %%}]}
- coupling: {name: rubber, stiffness: {table: psi.csv}, tolerance: 10 %%, vibratory_torque: 76 N*m}
- shaft: {name: tail, length: 0.8 m, diameter: 60 mm}
- disc: {name: load, inertia: 0.8}
analyses: {modes: {count: 2}, response: , sweep: {%s}}
rules: [coupling-maker]
"""
PLAIN = SCENE.replace("{table: psi.csv}", "20000, psi: 0.8")
VARY = "vary: {rubber.stiffness: {from: 18e3, to: 22e3, steps: 32}, tail.diameter: {values: [55 mm, 60 mm]}}"
MODES = "vary: {rubber.stiffness: {uniform: 10 %}}, samples: 128, results: [modes]"  # side by side


def same(one: Sweep, other: Sweep) -> None:
    assert np.array_equal(one.factor, other.factor)
    assert np.array_equal(one.frequency, other.frequency, equal_nan=True)
    assert [(check.rule, check.what) for check in one.checks] == [
        (check.rule, check.what) for check in other.checks
    ]
    for mine, others in zip(one.checks, other.checks, strict=True):
        assert np.array_equal(mine.utilisation, others.utilisation, equal_nan=True)
        assert np.array_equal(mine.fails, others.fails)
    assert one.faults == other.faults


@pytest.fixture(scope="module")
def whole() -> Sweep:
    """The answers of `solve`, in chunks of another length than the parts."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweep_run, "JUDGED_AT_ONCE", 48)
        return torsion.run(torsion.parse(PLAIN % VARY)).need(Sweep)


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a sweep whose checks are judged, with all of its parts."""
    folder = tmp_path_factory.mktemp("sweep")
    by(folder, PLAIN % VARY, csv=True)
    return folder


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Eight chunks of variants that are found side by side or one by one."""
    monkeypatch.setattr(sweep_run, "FREQUENCIES_AT_ONCE", 16)


def by(folder: Path, text: str = PLAIN % MODES, **more: Any) -> tuple[Sweep, Sweeper]:
    taken = Sweeper(folder, **more)
    return torsion.run(torsion.parse(text), answered=taken).need(Sweep), taken


def test_a_part_that_is_there_is_kept_and_one_that_is_not_is_solved_all_as_solve_does(
    kept: Path, tmp_path: Path, whole: Sweep, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(kept, tmp_path, dirs_exist_ok=True)
    (lost,) = (tmp_path / "parts").glob("part-000003.*")
    times = {
        path: path.stat().st_mtime_ns
        for path in (tmp_path / "parts").glob("part-*")
        if path != lost
    }
    lost.rename(
        lost.with_name(f"{lost.name}.part")
    )  # as of a process that was killed while it wrote
    requested = []
    monkeypatch.setattr(
        sweeper, "answered", lambda *given: requested.append(given) or sweep_run.answered(*given)
    )
    found, taken = by(tmp_path, PLAIN % VARY)
    same(found, whole)
    assert (len(requested), taken.kept, taken.solved) == (1, 3, 1)
    assert all(path.stat().st_mtime_ns == time for path, time in times.items())
    assert not list((tmp_path / "parts").glob("*.part"))


def test_all_variants_stand_in_one_table(kept: Path, whole: Sweep) -> None:
    rows = [
        line.split(",") for line in (kept / "variants.csv").read_text(encoding="utf-8").splitlines()
    ]
    assert rows[0][:5] == [
        "variant",
        "rubber.stiffness",
        "tail.diameter",
        "tail.diameter label",
        "mode 1 (Hz)",
    ]
    assert [int(row[0]) for row in rows[1:]] == list(range(64))
    assert [float(row[1]) for row in rows[1:]] == whole.factor[:, 0].tolist()
    assert [float(row[4]) for row in rows[1:]] == whole.frequency[0].tolist()
    assert rows[1][3] in ("55 mm", "60 mm")


def test_answers_that_are_judged_are_the_same_for_chunks_of_another_length(
    kept: Path, whole: Sweep
) -> None:
    found, taken = by(kept, PLAIN % VARY)
    assert (taken.kept, taken.solved) == (4, 0)
    same(found, whole)


def test_frequencies_one_by_one_in_many_parts_are_those_of_one_chunk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = PLAIN % f"{VARY}, results: [modes]"

    def refused(*_: object) -> None:
        raise NotInColumns("every variant separately")

    monkeypatch.setattr(frequencies, "certified", refused)
    whole = torsion.run(torsion.parse(text)).need(Sweep)
    monkeypatch.setattr(sweep_run, "FREQUENCIES_AT_ONCE", 48)
    found, taken = by(tmp_path, text)
    assert taken.solved == 2
    same(found, whole)


def test_chunks_cover_all_variants_once() -> None:
    for count, length in ((128, 16), (100, 16), (5, 32)):
        each = chunks(count, length)
        assert [variant for one in each for variant in range(one.begin, one.end)] == list(
            range(count)
        )
        assert [one.number for one in each] == list(range(len(each)))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("samples: 256", "`samples` was 128 and is 256"),
        ("seed: 2, samples: 128", "`seed` was not given and is 2"),
        ("method: random, samples: 128", "`method` was not given and is random"),
    ],
)
def test_parts_of_other_settings_are_refused_with_what_differs(
    tmp_path: Path, change: str, words: str
) -> None:
    by(tmp_path, PLAIN % MODES)
    with pytest.raises(Stopped) as caught:
        by(tmp_path, PLAIN % MODES.replace("samples: 128", change))
    assert words in str(caught.value)
    assert "--fresh" in str(caught.value)
    found, taken = by(tmp_path, PLAIN % MODES.replace("samples: 128", change), fresh=True)
    assert taken.kept == 0
    assert found.samples == len(found.factor)


def test_parts_of_another_table_or_program_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = (
        "kind,name,inertia [kg*m**2],stiffness [N*m/rad]\ndisc,a,1,\ncoupling,c,,1000\ndisc,b,%s,\n"
    )
    (tmp_path / "rows.csv").write_text(rows % 2, encoding="utf-8")
    scene = tmp_path / "scene.yaml"
    sweep = (
        "analyses: {modes: {count: 1}, sweep: {vary: {c.stiffness: {uniform: 5 %}}, samples: 128}}"
    )
    scene.write_text(f"name: x\ntrain: {{table: rows.csv}}\n{sweep}\n", encoding="utf-8")

    def solve() -> None:
        torsion.run(torsion.read(scene), answered=Sweeper(tmp_path))

    solve()
    monkeypatch.setattr("torsion.sweeping.sweep_folder.version", lambda name: "0.9")
    with pytest.raises(Stopped, match=r"`torsion` was 0\.1\.0 and is 0\.9"):
        solve()
    monkeypatch.undo()
    (tmp_path / "rows.csv").write_text(rows % 3, encoding="utf-8")
    with pytest.raises(Stopped, match=r"the file rows\.csv was changed"):
        solve()


def test_parts_that_are_another_s_or_broken_are_refused(tmp_path: Path, short: None) -> None:
    by(tmp_path, PLAIN % MODES)
    first, second = (next((tmp_path / "parts").glob(f"part-00000{k}.*")) for k in (0, 1))
    first.write_bytes(second.read_bytes())
    with pytest.raises(Stopped, match="it is damaged"):
        by(tmp_path, PLAIN % MODES)
    with (tmp_path / "parts" / "SHA256SUMS").open("a", encoding="utf-8") as sums:
        sums.write(f"{sha256(first.read_bytes()).hexdigest()}  {first.name}\n")
    with pytest.raises(Stopped, match="does not hold the variants 0 to 15"):
        by(tmp_path, PLAIN % MODES)
    first.write_bytes(b"nothing")
    with pytest.raises(Stopped, match="cannot be read as a part"):
        by(tmp_path, PLAIN % MODES)
    (tmp_path / "sweep.json").unlink()
    with pytest.raises(Stopped, match=r"sweep\.json, which identifies the sweep, is missing"):
        by(tmp_path, PLAIN % MODES)


def test_no_single_bit_of_a_part_can_change_unnoticed(tmp_path: Path, short: None) -> None:
    """Every flipped bit of 300 over the whole file is refused in words: no other number passes."""
    by(tmp_path, PLAIN % MODES)
    path = tmp_path / "parts" / "part-000003.parquet"
    whole, place = path.read_bytes(), SweepFolder(tmp_path)
    place.checksums[path.name] = sha256(whole).hexdigest()
    chunk = chunks(128, 16)[3]
    assert place.read(chunk)[0].shape == (16, 1)
    for bit in np.random.default_rng(1).choice(8 * len(whole), 300, replace=False).tolist():
        damaged = bytearray(whole)
        damaged[bit // 8] ^= 1 << bit % 8
        path.write_bytes(damaged)
        with pytest.raises(
            InputError, match=r"part-000003\.parquet cannot be read as a part of a sweep"
        ):
            place.read(chunk)


def test_a_damaged_part_ends_the_command_with_the_status_of_faulty_input(
    tmp_path: Path, short: None
) -> None:
    scene, path = tmp_path / "scene.yaml", tmp_path / "out" / "parts" / "part-000003.parquet"
    scene.write_text(PLAIN % MODES, encoding="utf-8")
    call = ["sweep", str(scene), "-o", str(tmp_path / "out")]
    assert CliRunner().invoke(app, call).exit_code == 0
    whole = path.read_bytes()
    for damaged in (b"", whole[:100], whole[:50] + b"\0" + whole[51:], b"PAR1" * 100):
        path.write_bytes(damaged)
        done = CliRunner().invoke(app, call)
        assert done.exit_code == BAD_INPUT
        assert (
            "part-000003.parquet cannot be read as a part of a sweep: it is damaged" in done.output
        )
    path.unlink()
    assert "7 of 8 parts were there already" in CliRunner().invoke(app, call).output
    assert path.read_bytes() == whole


def test_a_part_whose_checksum_was_never_written_is_solved_again(
    tmp_path: Path, short: None
) -> None:
    by(tmp_path, PLAIN % MODES)
    sums = tmp_path / "parts" / "SHA256SUMS"
    text = sums.read_text(encoding="utf-8")
    sums.write_text(text[:-20], encoding="utf-8")  # as of a process that was killed while it wrote
    assert by(tmp_path, PLAIN % MODES)[1].solved == 1
    assert by(tmp_path, PLAIN % MODES)[1].kept == 8


def test_to_begin_anew_removes_parts_and_no_other_file(tmp_path: Path, short: None) -> None:
    (tmp_path / "parts").mkdir()
    mine = [tmp_path / "parts" / name for name in ("notes.txt", "part-list.txt", "part-1.parquet")]
    by(tmp_path, PLAIN % MODES)
    for path in mine:
        path.write_text("a user's", encoding="utf-8")
    assert by(tmp_path, PLAIN % MODES, fresh=True)[1].solved == 8
    assert all(path.read_text(encoding="utf-8") == "a user's" for path in mine)


def test_a_sweep_without_pyarrow_is_refused_with_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "find_spec", lambda name: None if name == "pyarrow" else name)
    (tmp_path / "scene.yaml").write_text(PLAIN % MODES, encoding="utf-8")
    done = CliRunner().invoke(
        app, ["sweep", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / "out")]
    )
    assert done.exit_code == BAD_INPUT
    assert "needs pyarrow (pip install '.[sweep]')" in done.output
    assert not (tmp_path / "out").exists()


def test_faults_and_unknown_numbers_come_back_as_they_were(tmp_path: Path) -> None:
    study = torsion.parse(PLAIN % VARY)
    (chunk,), variation = chunks(3, 3), study.variations["sweep"]
    answers = Answers(
        np.array([[1.5, np.nan, 0.1 + 0.2]]), faults={1: "no answer, ü"}, method="by hand"
    )
    answers.checks["rule", "", "where", "what"] = (
        np.array([np.nan, 0.5, np.inf]),
        np.array([True, False, True]),
    )
    part = np.array([[1.1, 0.0], [0.9, 1.0], [1.0, 1.0]]), answers
    folder = SweepFolder(tmp_path)
    folder.parts.mkdir()
    folder.write(chunk, variation, part)
    values, back = folder.read(chunk)
    ((name, checksum),) = folder.checksums.items()
    found, _ = sweep_folder.read_part(folder.parts / name, checksum)
    assert list(found["tail.diameter label"]) == ["55 mm", "60 mm", "60 mm"]
    assert np.array_equal(values, part[0])
    assert np.array_equal(back.frequency, answers.frequency, equal_nan=True)
    assert (back.faults, back.method, list(back.checks)) == (
        answers.faults,
        "by hand",
        list(answers.checks),
    )
    for mine, others in zip(back.checks.values(), answers.checks.values(), strict=True):
        assert all(np.array_equal(*pair, equal_nan=True) for pair in zip(mine, others, strict=True))


def test_a_worker_answers_the_same_and_refuses_other_programs_and_files(
    tmp_path: Path, short: None
) -> None:
    kept = []
    study = torsion.parse(PLAIN % MODES)

    def errands(work, variation, each):
        kept.append((pickle.dumps(worker_task.errand(work, variation)), each[5]))
        return sweep_run.in_turn(work, variation, each)

    whole = torsion.run(study, answered=errands).need(Sweep)
    errand, chunk = pickle.loads(kept[0][0]), kept[0][1]
    values, answers = worker_task.answered(errand, chunk)
    here = slice(chunk.begin, chunk.end)
    assert np.array_equal(values, whole.factor[here])
    assert np.array_equal(answers.frequency, whole.frequency[:, here])
    other = replace(errand, versions=(("numpy", "1.0"),))
    with pytest.raises(InputError, match=r"numpy 1\.0 is needed and .* is there"):
        worker_task.answered(other, chunk)
    with pytest.raises(InputError, match=r"not there as where the sweep was begun: .*mesh\.vtu"):
        worker_task.answered(replace(errand, files=((str(tmp_path / "mesh.vtu"), "0"),)), chunk)


def test_a_worker_judges_as_this_process_does() -> None:
    kept = []

    def errands(work, variation, each):
        kept.append((pickle.dumps(worker_task.errand(work, variation)), each[1]))
        return sweep_run.in_turn(work, variation, each)

    vary = "vary: {rubber.stiffness: {from: 18e3, to: 22e3, steps: 32}}"
    study = torsion.parse(
        PLAIN.replace("- shaft: {name: tail, length: 0.8 m, diameter: 60 mm}\n", "") % vary
    )
    whole = torsion.run(study, answered=errands).need(Sweep)
    errand, chunk = pickle.loads(kept[0][0]), kept[0][1]
    answers = worker_task.answered(errand, chunk)[1]
    for check in whole.checks:
        used, fails = answers.checks[check.rule, check.clause, check.where, check.what]
        assert np.array_equal(used, check.utilisation[chunk.begin : chunk.end], equal_nan=True)
        assert np.array_equal(fails, check.fails[chunk.begin : chunk.end])


def test_workers_of_a_scheduler_answer_as_this_process_does(tmp_path: Path, short: None) -> None:
    distributed = pytest.importorskip("distributed", reason="a scheduler needs dask")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as local:
        found, taken = by(tmp_path, workplace=Workplace(None, local.scheduler_address))
    assert taken.solved == 8
    same(found, torsion.run(torsion.parse(PLAIN % MODES)).need(Sweep))


def test_errors_come_whole_from_another_process() -> None:
    one = InputError([Fault(("train",), "message", "hint")], "all of it")
    back = pickle.loads(pickle.dumps(one))
    assert (back.faults, str(back)) == (one.faults, "all of it")
    assert str(pickle.loads(pickle.dumps(SolveError("no", "try")))) == "no; try"


@for_all(
    ("given", "words"),
    [
        (Workplace(2, "tcp://a:1"), "--workers are of this machine"),
        (Workplace(None, "tcp://a:1", Path("a")), "name two schedulers"),
        (Workplace(None, "", Path("none.json")), "no such file"),
    ],
)
def test_options_of_a_scheduler_that_clash_are_refused(
    given: Workplace, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "find_spec", lambda name: name)
    with pytest.raises(InputError, match=words):
        check_workplace(given)


def test_a_scheduler_without_dask_is_refused_with_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cluster, "find_spec", lambda name: None if name == "distributed" else name)
    with pytest.raises(InputError, match=r"a scheduler needs dask \(pip install '\.\[sweep\]'\)"):
        check_workplace(Workplace(None, "tcp://a:1"))
    check_workplace(Workplace(2))


def test_a_scheduler_without_tls_gets_a_warning_beyond_this_machine() -> None:
    for address in (
        "",
        "tcp://127.0.0.1:8786",
        "localhost:8786",
        "tcp://[::1]:8786",
        "tls://10.0.0.1:8786",
    ):
        assert unprotected(Workplace(None, address)) == ""
    for address in (
        "tcp://10.0.0.1:8786",
        "10.0.0.1:8786",
        "tcp://cluster:8786",
        "ws://cluster:8786",
    ):
        assert "has no TLS" in unprotected(Workplace(None, address))


def test_the_command_writes_report_and_parts_and_says_what_was_there(
    tmp_path: Path, short: None
) -> None:
    scene, out = tmp_path / "scene.yaml", tmp_path / "out"
    scene.write_text(PLAIN % MODES, encoding="utf-8")

    def call(*more: str, file: Path = scene) -> tuple[int, str]:
        done = CliRunner().invoke(app, ["sweep", str(file), "-o", str(out), *more])
        return done.exit_code, done.output

    status, _ = call()
    assert status == torsion.run(torsion.read(scene)).exit_status
    assert "8 of 8 parts were there already" in call()[1]
    report = (out / "report.html").read_text(encoding="utf-8")
    assert "Sweep" in report
    assert json.loads((out / "sweep.json").read_text(encoding="utf-8"))["variants"] == 128
    scene.write_text(PLAIN % MODES.replace("10 %", "9 %"), encoding="utf-8")
    status, words = call()
    assert (status, "is of another sweep" in words) == (BAD_INPUT, True)
    assert (out / "report.html").read_text(encoding="utf-8") == report
    bare = tmp_path / "bare.yaml"
    bare.write_text((PLAIN % MODES).partition("analyses")[0], encoding="utf-8")
    status, words = call(file=bare)
    assert (status, "names no sweep" in words) == (BAD_INPUT, True)


def test_every_case_has_parts_of_its_own(tmp_path: Path, short: None) -> None:
    text = f"{PLAIN % MODES}cases: {{heavy: {{set: {{load.inertia: 1.6}}}}}}\n"
    taken = Sweeper(tmp_path)
    found, direct = (
        torsion.run(torsion.parse(text), answered=taken),
        torsion.run(torsion.parse(text)),
    )
    for name, one in direct.each.items():
        same(found.each[name].need(Sweep), one.need(Sweep))
    assert SweepFolder(tmp_path / "heavy").parts.is_dir()
    assert taken.solved == 16


def test_parts_that_the_first_misfire_has_solved_are_not_counted_as_there_before(
    tmp_path: Path, short: None
) -> None:
    diesel = (Path(__file__).parents[2] / "shafting_specs" / "diesel_misfire.yaml").read_text(
        encoding="utf-8"
    )
    sweep = "  sweep: {vary: {rubber coupling.stiffness: {uniform: 10 %}}, samples: 128, results: [modes]}\n"
    text = diesel.replace("misfire: 6", "misfire: worst").replace("rules: [", f"{sweep}rules: [")
    taken = Sweeper(tmp_path)
    torsion.run(torsion.parse(text), only=["sweep"], answered=taken)
    assert (taken.kept, taken.solved) == (0, 8)
    again = Sweeper(tmp_path)
    torsion.run(torsion.parse(text), only=["sweep"], answered=again)
    assert (again.kept, again.solved) == (8, 0)
