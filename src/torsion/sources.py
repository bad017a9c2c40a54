"""The literature of formulas and methods: each is declared where it is evaluated, so that a run lists what it used.

Limits of rules are not listed here: their editions are in the basis of each check.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import wraps
from typing import ParamSpec, TypeVar

Arguments = ParamSpec("Arguments")
Answer = TypeVar("Answer")
Citations = dict[tuple[str, str], None]  # (key, where) in the order of use


@dataclass(frozen=True)
class Source:
    """A publication: what it is used for, and whether edition and digits were compared with it."""

    key: str
    authors: str
    year: str
    work: str  # journal with volume and page, or title and publisher
    use: str
    compared: bool

    @property
    def words(self) -> str:
        """Authors, work and year in one line."""
        return f"{self.authors}: {self.work}" + (f" ({self.year})" if self.year else "")

    @property
    def bibtex(self) -> str:
        """The entry of a bibliography in BibTeX."""
        authors = self.authors.replace(", ", " and ")
        fields = {"author": authors, "year": self.year, "note": self.work}
        lines = (f",\n  {name} = {{{value}}}" for name, value in fields.items() if value)
        return f"@misc{{{self.key}{''.join(lines)}\n}}".replace("&", r"\&")


RECORDS = """\
AllemangBrown1982; Allemang, Brown; 1982; Proc. 1st Int. Modal Analysis Conf., 110; modal assurance criterion
Ainsworth2004; Ainsworth; 2004; SIAM J. Numer. Anal. 42, 553; error of finite elements
Archer; Archer; -; damping A Q/n of propellers; propeller damping (M)
ASTM-E1049; ASTM; -; E1049, Cycle Counting in Fatigue Analysis; rainflow counting (M)
BagleyTorvik1983; Bagley, Torvik; 1983; J. Rheol. 27, 201; fractional spring
Carter; Carter, in Nestorides; 1958; A Handbook on Torsional Vibration; stiffness of a throw (M)
Caughey1960; Caughey; 1960; J. Appl. Mech. 27, 640; spring with a slider
Cowper1966; Cowper; 1966; J. Appl. Mech. 33, 335; shear coefficients
DenHartog1956; Den Hartog; 1956; Mechanical Vibrations, McGraw-Hill; viscous damper
Ehrlich1967; Ehrlich; 1967; Comm. ACM 10, 107; damped roots
Aberth1973; Aberth; 1973; Math. Comp. 27, 339; damped roots
Foeppl1905; Föppl; 1905; shafts of varying diameter; steps and hubs (M)
Frahm; Frahm; -; damping a Q/omega of propellers; propeller damping (M)
Genta2005; Genta; 2005; Dynamics of Rotating Systems, Springer; whirl, rotating damping
HairerWanner1996; Hairer, Wanner; 1996; Solving Ordinary Differential Equations II, Springer; Radau IIA
Harris1978; Harris; 1978; Proc. IEEE 66, 51; windows of order tracking
ISO6336-1; ISO; -; 6336-1, Calculation of load capacity of gears; tooth forces
Jansen1999; Jansen; 1999; Comput. Phys. Commun. 117, 35; total Sobol indices (M)
KerWilson; Ker Wilson; -; Practical Solution of Torsional Vibration Problems; stiffness of a throw (M)
Kloss1916; Kloss; 1916; Archiv für Elektrotechnik 5, 59; torque of induction motors (M)
Kruskal1956; Kruskal; 1956; Proc. Amer. Math. Soc. 7, 48; spanning tree of closed loops
Lewis1932; Lewis; 1932; Trans. ASME 54, 253; passing a resonance
Liu2023; Liu et al.; 2023; Ship Sci. Technol. 45 (2), 80; secondary couples
Ma2011; Ma, Yu, Han; 2011; Int. J. Plant Eng. Manag. 16, 119; shafts with several cross joints
Miner1945; Miner; 1945; J. Appl. Mech. 12, A159; damage sum (M)
NishiharaAsami2002; Nishihara, Asami; 2002; J. Vib. Acoust. 124, 576; tuned damper (M)
ParlettDhillon1997; Parlett, Dhillon; 1997; Linear Algebra Appl. 267, 247; shapes of modes from one station
Pilkey1997; Pilkey; 1997; Peterson's Stress Concentration Factors, Wiley; fillets and keyways (M)
PragerSynge1947; Prager, Synge; 1947; Quart. Appl. Math. 5, 241; bounds of steps and hubs (M)
Prandtl1903; Prandtl; 1903; Phys. Z. 4, 758; stress function of a section
Rayleigh1877; Rayleigh; 1877; The Theory of Sound, vol. 1, art. 90; sensitivities of frequencies
Saltelli2010; Saltelli et al.; 2010; Comput. Phys. Commun. 181, 259; Sobol indices (M)
Schwanecke; Schwanecke; -; damping of propellers by their dimensions; propeller damping (M)
StornPrice1997; Storn, Price; 1997; J. Global Optim. 11, 341; differential evolution
SzaboBabuska1991; Szabó, Babuška; 1991; Finite Element Analysis, Wiley; hierarchic functions
Wiebe1970; Wiebe; 1970; heat release of a cylinder; gas torque (M)
Willis1841; Willis; 1841; Principles of Mechanism; planetary stages (M)
WittrickWilliams1971; Wittrick, Williams; 1971; Quart. J. Mech. Appl. Math. 24, 263; counts of natural frequencies
ZhuWang; Zhu, Wang; -; combination resonance of a misaligned shaft driven by a universal joint; tilt
"""  # key; authors; year; work; use, with (M) where edition or digits are not confirmed


_ROWS = (line.split("; ") for line in RECORDS.splitlines())
SOURCES = {
    key: Source(key, authors, year.strip("-"), work, use.removesuffix(" (M)"), "(M)" not in use)
    for key, authors, year, work, use in _ROWS
}
_USED: ContextVar[Citations | None] = ContextVar("sources used", default=None)


def note(key: str, where: str = "") -> None:
    """Note that a source is used; `where` is its equation, chapter or chart."""
    citations = _USED.get()
    if citations is not None:
        citations[SOURCES[key].key, where] = None


def source(
    key: str, where: str = ""
) -> Callable[[Callable[Arguments, Answer]], Callable[Arguments, Answer]]:
    """Declare on a function the source that it evaluates: each call notes it."""

    def declare(function: Callable[Arguments, Answer]) -> Callable[Arguments, Answer]:
        @wraps(function)
        def noted(*arguments: Arguments.args, **settings: Arguments.kwargs) -> Answer:
            note(key, where)
            return function(*arguments, **settings)

        return noted

    return declare


@contextmanager
def collected() -> Iterator[Citations]:
    """Collect the sources that the block uses; those of a block within it count for both."""
    outer = _USED.get()
    citations: Citations = {}
    token = _USED.set(citations)
    try:
        yield citations
    finally:
        _USED.reset(token)
        if outer is not None:
            outer.update(citations)
