"""Lines of a reference: what became of the starts of each group."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from tests.avoidance.families import BEHAVIORS, groups

__all__ = ["COLUMNS", "FOLDER", "Key", "Outcomes", "read", "write"]

COLUMNS = ("behavior", "drive", "step", "family", "case", "spelling", "outcomes", "between", "seconds", "depths_um")
FOLDER = Path(__file__).with_name("reference")

Key = tuple[str, ...]
"""Behavior, drive, step, family, case, spelling."""


@dataclass(frozen=True)
class Outcomes:
    """Results of the starts of a group, in their order.

    Attributes:
        letters: ``a`` all robots arrived, ``c`` bodies touch at the end of a step, ``t`` time is up.
        between: Contacts within steps of each start.
        seconds: Time of each outcome [s].
        row: The line itself.
    """

    letters: str
    between: tuple[int, ...]
    seconds: tuple[float, ...]
    row: tuple[str, ...]

    def success(self, start: int) -> bool:
        """Whether all robots arrived in a start without a contact, within steps or at their ends."""
        return self.letters[start] == "a" and self.between[start] == 0

    def touched(self, start: int) -> bool:
        """Whether a robot touched anything in a start."""
        return self.letters[start] == "c" or self.between[start] > 0


def read(files: Iterable[Path]) -> dict[Key, Outcomes]:
    """The lines of several files; of two lines of a group the one with more starts counts."""
    outcomes: dict[Key, Outcomes] = {}
    for file in files:
        with file.open(encoding="utf-8", newline="") as opened:
            for row in csv.reader(opened):
                key = tuple(row[:6])
                if row[0] != COLUMNS[0] and (key not in outcomes or len(outcomes[key].letters) < len(row[6])):
                    between, seconds = tuple(map(int, row[7].split())), tuple(map(float, row[8].split()))
                    outcomes[key] = Outcomes(row[6], between, seconds, tuple(row))
    return outcomes


def write(file: Path, outcomes: dict[Key, Outcomes]) -> None:
    """Write lines in the order of the families."""
    with file.open("w", encoding="utf-8", newline="") as opened:
        writer = csv.writer(opened, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(outcomes[group.key].row for group in groups(BEHAVIORS) if group.key in outcomes)
