"""The card of a SICK LMS beside a real log: how ranges scatter about surfaces, and how far they are from the map."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import irsim
from irsim.bridges.ros.bags.importing import BagOptions, _is_hit, _pose_at, import_bag
from irsim.bridges.ros.bags.reading import read_bag

pytestmark = [pytest.mark.interop, pytest.mark.foreign]
BEAMS = {"name": "lidar2d", "number": 361, "angle_range": 3.14159, "range_min": 0, "range_max": 80}
CARD = {"name": "lidar2d", "device": "lms2xx"}
ANGLES = np.deg2rad(np.arange(361) * 0.5 - 90)


def scans_of(sensor: dict[str, Any], poses: list[Any]) -> np.ndarray:
    """(S, 361) ranges of a lidar in the imported map, at the poses of the log."""
    data = yaml.safe_load(Path("csail.yaml").read_text())
    robot = data["robot"][0]
    robot |= {"behavior": None, "waypoints": None, "goal": None, "sensors": [sensor], "state": [0, 0, 0]}
    Path("still.yaml").write_text(yaml.safe_dump(data))
    env = irsim.make("still.yaml", display=False, log_level="ERROR", seed=0)
    scans = []
    for pose in poses:
        env.robot.set_state(np.array(pose).reshape(3, 1))
        env.refresh()
        scans.append(env.get_lidar_scan(0)["ranges"])
    env.end(0)
    return np.array(scans)


def scatter(scans: np.ndarray, low: float, high: float) -> float:
    """Standard deviation [mm], from the median, of a range about the plane through three beams on either side of it.

    On a plane 1 / r = a cos(angle) + b sin(angle). Beams whose neighbors do not lie on one are left out.
    """
    rests, beside = [], [0, 1, 2, 4, 5, 6]
    for row in scans[::4]:
        for i in range(3, 358):
            near = row[i - 3 : i + 4]
            if not (np.isfinite(near).all() and low <= near.min() and near.max() < high):
                continue
            turn = ANGLES[i - 3 : i + 4] - ANGLES[i]
            sides = np.column_stack([np.cos(turn), np.sin(turn)])[beside]
            plane = np.linalg.lstsq(sides, 1 / near[beside], rcond=None)[0]
            if plane[0] > 0 and np.abs(1 / (sides @ plane) - near[beside]).max() <= 0.08:
                rests.append(near[3] - 1 / plane[0])
    return float(1482.6 * np.median(np.abs(rests - np.median(rests))))


def test_the_card_scatters_as_the_real_lidar_does(foreign: Path, workspace: Path) -> None:
    bag = foreign / "bags" / "csail.bag"
    import_bag(bag, "csail.yaml", BagOptions(resolution=0.025))
    recorded = read_bag(bag, None, None)
    poses = [_pose_at(recorded, time) for time in recorded.scan_times]
    real = np.array([np.where(_is_hit(scan), scan.ranges, np.nan) for scan in recorded.scans])
    expected, card = scans_of(BEAMS, poses), scans_of(CARD, poses)
    rows = {}
    for name, scans in (("real", real), ("card", card)):
        known = np.isfinite(scans) & (expected < 30) & (scans < 30)
        off = 1000 * (scans - expected)[known]
        near = [scatter(scans, low, high) for low, high in ((0.5, 3), (3, 8), (8, 20))]
        rows[name] = [*near, *np.quantile(off, [0.16, 0.5, 0.84]), 100 * np.mean(np.abs(off) < 100)]
        print(name, np.round(rows[name], 1))
    assert rows["card"][:3] == pytest.approx(rows["real"][:3], rel=0.9)  # within a factor of two
    assert all(5 < value < 30 for value in rows["real"][:3] + rows["card"][:3])
    assert rows["real"][6] > 75  # share within 0.1 m of the map, which errs itself
    assert rows["card"][6] > rows["real"][6]
