"""The tables of ``policies_of_the_paper.md``, made of episodes, and their places on the page."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from irsim.metrics.statistics import wilson
from tests.benchmarks.authors_circle import shares

__all__ = [
    "AUTHORS_SEEDS",
    "CELLS_OF",
    "Circle",
    "authors_table",
    "beside_table",
    "cells_of",
    "circle_table",
    "crowded_table",
    "full_table",
    "on_page",
    "put_on_page",
    "shares_table",
]

Row = Mapping[str, str]
"""A line of a kept file."""
ROBOTS = (5, 10, 15, 20, 25)
PROTOCOLS = ("freeze", "yield")
POLICIES = ("orca", "avocado", "sarl_multi_robot", "rl_rvo", "ppo", "ppo_freeze", "footprint_orca")
FULL_POLICIES = ("orca", "avocado", "rl_rvo", "sarl_multi_robot", "ppo", "ppo_freeze", "footprint_orca")
"""The order of columns in the table of 1,000 episodes."""
AUTHORS_SEEDS = range(100, 160)
"""Seeds of the table of the authors' weights."""
CELLS_OF = {"shares": 2, "full": 2, "crowded": 1, "beside": 2, "authors": 1, "circle": 2}
"""Table -> number of its first columns, which name a row."""
_QUOTED = {"beside": 1, "authors": 1}
"""Table -> number of the columns after them, which repeat the paper."""
_NAMES = {"ppo": "PPO (`multi_robot`)", "ppo_freeze": "PPO (`multi_robot_freeze`)"}
_KINDS = ("success", "collision", "timeout")


class Published(NamedTuple):
    """A row of the paper: shares in %, time [s], speed [m/s] and path [m]."""

    name: str
    shares: str
    time: float
    speed: float
    path: float


PAPER = {
    (5, "orca"): Published("ORCA", "97/2/1", 5.00, 0.91, 4.61),
    (5, "avocado"): Published("AVOCADO", "98/0/2", 5.41, 0.81, 4.56),
    (5, "sarl_multi_robot"): Published("SARL", "90/1/9", 10.47, 0.64, 6.42),
    (5, "rl_rvo"): Published("RL-RVO", "86/11/3", 5.78, 0.85, 4.97),
    (10, "orca"): Published("ORCA", "86/8/6", 5.09, 0.88, 4.14),
    (10, "avocado"): Published("AVOCADO", "95/0/5", 5.61, 0.79, 4.58),
    (10, "sarl_multi_robot"): Published("SARL", "89/8/3", 8.90, 0.66, 5.78),
    (10, "rl_rvo"): Published("RL-RVO", "79/14/7", 6.99, 0.78, 5.42),
}
"""(robots, policy) -> Tables 1 and 2 of the paper."""


class Circle(NamedTuple):
    """Outcomes on the authors' circle: robots, margin [m], whether right turns are limited, and a letter per seed."""

    robots: int
    margin: float
    limited: bool
    outcomes: str


def _outcomes(rows: Sequence[Row], robots: int, protocol: str, policy: str) -> list[Row]:
    """The episodes of a cell in which there was room for all robots."""
    cell = (f"robots-{robots}/{protocol}", policy)
    chosen = [row for row in rows if (row["scenario"], row["policy"]) == cell and row["outcome"] in _KINDS]
    if not chosen:
        raise LookupError(f"there is no episode of {policy} in {cell[0]}")
    return chosen


def _shares(rows: Sequence[Row]) -> str:
    """Success / collision / timeout in %."""
    counts = Counter(row["outcome"] for row in rows)
    return "/".join(f"{100 * counts[kind] / len(rows):.0f}" for kind in _KINDS)


def _mean(rows: Sequence[Row], metric: str) -> float:
    values = [float(row[metric]) for row in rows if row[metric]]
    return sum(values) / len(values)


def _success(rows: Sequence[Row]) -> tuple[float, float, float]:
    """The share of success and its 95 % interval, in %."""
    count = sum(row["outcome"] == "success" for row in rows)
    low, high = wilson(count, len(rows))
    return 100 * count / len(rows), 100 * low, 100 * high


def _with_interval(rows: Sequence[Row]) -> str:
    """The share of success and its interval in %, so precisely that an interval is not empty."""
    share, low, high = _success(rows)
    return f"{share:.1f} [{low:.1f}, {high:.1f}]"


def _name(policy: str) -> str:
    return _NAMES.get(policy, f"`{policy}`")


def shares_table(rows: Sequence[Row]) -> str:
    """Shares of all policies, protocols and numbers of robots."""
    lines = [f"| protocol | policy | {' | '.join(map(str, ROBOTS))} robots |", "|---|---|---|---|---|---|---|"]
    for protocol in PROTOCOLS:
        for policy in POLICIES:
            cells = [_shares(_outcomes(rows, robots, protocol, policy)) for robots in ROBOTS]
            lines.append(f"| {protocol} | {_name(policy)} | {' | '.join(cells)} |")
    return "\n".join(lines)


def full_table(rows: Sequence[Row]) -> str:
    """Success with intervals, of 5 and 10 robots."""
    lines = [f"| protocol | robots | {' | '.join(map(_name, FULL_POLICIES))} |", f"|{'---|' * 9}"]
    for protocol in PROTOCOLS:
        for robots in ROBOTS[:2]:
            cells = [_with_interval(_outcomes(rows, robots, protocol, policy)) for policy in FULL_POLICIES]
            lines.append(f"| {protocol} | {robots} | {' | '.join(cells)} |")
    return "\n".join(lines)


def crowded_table(rows: Sequence[Row]) -> str:
    """Success with intervals, and shares of collisions, of ``footprint_orca`` with more robots."""
    lines = [f"| protocol | {' | '.join(map(str, ROBOTS[2:]))} robots | collisions |", f"|{'---|' * 5}"]
    for protocol in PROTOCOLS:
        own = [_outcomes(rows, robots, protocol, "footprint_orca") for robots in ROBOTS[2:]]
        touched = sum(row["outcome"] == "collision" for cell in own for row in cell)
        cells = [*map(_with_interval, own), f"{touched} of {sum(map(len, own)):,}"]
        lines.append(f"| {protocol} | {' | '.join(cells)} |")
    return "\n".join(lines)


def beside_table(rows: Sequence[Row]) -> str:
    """The rows of the paper, beside our results with the same number of robots."""
    lines = [
        "| robots | policy | paper: S/C/T, time, speed, path | here, freeze | here, yield |",
        "|---|---|---|---|---|",
    ]
    for (robots, policy), paper in PAPER.items():
        cells = [f"{paper.shares}, {paper.time:.2f} s, {paper.speed:.2f} m/s, {paper.path:.2f} m"]
        for protocol in PROTOCOLS:
            own = _outcomes(rows, robots, protocol, policy)
            time, speed, path = (_mean(own, key) for key in ("time_to_goal", "velocity_avg", "path_length"))
            cells.append(f"{_shares(own)}, {time:.2f} s, {speed:.2f}, {path:.2f}")
        lines.append(f"| {robots} | {paper.name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def authors_table(rows: Sequence[Row]) -> str:
    """The authors' weights beside the paper and the weights that were trained anew.

    Args:
        rows: Episodes of ``rl_rvo_authors`` and of ``rl_rvo``.
    """
    lines = ["| robots | paper | RL-RVO, authors' weights | `rl_rvo`, the same seeds |", "|---|---|---|---|"]
    chosen = [row for row in rows if int(row["seed"]) in AUTHORS_SEEDS]
    for robots in ROBOTS[:2]:
        paper, cells = PAPER[robots, "rl_rvo"], []
        for policy, word in (("rl_rvo_authors", "success "), ("rl_rvo", "")):
            own = _outcomes(chosen, robots, "freeze", policy)
            _, low, high = _success(own)
            speed = _mean(own, "velocity_avg")
            cells.append(f"{_shares(own)} ({word}{low:.0f} to {high:.0f}), {speed:.2f} m/s")
        lines.append(f"| {robots} | {paper.shares}, {paper.speed:.2f} m/s | {' | '.join(cells)} |")
    return "\n".join(lines)


def circle_table(rows: Sequence[Circle]) -> str:
    """The authors' circle, with and without the limit of right turns."""
    lines = ["| robots | margin | right turns limited | not limited |", "|---|---|---|---|"]
    made = {(row.robots, row.margin, row.limited): shares(row.outcomes) for row in rows}
    for robots, margin in dict.fromkeys((row.robots, row.margin) for row in rows):
        cells = " | ".join(made[robots, margin, limited] for limited in (True, False))
        lines.append(f"| {robots} | {margin} m | {cells} |")
    return "\n".join(lines)


def cells_of(name: str, table: str) -> Iterator[tuple[str, str]]:
    """The cells of a table that come from episodes: name of the row and of the column, and text.

    Args:
        name: Name of the table.
        table: Its text.
    """
    head, _, *lines = (line.strip("| ").split(" | ") for line in table.splitlines())
    known = CELLS_OF[name]
    for line in lines:
        for column, cell in list(zip(head, line, strict=True))[known + _QUOTED.get(name, 0) :]:
            yield f"{', '.join(line[:known])}, {column}", cell


def _marks(name: str) -> tuple[str, str]:
    return f"<!-- begin {name} -->\n", f"\n<!-- end {name} -->"


def on_page(page: str, name: str) -> str:
    """The text of a table on the page."""
    begin, end = map(re.escape, _marks(name))
    [table] = re.findall(f"{begin}(.*?){end}", page, re.DOTALL)
    return str(table)


def put_on_page(page: str, name: str, table: str) -> str:
    """The page with another text of a table."""
    return page.replace(on_page(page, name).join(_marks(name)), table.join(_marks(name)))
