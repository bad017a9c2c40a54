"""A sweep by several processes: `python -m benchmarks.workers [--quick]` (needs the extra `sweep`; TLS: openssl).

Writes reports/workers.md; `--quick` takes an eighth of the variants and prints without writing.
"""

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.page_file import Report
from benchmarks.papers.writing import table

SCENE = Path(__file__).parents[1] / "shafting_specs" / "toleranced_drive.yaml"
JUDGED, ENDED, FREQUENCIES = 512, 256, 1 << 20
PORT = 8799
HOW = """\
`torsion sweep` of the model file toleranced_drive in processes of its own; eight figures vary. Judged: each variant
solved and judged by the rule of the model file as a file of its own. Frequencies only: three modes of every variant
side by side, each proven.
Wall time is that of the sweep in the plan of the report, with the start of the workers, reading and writing of the
parts; the rate after the first part leaves the start out. Processor time is that of the whole command with all of its
processes. The machine is shared with other work: where its load, printed next to them, is near the number of processors
or above, two workers share what one has without them, and wall times say nothing of a quiet machine."""


def main() -> None:
    """Runs all and writes the page."""
    report = Report(__doc__, "workers", "an eighth of the variants")
    signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # which a shell takes from what runs in its background
    share = 8 if report.chosen.quick else 1
    with TemporaryDirectory() as place:
        folder = Path(place)
        judged = _scene(folder / "judged.yaml", max(JUDGED // share, 128))
        frequencies = _scene(folder / "frequencies.yaml", FREQUENCIES // share, "results: [modes]")
        ended = _scene(folder / "ended.yaml", ENDED)
        parts = [
            HOW,
            _times({"judged": judged, "frequencies only": frequencies}, folder),
            _ended(ended, folder),
            _by_tls(ended, folder),
        ]
    report.publish("A sweep by several processes", parts)


def _scene(file: Path, samples: int, more: str = "") -> Path:
    text = SCENE.read_text(encoding="utf-8")
    file.write_text(
        text.replace("samples: 128", f"samples: {samples}" + (f"\n    {more}" if more else "")),
        "utf-8",
    )
    return file


def _command(scene: Path, out: Path, *more: str, word: str = "sweep") -> list[str]:
    return [sys.executable, "-m", "torsion", word, str(scene), "-o", str(out), *more]


def _run(scene: Path, out: Path, *more: str, word: str = "sweep") -> tuple[float, float]:
    """Seconds of the sweep by the clock, and of the processors by the command with all of its processes."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ran = subprocess.run(
        _command(scene, out, *more, word=word), capture_output=True, text=True, check=False
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if ran.returncode not in (0, 1):
        raise RuntimeError(ran.stderr)
    done = json.loads((out / "results.json").read_text(encoding="utf-8"))["plan"]["done"]
    seconds = next(line["seconds"] for line in done if line["what"] == "sweep")
    return seconds, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _answers(out: Path) -> object:
    """What the results say of the sweep, and every bit of its parts where they are kept."""
    from torsion.sweeping.sweep_folder import read_part

    found = json.loads((out / "results.json").read_text(encoding="utf-8"))["sweep"]
    sums = out / "parts" / "SHA256SUMS"
    lines = sums.read_text(encoding="utf-8").split("\n")[:-1] if sums.exists() else []
    names = sorted(
        (name, checksum) for checksum, _, name in (line.partition("  ") for line in lines)
    )
    parts = [read_part(out / "parts" / name, checksum)[0] for name, checksum in names]
    return found, [
        {name: own.tobytes() for name, own in part.items() if own.dtype != object} for part in parts
    ]


def _times(scenes: Mapping[str, Path], folder: Path) -> str:
    rows = []
    for what, scene in scenes.items():
        known, first = None, 0.0
        for name, word, more in (
            ("`solve`", "solve", ()),
            ("1 worker", "sweep", ("--workers", "1")),
            ("2 workers", "sweep", ("--workers", "2")),
        ):
            out, load = folder / f"{what} {name}", os.getloadavg()[0]
            seconds, processors = _run(scene, out, *more, word=word)
            sweep, parts = _answers(out)
            samples = sweep["samples"]
            if known is None:
                known, first, equal = (sweep, None), seconds, "-"
            else:
                same = sweep == known[0] and (known[1] is None or parts == known[1])
                known, equal = (known[0], parts), "yes" if same else "NO"
            times = sorted(path.stat().st_mtime for path in out.glob("parts/*"))
            rate = (
                samples * (1 - 1 / len(times)) / (times[-1] - times[0])
                if len(times) > 1
                else samples / seconds
            )
            size = sum(path.stat().st_size for path in out.glob("parts/*")) / 1e6
            rows.append(
                (
                    what,
                    str(samples),
                    name,
                    f"{seconds:.1f}",
                    f"{first / seconds:.2f}",
                    f"{rate:.3g}",
                    f"{processors:.1f}",
                    f"{size:.1f}" if parts else "-",
                    equal,
                    f"{load:.1f}",
                )
            )
            shutil.rmtree(out)
    head = (
        "variants",
        "number",
        "by",
        "wall s",
        "times faster than `solve`",
        "variants/s after the first part",
        "processor s",
        "parts MB",
        "equal to the last bit",
        "load before",
    )
    return table(head, rows)


def _ended(scene: Path, folder: Path) -> str:
    """A worker killed, the command killed, Ctrl-C: what is left, and whether the sweep then is that of one run."""
    whole = folder / "whole"
    _run(scene, whole)
    known, count = _answers(whole), len(list(whole.glob("parts/*")))
    rows = []
    for what, end in (
        ("a worker killed", _kill_worker),
        ("the command killed", _kill),
        ("Ctrl-C", _interrupt),
    ):
        out = folder / what
        began = subprocess.Popen(
            _command(scene, out, "--workers", "2"),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
        while len(list(out.glob("parts/part-*"))) < count // 3 and began.poll() is None:
            time.sleep(0.01)
        end(began.pid)
        _, stated = began.communicate()
        left = {
            path: path.stat().st_mtime_ns
            for path in out.glob("parts/part-*")
            if path.suffix != ".part"
        }
        if began.returncode not in (0, 1):
            _run(scene, out)
        kept = sum(path.stat().st_mtime_ns == when for path, when in left.items())
        said = stated.decode().strip().replace(f"{folder}/", "")
        says = said if began.returncode >= 0 else ""
        equal = "yes" if _answers(out) == known else "NO"
        rows.append(
            (what, str(began.returncode), f"{len(left)} of {count}", str(kept), equal, says or "-")
        )
    head = (
        "at a third of the parts",
        "exit status",
        "parts left",
        "of them resumed by the same command",
        "then equal",
        "says",
    )
    return "## Ended before the end\n\n" + table(head, rows)


def _children(process: int) -> Iterator[int]:
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            is_worker = b"torsion" in status.with_name("cmdline").read_bytes()
            if int(status.read_text().rpartition(")")[2].split()[1]) == process and is_worker:
                yield int(status.parent.name)
        except OSError:
            continue


def _kill_worker(process: int) -> None:
    os.kill(next(_children(process)), signal.SIGKILL)


def _kill(process: int) -> None:
    os.kill(process, signal.SIGKILL)


def _interrupt(process: int) -> None:
    os.killpg(process, signal.SIGINT)  # as a terminal does: to all processes of the command


def _by_tls(scene: Path, folder: Path) -> str:
    if shutil.which("openssl") is None:
        return "## TLS\n\nNot tried: there is no openssl here."
    here, out = folder / "tls", folder / "by tls"
    here.mkdir()
    for words in (
        "req -x509 -newkey rsa:2048 -nodes -days 2 -keyout ca-key.pem -out ca.pem -subj /CN=sweep-authority",
        "req -newkey rsa:2048 -nodes -keyout key.pem -out request.pem -subj /CN=sweep",
        "x509 -req -days 2 -in request.pem -CA ca.pem -CAkey ca-key.pem -CAcreateserial -out cert.pem",
    ):
        subprocess.run(["openssl", *words.split()], cwd=here, capture_output=True, check=True)
    files = [
        "--tls-ca-file",
        "ca.pem",
        "--tls-cert",
        "cert.pem",
        "--tls-key",
        "key.pem",
        "--no-dashboard",
    ]
    address = f"127.0.0.1:{PORT}"
    scheduler = [
        "scheduler",
        "--host",
        "127.0.0.1",
        "--port",
        str(PORT),
        "--protocol",
        "tls",
        *files,
    ]
    workers = ["worker", f"tls://{address}", "--nthreads", "1", "--nworkers", "2", *files]
    names = {"CA_FILE": "ca", "CLIENT__CERT": "cert", "CLIENT__KEY": "key"}
    tls = {
        f"DASK_DISTRIBUTED__COMM__TLS__{key}": str(here / f"{name}.pem")
        for key, name in names.items()
    }
    with _process(here, scheduler), _process(here, workers):
        plain = subprocess.run(
            _command(scene, folder / "plain", "--scheduler", f"tcp://{address}"),
            capture_output=True,
            text=True,
            check=False,
        )
        os.environ.update(tls)
        _run(scene, out, "--scheduler", f"tls://{address}")
    equal = "yes" if _answers(out) == _answers(folder / "whole") else "NO"
    return (
        "## TLS\n\nA scheduler and two workers of their own with TLS: equal to the last bit to a run without: "
        f"{equal}. A client without TLS ends with status {plain.returncode}: "
        f"`{plain.stderr.strip().partition(': in <')[0]}`."
    )


@contextmanager
def _process(folder: Path, words: list[str]) -> Iterator[None]:
    began = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_" + words[0], *words[1:]],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        if words[0] == "scheduler":
            time.sleep(5.0)
        yield
    finally:
        began.send_signal(signal.SIGINT)
        try:
            began.wait(20)
        except subprocess.TimeoutExpired:
            began.kill()


if __name__ == "__main__":
    main()
