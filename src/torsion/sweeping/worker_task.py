"""What a worker does: one chunk of a sweep, of the same scene by the same programs as where it was sent from."""

import pickle
from dataclasses import dataclass, replace
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from threading import Lock

from torsion.errors import refusal
from torsion.findings import Work, version
from torsion.runner import run
from torsion.study import Variation
from torsion.sweeping.sweep_folder import LIBRARIES, digests
from torsion.what_if.sweep import sweep_run
from torsion.what_if.variants.chunks import Chunk, Part

_ALONE = Lock()  # threads of a worker take turns


@dataclass(frozen=True)
class Errand:
    """What every chunk of a sweep needs."""

    scene: bytes  # the work up to the sweep, and what varies
    files: tuple[tuple[str, str], ...]  # that variants read themselves, and their digests
    versions: tuple[tuple[str, str], ...]


def errand(work: Work, variation: Variation) -> Errand:
    """The errand of a sweep, which any process can do."""
    study = replace(work.study, cases={})
    results = {name: work.results[name] for name in work.results.keys() & {"system", "modes"}}
    scene = pickle.dumps((Work(study, results, ruled=work.ruled), variation))
    files = tuple(digests(study, shipped=False).items())
    return Errand(scene, files, tuple((name, version(name)) for name in LIBRARIES))


def answered(given: Errand, chunk: Chunk) -> Part:
    """The values of a chunk and what they answer; raises InputError where this process would not answer the same."""
    with _ALONE:
        return sweep_run.answered(*_opened(given), chunk)


@lru_cache(maxsize=4)
def _opened(given: Errand) -> tuple[Work, Variation]:
    fault = ", ".join(
        f"{name} {needed} is needed and {version(name)} is there"
        for name, needed in given.versions
        if version(name) != needed
    )
    missing = [
        name
        for name, checksum in given.files
        if not Path(name).is_file() or sha256(Path(name).read_bytes()).hexdigest() != checksum
    ]
    if missing and not fault:
        fault = f"not there as where the sweep was begun: {', '.join(missing)}"
    if fault:
        raise refusal(fault)
    work, variation = pickle.loads(given.scene)
    return replace(work, solve=run), variation
