"""What the file says of a sweep: which figures vary, by which law, how many samples."""

import re
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema

from torsion import fields
from torsion.fields import Declared, given, refuse

LAWS = ("uniform", "normal", "lognormal", "triangular")
FEWEST, MOST = 128, 1 << 22
CHECKED = 512  # samples where nothing else is said and every one is judged
Result = Literal["modes", "checks"]


def _without_sign(value: Any) -> Any:
    """ "+-15 %" and "± 15 %" as "15 %"."""
    return re.sub(r"^\s*(\+-|\+/-|±)\s*", "", value) if isinstance(value, str) else value


def _of_tolerances(value: Any) -> Any:
    """`vary: tolerances` is the default."""
    return {} if value == "tolerances" else value


Width = Annotated[
    float,
    fields.Quantity("1", above=0, below=1, usual=(None, 0.6), slip=("%",)),
    BeforeValidator(_without_sign),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string", "description": "a share, +-15 % or 15 %"}]}),
]


class Law(Declared):
    """How one figure varies, relative to that of the file; one of the four laws."""

    uniform: Width | None = given("any value within this of the file's is as likely: +-15 %")
    normal: Width | None = given("standard deviation, the mean being the file's value: 5 %")
    lognormal: Width | None = given("standard deviation of the logarithm, the median being the file's value")
    triangular: Width | None = given("likeliest at the file's value, falling to nothing this far from it")
    within: Width | None = given("no value farther from the file's than this; of `normal` (default: 3 deviations)")

    def refuse_clashes(self) -> None:
        """One law, and `within` with a normal one alone."""
        named = [law for law in LAWS if getattr(self, law) is not None]
        if len(named) != 1:
            found = f"{' and '.join(named)} are laws of one figure" if named else "a figure that varies needs a law"
            raise refuse(found, f"one of {', '.join(LAWS)}", key=named[-1] if named else "")
        if self.within is not None and (self.normal is None or self.within <= self.normal):
            raise refuse(
                "`within` cuts a normal law at more than its deviation", "{normal: 5 %, within: 15 %}", "within"
            )
        if self.normal is not None and self.within is None and 3.0 * self.normal >= 1.0:
            raise refuse("three deviations take the figure to 0", "`within: 90 %`, or lognormal", "normal")

    @property
    def words(self) -> str:
        """As the report states it."""
        name = next(law for law in LAWS if getattr(self, law) is not None)
        width = f"{name} {'±' if name in ('uniform', 'triangular') else ''}{100.0 * getattr(self, name):.6g} %"
        return width + ("" if self.within is None else f" within ±{100.0 * self.within:.6g} %")


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
