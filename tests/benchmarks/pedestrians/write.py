"""Writes the page on recorded pedestrians: ``python -m tests.benchmarks.pedestrians.write FOLDER``.

FOLDER has ``eth_obsmat.txt``, ``hotel_obsmat.txt`` (ETH) and ``trajectron_zara01.txt`` (UCY, rows ``frame id x y``).
``--words OLD``, where OLD is the template of the page as it is, measures nothing: the tables of the page stay, and its
words are taken from ``page.md``.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from string import Formatter

from tests.benchmarks.pedestrians import corridor, fitted, human, robot
from tests.benchmarks.pedestrians.walks import CASES, KEPT, keep
from tests.benchmarks.reference.kept import source_of

PAGE = Path(__file__).resolve().parents[3] / "skills" / "irsim-benchmark" / "results" / "pedestrians.md"
TEXT = Path(__file__).with_name("page.md")


def measure(data: Path) -> str:
    """Measure everything, keep what the tables are made of, and make the page."""
    walks, options, plan = human.compare(data), fitted.compare(data), robot.plan_of(data)
    result = robot.measure(plan)
    keep([*walks, *(one for rows in options.values() for row in rows for one in (row.known, row.blind))])
    robot.keep(plan, result)
    return TEXT.read_text(encoding="utf-8").format(
        files=human.files_table(data),
        cases=source_of(KEPT, CASES),
        episodes=source_of(robot.KEPT),
        **human.parts(data, walks),
        **fitted.parts(options),
        **corridor.parts(),
        **robot.parts(plan, result),
        **fitted.gains(),
    )


def with_words(shown: str, old: str, new: str) -> str:
    """A page with other words around the same tables.

    Args:
        shown: The page.
        old: Its template.
        new: The template with the other words.
    """
    pattern = "".join(
        re.escape(words) + (f"(?P<{name}>.*?)" if name else "") for words, name, *_ in Formatter().parse(old)
    )
    match = re.fullmatch(pattern, shown, re.DOTALL)
    if match is None:
        raise SystemExit("the page does not have the words of the old template: measure it again")
    return new.format(**match.groupdict())


if __name__ == "__main__" and sys.argv[1] == "--words":
    words = TEXT.read_text(encoding="utf-8")
    before = Path(sys.argv[2]).read_text(encoding="utf-8")
    PAGE.write_text(with_words(PAGE.read_text(encoding="utf-8"), before, words), encoding="utf-8")
elif __name__ == "__main__":
    folder = Path(sys.argv[1])
    print(human.files_table(folder))
    PAGE.write_text(measure(folder), encoding="utf-8")
    print(f"wrote {PAGE}")
