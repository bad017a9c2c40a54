"""Workers that answer chunks, by dask: of this machine, or of a scheduler whose workers are anywhere."""

import json
import logging
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from torsion.errors import Fault, InputError, SolveError
from torsion.sweeping.worker_task import Errand, answered, differing_versions
from torsion.what_if.variants.chunks import Chunk, Part

ENVIRONMENT = {  # of the workers of this machine
    "MALLOC_TRIM_THRESHOLD_": str(
        1 << 30
    ),  # else every larger array is a fresh mapping: 3 times the time (measured)
    "MALLOC_MMAP_THRESHOLD_": str(1 << 30),
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
}
AHEAD = 2  # chunks sent for every thread of the workers, so that none waits
ANSWER, JOIN = 30.0, 120.0  # seconds until a scheduler answers, and until its first worker joins
DEATHS = 10  # workers that a chunk may end before it is given up: they may be ended by others
ANY_PORT = "127.0.0.1:0"  # of what dask shows of itself: this machine only, on a free port
LOOPBACK = ("127.0.0.1", "localhost", "::1")


@dataclass(frozen=True)
class Scheduler:
    """Where the workers are: `workers` of this machine, or those of a scheduler by its address or its file."""

    workers: int = 1
    address: str = ""
    file: Path | None = None
    ca: Path | None = None
    cert: Path | None = None
    key: Path | None = None

    @property
    def is_needed(self) -> bool:
        """Chunks are not solved in this process."""
        return self.workers > 1 or bool(self.address) or self.file is not None


def checked(given: Scheduler) -> Scheduler:
    """The same with its address; raises InputError where options clash, a file is missing, or dask is."""
    tls = {"--tls-ca": given.ca, "--tls-cert": given.cert, "--tls-key": given.key}
    named = [option for option, file in tls.items() if file is not None]
    if given.address and given.file is not None:
        raise _refused("--scheduler and --scheduler-file name two schedulers", "give one of them")
    if given.workers > 1 and (given.address or given.file is not None):
        raise _refused(
            "--workers are of this machine, and a scheduler has its own", "give one of them"
        )
    if find_spec("pyarrow") is None:
        raise _refused(
            "`torsion sweep` keeps its parts as Parquet, which needs pyarrow",
            "pip install '.[sweep]'",
        )
    if given.is_needed and (find_spec("dask") is None or find_spec("distributed") is None):
        raise _refused("workers need dask", "pip install '.[sweep]'")
    for option, file in {**tls, "--scheduler-file": given.file}.items():
        if file is not None and not file.is_file():
            raise _refused(f"{option} {file}: no such file", "give its path")
    address = given.address if given.file is None else _address(given.file)
    if named and not address.startswith("tls://"):
        raise _refused(
            f"{named[0]} is of a scheduler tls://...", "give its address, or leave it out"
        )
    if address.startswith("tls://") and len(named) < len(tls):
        missing = ", ".join(option for option in tls if option not in named)
        raise _refused(
            f"the scheduler {address} needs {missing}", "the files that it was started with"
        )
    return Scheduler(given.workers, address, given.file, given.ca, given.cert, given.key)


def _address(file: Path) -> str:
    try:
        return str(json.loads(file.read_text(encoding="utf-8"))["address"])
    except (OSError, ValueError, KeyError, TypeError):
        hint = (
            f"it is written by: dask scheduler --scheduler-file FILE --dashboard-address {ANY_PORT}"
        )
        raise _refused(f"{file} is not a file of a scheduler", hint) from None


def _refused(message: str, hint: str) -> InputError:
    return InputError([Fault((), message, hint)], f"{message} ({hint})")


def unprotected(given: Scheduler) -> str:
    """A warning where anyone who reaches the scheduler could run programs on its workers; empty where not."""
    parts = urlsplit(given.address if "://" in given.address else f"tcp://{given.address}")
    if not given.address or parts.scheme == "tls" or parts.hostname in LOOPBACK:
        return ""
    return (
        f"warning: the scheduler {given.address} has no TLS. Anyone who reaches its port can run programs on its "
        "workers and on this machine. Use it only in a private network, or start it with --tls-ca-file, --tls-cert, "
        "--tls-key"
    )


class Workers:
    """The workers, begun when the first chunk is sent; to be closed."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler, self._open, self._client = scheduler, ExitStack(), None

    def __enter__(self) -> "Workers":
        return self

    def __exit__(self, *raised: object) -> None:
        self._open.close()

    def answers(
        self, errand: Errand, chunks: Sequence[Chunk], waiting: Callable[[str], None]
    ) -> Iterator[tuple[Chunk, Part]]:
        """Every chunk with its answers, as they come; raises InputError or SolveError where workers cannot.

        waiting: is given words for what is waited for.
        """
        from distributed import as_completed

        client = self._client = self._client or self._started(waiting)
        _compare(client, errand)
        left, sent = list(reversed(chunks)), dict[str, Chunk]()

        def send() -> list[Any]:
            """As many chunks as the workers of now can take."""
            some = []
            while left and len(sent) < AHEAD * max(sum(client.nthreads().values()), 1):
                chunk = left.pop()
                some.append(future := client.submit(answered, errand, chunk, pure=False))
                sent[future.key] = chunk
            return some

        under_way = as_completed(send())
        for future in under_way:
            chunk = sent.pop(future.key)
            yield chunk, _result(future, chunk)
            for future_chunk in send():
                under_way.add(future_chunk)

    def _started(self, waiting: Callable[[str], None]) -> Any:
        """A client of the scheduler, or of workers of this machine."""
        import dask
        from distributed import Client, LocalCluster
        from distributed.security import Security

        given = self._scheduler
        waiting("sweep, waiting for the workers")
        if not given.address:
            for name, value in ENVIRONMENT.items():
                os.environ.setdefault(name, value)
            dask.config.set({"distributed.scheduler.allowed-failures": DEATHS})
            with _undisturbed():
                cluster = LocalCluster(
                    n_workers=given.workers,
                    threads_per_worker=1,
                    processes=True,
                    dashboard_address=ANY_PORT,
                    worker_dashboard_address=ANY_PORT,
                    scheduler_kwargs={"dashboard": False},
                    memory_limit=0,
                    host="127.0.0.1",
                    silence_logs=logging.CRITICAL,
                )
            return self._open.enter_context(Client(self._open.enter_context(cluster)))
        protected = given.ca is not None
        files = {
            "tls_ca_file": given.ca,
            "tls_client_cert": given.cert,
            "tls_client_key": given.key,
        }
        security = Security(
            require_encryption=True, **{name: str(file) for name, file in files.items()}
        )
        try:
            client = Client(given.address, timeout=ANSWER, security=security if protected else None)
        except (
            OSError,
            TimeoutError,
            ValueError,
            RuntimeError,
            MemoryError,
        ) as error:  # it may be no scheduler
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise _refused(
                f"no scheduler answers at {given.address}: {reason}",
                f"start one: dask scheduler --dashboard-address {ANY_PORT}",
            ) from None
        self._open.enter_context(client)
        try:
            client.wait_for_workers(1, timeout=JOIN)
        except TimeoutError:
            hint = f"dask worker {given.address} --nthreads 1 --nworkers -1 --dashboard-address {ANY_PORT}"
            raise _refused(f"no worker has joined the scheduler {given.address}", hint) from None
        return client


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Processes that are begun here do not hear Ctrl-C, which ends them by their parent."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _compare(client: Any, errand: Errand) -> None:
    """Raise InputError where a worker has other versions."""
    workers = client.get_versions(packages=[name for name, _ in errand.versions])["workers"]
    for worker, versions in workers.items():
        differ = differing_versions(errand.versions, versions.get("packages", {}))
        if differ:
            hint = "install the same everywhere: answers of others may differ in their last digits"
            raise _refused(f"the worker {worker} cannot join: {differ}", hint)


def _result(future: Any, chunk: Chunk) -> Part:
    """The answers of a chunk; raises InputError or SolveError."""
    from distributed import CancelledError, KilledWorker

    try:
        values, answers = future.result()
        return values, answers
    except KilledWorker as error:
        message = f"the variants {chunk.begin} to {chunk.end - 1} ended every worker that took them: {error}"
        raise SolveError(
            message, hint="more memory for each worker, or fewer workers on a machine"
        ) from None
    except (CancelledError, OSError, TimeoutError) as error:
        message = f"the scheduler is gone: {error}"
        raise SolveError(
            message, hint="the parts stay; start it again and give the same command"
        ) from None
    except InputError as error:
        hint = "the same files and programs on every machine"
        raise _refused(f"a worker cannot join: {error}", hint) from None
