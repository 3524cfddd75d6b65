"""Lines of a reference: what became of the starts of each group, and who is better on the same starts."""

from __future__ import annotations

import csv
import math
from collections import defaultdict
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from tests.parity.avoidance.families import BEHAVIORS, CASES, groups

__all__ = ["COLUMNS", "FOLDER", "Key", "Outcomes", "Pool", "exact_losses", "pools", "read", "write"]

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


Z95 = 1.959964


@dataclass
class Pool:
    """Starts counted together.

    Attributes:
        starts: Number of starts that both simulators ran.
        ours, peer: Starts that were solved without a contact.
        only_ours, only_peer: Starts that one alone solved.
        contacts, peer_contacts: Starts with a contact, at the end of a step or within one.
        between, peer_between: Contacts within steps.
        seconds: Times of (ours, peer) where both solved a start [s].
    """

    starts: int = 0
    ours: int = 0
    peer: int = 0
    only_ours: int = 0
    only_peer: int = 0
    contacts: int = 0
    peer_contacts: int = 0
    between: int = 0
    peer_between: int = 0
    seconds: list[tuple[float, float]] = field(default_factory=list)

    def add(self, ours: Outcomes, peer: Outcomes, start: int) -> None:
        """Count a start."""
        mine, theirs = ours.success(start), peer.success(start)
        self.starts += 1
        self.ours += mine
        self.peer += theirs
        self.only_ours += mine and not theirs
        self.only_peer += theirs and not mine
        self.contacts += ours.touched(start)
        self.peer_contacts += peer.touched(start)
        self.between += ours.between[start]
        self.peer_between += peer.between[start]
        if mine and theirs:
            self.seconds.append((ours.seconds[start], peer.seconds[start]))

    @property
    def interval(self) -> tuple[float, float, float]:
        """Difference of the rates of success in points, and its paired interval of 95 % (Agresti and Min, 2005)."""
        a, b, n = self.only_ours + 0.5, self.only_peer + 0.5, self.starts + 2
        half = Z95 * math.sqrt(a + b - (a - b) ** 2 / n) / n
        return (
            100 * (self.only_ours - self.only_peer) / self.starts,
            100 * ((a - b) / n - half),
            100 * ((a - b) / n + half),
        )


def pools(
    ours: dict[Key, Outcomes], peer: dict[Key, Outcomes], name: Callable[[Key], tuple[str, ...]]
) -> dict[tuple[str, ...], Pool]:
    """Count the starts of both, those with the same name together."""
    counted: dict[tuple[str, ...], Pool] = defaultdict(Pool)
    for key, mine in ours.items():
        if (theirs := peer.get(key)) is not None:
            for start in range(min(len(mine.letters), len(theirs.letters))):
                counted[name(key)].add(mine, theirs, start)
    return dict(counted)


def exact_losses(ours: dict[Key, Outcomes], peer: dict[Key, Outcomes]) -> list[tuple[Key, str]]:
    """Exact starts that the peer solves and we do not, and what became of ours."""
    drawn = {(case.family, case.name) for case in CASES if case.drawn}
    lost = []
    for key, mine in ours.items():
        if key in peer and peer[key].success(0) and not mine.success(0) and key[3:5] not in drawn:
            lost.append((key, {"c": "contact", "t": "time out", "a": "contact within a step"}[mine.letters[0]]))
    return lost
