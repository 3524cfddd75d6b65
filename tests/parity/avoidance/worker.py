"""Runs groups of starts in the interpreter that has the simulator; needs that simulator, NumPy, PyYAML and Pillow only.

python worker.py RESULTS [--share K/N] [--behaviors a,b]     appends lines to RESULTS for groups that are not in it
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import logging
import os
import sys
import tempfile
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

ROOT = Path(__file__).resolve().parents[3]
if __name__ == "__main__":
    # The interpreter's own irsim is imported first: the folder of this repository holds one, too.
    sys.path[0] = tempfile.gettempdir()
    import irsim

    sys.path.insert(0, str(ROOT))
else:
    import irsim

from tests.parity.avoidance.families import CELL_M, RADIUS_M, SIZE_M, THRESHOLD_M, Group, groups, layout, scenario  # noqa: E402
from tests.parity.avoidance.judge import Judge, Verdict, at_rest  # noqa: E402

COLUMNS = ("behavior", "drive", "step", "family", "case", "spelling", "outcomes", "between", "seconds", "depths_um")
DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
Places = NDArray[np.float64]
OURS = hasattr(irsim, "batch")
CHUNK = 10
"""Steps between two looks of the judge, who sees every step of them."""


def run(group: Group, start: int, folder: Path) -> Verdict:
    """Run one start and judge it."""
    scene, file = layout(group.case, start), write_start(group, start, folder)
    judge = Judge(
        goals=[robot.goal for robot in scene.robots],
        walls=[wall.outline() for wall in scene.walls],
        radius=RADIUS_M,
        threshold=THRESHOLD_M,
        dt=group.dt,
        loop=group.case.loop,
    )
    steps = round(group.case.limit_s / group.dt)
    motion = (_ours if OURS else _peer)(file, len(scene.robots))
    path, begun = [next(motion)], 0
    for k in range(1, steps + 1):
        path.append(next(motion))
        if k % CHUNK and k != steps:
            continue
        if judge.ended(path[begun:]) or at_rest(path, group.dt):
            break
        begun = k
    motion.close()
    return judge.verdict(path)


def write_start(group: Group, start: int, folder: Path) -> Path:
    """Write the scenario of a start into a folder, and the picture of its map beside it."""
    picture, file = _picture(group, folder) if group.spelling == "map" else "", folder / "start.yaml"
    text = yaml.dump(scenario(group, start, picture), Dumper=DUMPER, sort_keys=False)
    file.write_text(text, encoding="utf-8")
    return file


def _ours(file: Path, count: int) -> Iterator[Places]:
    """Positions of the robots, before and after each step."""
    batch = irsim.batch(file, 1, seeds=[0], threads=1)
    while True:
        yield batch.pose[0, :count, :2].copy()
        batch.step()


def _peer(file: Path, count: int) -> Iterator[Places]:
    """The same of another simulator."""
    env = irsim.make(str(file), display=False, disable_all_plot=True, log_level="ERROR")
    robots = env.robot_list
    if len(robots) != count:
        raise RuntimeError(f"{file.name} has {len(robots)} robots instead of {count}")
    try:
        while True:
            yield np.array([robot.state[:2, 0] for robot in robots])
            env.step()
    finally:
        env.end(0)


def _picture(group: Group, folder: Path) -> str:
    """Write the walls of a case as the picture of a map, black on white, and return its file."""
    file = folder / f"{group.case.family} {group.case.name}.png".replace(" ", "-")
    if not file.exists():
        cells = round(SIZE_M / CELL_M)
        grid = np.full((cells, cells), 255, dtype=np.uint8)  # rows from the top, columns along x
        for wall in layout(group.case, 0).walls:
            for x, y, length, width in wall.parts:
                left, right = (wall.place[0] + x + side * length / 2 for side in (-1, 1))
                low, high = (wall.place[1] + y + side * width / 2 for side in (-1, 1))
                rows = slice(cells - round(high / CELL_M), cells - round(low / CELL_M))
                grid[rows, round(left / CELL_M) : round(right / CELL_M)] = 0
        Image.fromarray(grid).save(file)
    return str(file)


def line(group: Group, folder: Path, starts: int | None = None, known: Sequence[str] = ()) -> list[str]:
    """The line of a reference: the outcomes, one letter each, and what else was counted, start by start.

    Args:
        group: The group to run.
        folder: Folder for its files.
        starts: Number of starts, from the exact one on; None for all.
        known: A line with the first of these starts, which are not run again.
    """
    begun = len(known[6]) if known else 0
    verdicts = [run(group, start, folder) for start in group.starts[begun:starts]]
    counted = [
        [f"{verdict.between}" for verdict in verdicts],
        [f"{verdict.seconds:g}" for verdict in verdicts],
        [f"{verdict.depth_m * 1e6:.0f}" for verdict in verdicts],
    ]
    before = [text.split() for text in known[7:]] if known else [[], [], []]
    letters = (known[6] if known else "") + "".join(verdict.outcome for verdict in verdicts)
    return [*group.key, letters, *(" ".join(old + new) for old, new in zip(before, counted, strict=True))]


def main(arguments: list[str]) -> None:
    """Append lines for the groups of which a file of results has no line, or one with fewer starts."""
    parser = argparse.ArgumentParser()
    parser.add_argument("results", type=Path)
    parser.add_argument("--behaviors", default="rvo,sfm,orca")
    parser.add_argument("--share", default="0/1", help="K/N: each N-th group, from the K-th")
    parser.add_argument("--starts", type=int, help="the first starts of each group only: 1 for the exact ones")
    given = parser.parse_args(arguments)
    known: dict[tuple[str, ...], list[str]] = {}
    if given.results.exists():
        with given.results.open(encoding="utf-8", newline="") as opened:
            known = {tuple(row[:6]): row for row in csv.reader(opened)}
    part, parts = map(int, given.share.split("/"))
    with (
        tempfile.TemporaryDirectory() as folder,
        given.results.open("a", encoding="utf-8", newline="") as opened,
        open(os.devnull, "w", encoding="utf-8") as silence,
    ):
        writer = csv.writer(opened, lineterminator="\n")
        for group in groups(tuple(given.behaviors.split(",")))[part::parts]:
            before = known.get(group.key, [])
            if before and len(before[6]) >= len(group.starts[: given.starts]):
                continue
            with contextlib.redirect_stdout(silence), contextlib.redirect_stderr(silence):
                row = line(group, Path(folder), given.starts, before)
            writer.writerow(row)
            opened.flush()


if __name__ == "__main__":
    logging.disable(logging.CRITICAL)
    warnings.simplefilter("ignore")
    os.environ["MPLBACKEND"] = "Agg"
    # Another simulator writes arrays into unused messages, which takes a third of its time.
    np._core.arrayprint._default_array_str = lambda array: "array"
    main(sys.argv[1:])
