"""Workers of a Dask scheduler, on any machine, that answer the chunks of a sweep."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from torsion.errors import Fault, InputError, SolveError, refusal
from torsion.sweeping.worker_task import Errand, answered
from torsion.what_if.variants.chunks import Chunk, Part

AHEAD = 2  # chunks sent for every thread of the workers, so that none waits
ANSWER, JOIN = 30.0, 120.0  # seconds until a scheduler answers, and until its first worker joins
ANY_PORT = "127.0.0.1:0"  # of what dask shows of itself: this machine only, on a free port
LOOPBACK = ("127.0.0.1", "localhost", "::1")


@dataclass(frozen=True)
class Workplace:
    """Where chunks are answered: processes of this machine (None: all processors), or workers of a scheduler."""

    processes: int | None = None
    address: str = ""  # of the scheduler
    file: Path | None = None  # that the scheduler wrote its address to

    @property
    def is_elsewhere(self) -> bool:
        """Chunks are sent to a scheduler."""
        return bool(self.address) or self.file is not None


def check_workplace(workplace: Workplace) -> None:
    """Raise InputError where options clash, a file is missing, or a library is."""
    if find_spec("pyarrow") is None:
        raise refusal(
            "`torsion sweep` keeps its parts as Parquet, which needs pyarrow",
            "pip install '.[sweep]'",
        )
    if not workplace.is_elsewhere:
        return
    if workplace.address and workplace.file is not None:
        raise refusal("--scheduler and --scheduler-file name two schedulers", "give one of them")
    if workplace.processes is not None:
        raise refusal(
            "--workers are of this machine, and a scheduler has its own", "give one of them"
        )
    if find_spec("distributed") is None:
        raise refusal("a scheduler needs dask", "pip install '.[sweep]'")
    if workplace.file is not None and not workplace.file.is_file():
        raise refusal(f"--scheduler-file {workplace.file}: no such file", "give its path")


def unprotected(workplace: Workplace) -> str:
    """Return a warning where anyone who reaches the scheduler could run programs on its workers; empty where not."""
    address = workplace.address
    parts = urlsplit(address if "://" in address else f"tcp://{address}")
    if not address or parts.scheme == "tls" or parts.hostname in LOOPBACK:
        return ""
    return (
        f"warning: the scheduler {address} has no TLS. Anyone who reaches its port can run programs on its "
        "workers and on this machine. Use it only in a private network, or start it with --tls-ca-file, --tls-cert, "
        "--tls-key"
    )


def answers_of_workers(
    workplace: Workplace, errand: Errand, chunks: Sequence[Chunk], waiting: Callable[[str], None]
) -> Iterator[tuple[Chunk, Part]]:
    """Yield every chunk with its answers, as they come; raises InputError or SolveError where workers cannot.

    waiting: is given words for what is waited for.
    """
    from distributed import CancelledError, KilledWorker, as_completed

    left, sent = list(reversed(chunks)), dict[str, Chunk]()
    waiting("sweep, waiting for the workers")
    with _client_of(workplace) as client:

        def send() -> list[Any]:
            """As many chunks as the workers of now can take."""
            futures = []
            while left and len(sent) < AHEAD * max(sum(client.nthreads().values()), 1):
                chunk = left.pop()
                futures.append(future := client.submit(answered, errand, chunk, pure=False))
                sent[future.key] = chunk
            return futures

        under_way = as_completed(send())
        for future in under_way:
            chunk = sent.pop(future.key)
            try:
                values, answers = future.result()
            except KilledWorker as error:
                variants = f"the variants {chunk.begin} to {chunk.end - 1}"
                message = f"{variants} ended every worker that took them: {error}"
                hint = "more memory for each worker, or fewer workers on a machine"
                raise SolveError(message, hint) from None
            except (CancelledError, OSError, TimeoutError) as error:
                hint = "the parts stay; start it again and give the same command"
                raise SolveError(f"the scheduler is gone: {error}", hint) from None
            except InputError as error:
                hint = "the same files and programs on every machine"
                message = f"a worker cannot join: {error} ({hint})"
                raise InputError([Fault((), str(error), hint)], message) from None
            yield chunk, (values, answers)
            for future_chunk in send():
                under_way.add(future_chunk)


@contextmanager
def _client_of(workplace: Workplace) -> Iterator[Any]:
    """Yield a client of the scheduler, which has a worker; TLS is that of dask's own configuration."""
    from distributed import Client

    scheduler = workplace.address or str(workplace.file)
    place = {"address": scheduler} if workplace.address else {"scheduler_file": scheduler}
    try:
        client = Client(**place, timeout=ANSWER)
    except Exception as error:  # it may be no scheduler, no file of one, or its TLS is not ours
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise refusal(
            f"no scheduler answers at {scheduler}: {reason}",
            f"start one: dask scheduler --dashboard-address {ANY_PORT}",
        ) from None
    with client:
        try:
            client.wait_for_workers(1, timeout=JOIN)
        except TimeoutError:
            hint = (
                f"dask worker {scheduler} --nthreads 1 --nworkers -1 --dashboard-address {ANY_PORT}"
            )
            raise refusal(f"no worker has joined the scheduler {scheduler}", hint) from None
        yield client
