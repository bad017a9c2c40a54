"""One test that holds a law for many cases and lists those that break it."""

import functools
import inspect
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest


def for_all(names: str | tuple[str, ...], cases: Iterable[Any]) -> Callable[..., Any]:
    """Hold a law for every case in a single test, where `pytest.mark.parametrize` makes one of each.

    `names` and `cases` are those of `parametrize`. Other arguments of the law are fixtures, the same for all
    cases, but for a `tmp_path`: each case has a folder of its own.
    """
    arguments = names.replace(" ", "").split(",") if isinstance(names, str) else list(names)
    rows = [(case,) if len(arguments) == 1 else tuple(case) for case in cases]
    assert rows, "a law without a case cannot fail"

    def decorate(law: Callable[..., None]) -> Callable[..., None]:
        @functools.wraps(law)
        def test(**fixtures: Any) -> None:
            offenders = list[Exception]()
            for number, row in enumerate(rows):
                if "tmp_path" in fixtures:
                    folder = Path(fixtures["tmp_path"]) / f"case-{number}"
                    folder.mkdir()
                    chosen = fixtures | {"tmp_path": folder}
                else:
                    chosen = fixtures
                try:
                    law(**dict(zip(arguments, row, strict=True)), **chosen)
                except (Exception, pytest.fail.Exception) as error:
                    offender = AssertionError(str(error) or type(error).__name__)
                    offender.add_note(f"case {number}: {', '.join(map(repr, row))}"[:2000])
                    offenders.append(offender.with_traceback(error.__traceback__))
            if offenders:
                raise ExceptionGroup(f"{len(offenders)} of {len(rows)} cases", offenders)

        signature = inspect.signature(law)
        kept = [value for name, value in signature.parameters.items() if name not in arguments]
        test.__signature__ = signature.replace(parameters=kept)  # type: ignore[attr-defined]
        del test.__wrapped__  # type: ignore[attr-defined]
        return test

    return decorate
