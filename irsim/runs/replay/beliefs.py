"""Beliefs of robots, as the replay page reads it: the pose that they decide from, and the tracks of detectors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.runs.replay.drawing import Columns, quantised
from irsim.simulation.trace import Trace, mounted_gauges

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Believers", "believers_of"]


class Believers:
    """Robots that go by an estimate, and detectors, of one simulation.

    Args:
        estimates: Row of each robot that decides from an estimate -> key of the readings that have it.
        detectors: Row of its robot and key of its readings of each detector.
    """

    def __init__(self, estimates: Mapping[int, str], detectors: Sequence[tuple[int, str]]) -> None:
        self.estimates, self.detectors = dict(estimates), list(detectors)

    def known_in(self, trace: Trace) -> Believers:
        """Those whose readings a trace has for all of its rows."""
        known = {key for key, block in trace.readings.items() if len(block) == len(trace)}
        estimates = {row: key for row, key in self.estimates.items() if key in known}
        return Believers(estimates, [(row, key) for row, key in self.detectors if key in known])

    def announce(self, objects: list[dict[str, Any]], first: int) -> dict[str, Any]:
        """Number the tracks of beliefs, which follow the tracks of moving objects; returns entries of the head.

        Args:
            objects: Objects of the page; a robot that goes by an estimate gets the number of its track ``belief``.
            first: Number of the tracks of what moves.
        """
        for number, row in enumerate(self.estimates, first):
            objects[row]["belief"] = number
        return {"detectors": [row for row, _ in self.detectors]} if self.detectors else {}

    def poses(self, trace: Trace) -> Floats:
        """(T, B, 3) poses that they believe to have; without a reading it is the true one, as in their decisions."""
        poses = [np.zeros((len(trace), 0, 3))]
        for row, key in self.estimates.items():
            readings = trace.readings[key]
            told = np.stack([readings["x"], readings["y"], readings["theta"]], axis=1)
            poses.append(np.where(np.isfinite(told[:, :1]), told, trace.pose[:, row])[:, None])
        return np.concatenate(poses, axis=1)

    def add_tracks(self, columns: Columns, trace: Trace, rows: NDArray[np.int64], quantum: float) -> None:
        """Add what detectors report in some rows of a trace.

        ``seen_row`` and ``seen_detector`` say which reading of which detector it is, ``seen_count`` how many tracks it
        has. ``seen_x``, ``seen_y``, ``seen_object`` have the place of each of them in the frame of the robot, and the
        row of the object that it follows, or -1.
        """
        if not self.detectors:
            return
        tables = [np.atleast_2d(trace.readings[key].T).T[rows] for _, key in self.detectors]
        there = [np.isfinite(table["id"]) for table in tables]
        counts = np.stack([one.sum(axis=1) for one in there])
        columns.add("seen_row", np.tile(np.arange(len(rows)), len(tables)), 1)
        columns.add("seen_detector", np.repeat(np.arange(len(tables)), len(rows)), 1)
        columns.add("seen_count", counts.ravel(), 1)
        tracks = np.concatenate([table[one] for table, one in zip(tables, there, strict=True)])
        columns.add("seen_x", quantised(tracks["x"], quantum))
        columns.add("seen_y", quantised(tracks["y"], quantum))
        columns.add("seen_object", tracks["object"].astype(np.int64))

    def most(self, trace: Trace) -> int:
        """About the greatest number of tracks in a row: one of each object, but no more than a detector reports."""
        movers = trace.pose.shape[1]
        return sum(min(movers, trace.readings[key][0].size) for _, key in self.detectors)

    def count(self, trace: Trace) -> int:
        """Mean number of poses and tracks in a row."""
        tracks = sum(int(np.isfinite(trace.readings[key]["id"]).sum()) for _, key in self.detectors)
        return len(self.estimates) + tracks // max(1, len(trace))


def believers_of(simulation: Simulation) -> Believers:
    """The believers of a simulation."""
    records = simulation.scenario.objects
    mounted = mounted_gauges(simulation)
    estimates: dict[int, str] = {}
    for wanted in ("odometry", "localization"):
        # The first one of a kind; localization goes before odometry.
        estimates |= {
            row: key for row, key, sensor in reversed(mounted) if sensor.name == wanted and records[row].estimates
        }
    return Believers(
        dict(sorted(estimates.items())), [(row, key) for row, key, one in mounted if one.table == "tracks"]
    )
