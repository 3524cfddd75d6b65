"""Writes the page on recorded pedestrians: ``python -m tests.benchmarks.pedestrians.write FOLDER``.

FOLDER has ``eth_obsmat.txt``, ``hotel_obsmat.txt`` (ETH) and ``trajectron_zara01.txt`` (UCY, rows ``frame id x y``).
"""

from __future__ import annotations

import sys
from pathlib import Path

from tests.benchmarks.pedestrians import corridor, fitted, human, robot

PAGE = Path(__file__).resolve().parents[3] / "skills" / "irsim-benchmark" / "results" / "pedestrians.md"
TEXT = Path(__file__).with_name("page.md")


def page(data: Path) -> str:
    """The whole page."""
    text = TEXT.read_text(encoding="utf-8")
    parts = {
        "files": human.files_table(data),
        **human.parts(human.compare(data)),
        **fitted.parts(data),
        **corridor.parts(),
        **robot.parts(*robot.measure(data)),
    }
    return text.format(**parts)


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    print(human.files_table(folder))
    PAGE.write_text(page(folder), encoding="utf-8")
    robot.EPISODES.write_text("\n".join(robot.episodes(robot.plan_of(folder))) + "\n", encoding="utf-8")
    print(f"wrote {PAGE}")
