"""Rebuilds the pages and figures of reports/papers: `python -m benchmarks.papers`, a minute."""

import argparse
from pathlib import Path

from benchmarks.papers import (
    chang_li_tripod,
    liu_2023,
    liu_bend,
    ma_2011,
    pump_lumped,
    shafting,
    zhu_wang,
)

REPORTS = Path(__file__).parents[2] / "reports" / "papers"
PAPERS = (liu_2023, liu_bend, ma_2011, chang_li_tripod, pump_lumped, shafting, zhu_wang)


def main() -> None:
    """Writes every page with its figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=REPORTS, help="folder to write to (default: reports/papers)"
    )
    folder: Path = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    for paper in PAPERS:
        page = paper.page()
        (folder / f"{page.name}.md").write_text(page.text(), encoding="utf-8")
        for picture in page.pictures:
            (folder / f"{picture.name}.svg").write_text(picture.svg, encoding="utf-8")
        print(
            f"{page.name}: {len(page.numbers)} numbers, {len(page.pictures)} figures, {len(page.misprints)} faults"
        )


if __name__ == "__main__":
    main()
