"""What a process that solves begins with where it is forked from another: a scene solved and drawn once, here."""

import gc
import signal
import sys
from types import TracebackType


def _unless_ended(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    """Report an error unless the command ended while its process began, which finds no more to read."""
    if kind is not EOFError:
        sys.__excepthook__(kind, error, trace)


sys.excepthook = _unless_ended
signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the command, which ends this process

from torsion.live.pictures import modes_of, whole_of  # noqa: E402
from torsion.live.sliders import shown  # noqa: E402
from torsion.schema import template  # noqa: E402
from torsion.schema.scene_reader import parse, reread  # noqa: E402
from torsion.schema.variation import movable  # noqa: E402

study = parse(template("example.yaml"))
shown(movable(study, *reread(study)), {})
modes_of(study)
whole_of(study, (), lambda what, share: None)
gc.collect()
gc.freeze()
