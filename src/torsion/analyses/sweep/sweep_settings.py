"""What the file says of a sweep: which figures vary, by which law, how many samples."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from torsion.analyses.variants.laws import Choice, Law
from torsion.fields import Declared, given, refuse

FEWEST, MOST = 128, 1 << 22
CHECKED = 512  # samples where nothing else is said and every one is judged
Result = Literal["modes", "checks"]


def _of_tolerances(value: Any) -> Any:
    """`vary: tolerances` is the default."""
    return {} if value == "tolerances" else value


class SweepSettings(Declared):
    """Settings of `sweep`."""

    vary: Annotated[dict[str, Law], BeforeValidator(_of_tolerances)] = given(
        "figures by `component.key` and how they vary (default: those with a tolerance, uniformly)", {}
    )
    together: tuple[tuple[str, ...], ...] = given("figures that vary as one, such as two couplings of one batch", ())
    samples: Annotated[int, Field(ge=FEWEST, le=MOST)] | None = given(
        f"how many variants (default: {CHECKED} that are judged, 16384 of frequencies alone)"
    )
    method: Literal["sobol", "latin", "random"] = given(
        "sobol: eight scrambled sequences, a power of two of samples; latin hypercube; or random", "sobol"
    )
    seed: Annotated[int, Field(ge=0)] = given("of the samples; the same seed gives the same variants", 1)
    results: tuple[Result, ...] = given("what each variant answers (default: checks where the file names rules)", ())

    def refuse_clashes(self) -> None:
        """Sobol's samples are a power of two."""
        count = self.samples
        if count is not None and self.method == "sobol" and count & (count - 1):
            above = 1 << count.bit_length()
            raise refuse(
                f"{count} samples are no power of two, as sobol takes them",
                f"{above // 2} or {above}, or `method: random`", "samples",
            )  # fmt: skip

    @property
    def varied(self) -> tuple[str, Mapping[str, Choice]]:
        """The key that names the figures, and how each varies."""
        return "vary", self.vary
