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
    PAGE.write_text(page(folder), encoding="utf-8")
    robot.EPISODES.write_text("\n".join(robot.episodes(robot.plan_of(folder))) + "\n", encoding="utf-8")
    print(f"wrote {PAGE}")
