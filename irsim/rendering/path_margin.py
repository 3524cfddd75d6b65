"""The least distance along a path between the footprint of a robot and everything that stands."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from irsim.common.arrays import Floats
from irsim.navigation.clearances import standing_distance

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.rendering.clearance_map import FreeSpace
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = ["PathMargin", "path_margin", "poses_along"]

_MAX_TURN_RAD = 0.1
"""Largest difference between two headings of the footprint at a corner of the path [rad]."""
_MAX_STEERING_RAD = 1.5
"""Largest steering angle of a car that counts [rad]."""
_TOUCHING_M = 1e-3
"""Overlaps up to this depth count as a margin of 0 [m]."""
_MAX_POSES = 4000
"""Largest number of poses at which the footprint is placed."""


class PathMargin(NamedTuple):
    """Where along a path a robot comes nearest to something that stands.

    Attributes:
        distance: Distance between the footprints [m], negative where they overlap; infinity if nothing stands.
        pose: x, y [m] and heading [rad] of the robot there.
        nearest: Name of the other object; None if nothing stands.
    """

    distance: float
    pose: tuple[float, float, float]
    nearest: str | None


def path_margin(simulation: Simulation, view: ObjectView, line: Floats, space: FreeSpace) -> PathMargin:
    """Place the footprint of a robot along a path and find where it is nearest to something that stands.

    The footprint points along the path, except that drives which move in any direction keep their present heading.
    At corners other drives turn on the spot, and a car turns on its smallest circle. The path counts up to
    the place where its last goal is reached; a robot that cannot move has only its present place.

    Args:
        simulation: The simulation, at its present state.
        view: The robot.
        line: (K, 2) corners of the path [m].
        space: Distances to everything that stands.
    """
    poses = poses_along(view, line, space.half_diagonal)
    away = np.hypot(*(poses[:, :2] - line[-1]).T)
    outside = np.flatnonzero(away > view.record.goal_threshold)
    poses = poses[: 1 if view.record.static or not outside.size else int(outside[-1]) + 1]
    distances = space.distance_at(poses[:, :2])
    first = float(poses[0, 0]), float(poses[0, 1]), float(poses[0, 2])
    if not math.isfinite(float(distances.min())):
        return PathMargin(math.inf, first, None)
    reach = 2 * float(simulation.radius[view.row]) + 2 * space.half_diagonal
    poses = poses[distances <= distances.min() + reach]
    poses = poses[:: math.ceil(len(poses) / _MAX_POSES)]
    found, partners = standing_distance(simulation, view, poses)
    if np.isnan(found).all():
        return PathMargin(math.inf, first, None)
    best = int(np.nanargmin(found))
    x, y, heading = poses[best].tolist()
    distance = 0.0 if -_TOUCHING_M < found[best] <= 0 else float(found[best])
    return PathMargin(distance, (x, y, heading), simulation.scenario.objects[int(partners[best])].name)


def poses_along(view: ObjectView, line: Floats, step: float) -> Floats:
    """Return the (P, 3) poses of a robot along a path, at most ``step`` apart [m]."""
    drive = getattr(view.record.kinematics, "name", "")
    heading = float(view.state[2, 0])
    poses = [(float(line[0, 0]), float(line[0, 1]), heading)]
    for a, b in itertools.pairwise(line):
        length = float(np.hypot(*(b - a)))
        if length == 0:
            continue
        ahead = heading if drive.startswith("omni") else math.atan2(b[1] - a[1], b[0] - a[0])
        turn = math.remainder(ahead - heading, math.tau)
        turns = max(1, math.ceil(abs(turn) / _MAX_TURN_RAD))
        poses += [(a[0], a[1], heading + turn * k / turns) for k in range(1, turns)]
        count = max(1, math.ceil(length / step))
        poses += [(*(a + (b - a) * (k / count)), ahead) for k in range(1, count + 1)]
        heading = ahead
    found = np.asarray(poses, dtype=np.float64)
    return _turned_slowly(found, view.record) if drive == "acker" else found


def _turned_slowly(poses: Floats, record: ObjectRecord) -> Floats:
    """Let the heading of a car follow the direction of its path no faster than its smallest turning circle allows.

    The car turns half before and half after a corner: headings are the mean of two passes, ahead and back.
    """
    wheelbase, steering = record.wheelbase or 0.0, min(record.vel_max[1], _MAX_STEERING_RAD)
    curvature = math.tan(steering) / wheelbase if wheelbase > 0 else math.inf
    ahead = _limited(poses, poses[0, 2], curvature)
    back = _limited(poses[::-1], ahead[-1], curvature)[::-1]
    return np.column_stack([poses[:, :2], ahead + np.remainder(back - ahead + np.pi, math.tau) / 2 - np.pi / 2])


def _limited(poses: Floats, heading: float, curvature: float) -> Floats:
    """Headings that follow those of poses, from a first one on, by at most a curvature [1/m]."""
    moved = np.hypot(*np.diff(poses[:, :2], axis=0).T).tolist()
    found = [heading]
    for wanted, length in zip(poses[1:, 2].tolist(), moved, strict=True):
        most = length * curvature if length > 0 else 0.0
        found.append(found[-1] + max(-most, min(most, math.remainder(wanted - found[-1], math.tau))))
    return np.asarray(found, dtype=np.float64)
