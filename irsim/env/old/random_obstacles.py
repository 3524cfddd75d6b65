"""Methods of an environment that give its obstacles random poses and outlines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.env.queries import obstacle_list
from irsim.env.state import EnvState
from irsim.objects.shapely_geometry import touching

__all__ = ["random_obstacle_position", "random_polygon_shape"]

MAX_DRAWS = 100
"""Largest number of draws per obstacle; after that, a pose that overlaps another object is accepted."""


def random_obstacle_position(
    env: EnvState,
    range_low: Sequence[float] | Floats | None = None,
    range_high: Sequence[float] | Floats | None = None,
    ids: Iterable[int] | None = None,
    non_overlapping: bool = False,
) -> None:
    """Move obstacles to random poses, to which later resets return.

    Args:
        range_low: Lower bounds of x, y [m] and heading [rad]; by default [0, 0, -3.14].
        range_high: Upper bounds of x, y [m] and heading [rad]; by default [10, 10, 3.14].
        ids: Ids of the obstacles to move; by default all. The map and the walls round the world never move.
        non_overlapping: Draw the pose of an obstacle up to 100 times, until it touches no other object.
    """
    low = np.array([0.0, 0.0, -3.14] if range_low is None else range_low, dtype=np.float64).reshape(3)
    high = np.array([10.0, 10.0, 3.14] if range_high is None else range_high, dtype=np.float64).reshape(3)
    wanted = None if ids is None else set(ids)
    chosen = [o for o in obstacle_list(env) if o.record.path[0] != "world" and (wanted is None or o.id in wanted)]
    standing = [view for view in env._objects if view not in chosen]
    for view in chosen:
        rest = view.state[3:, 0]
        for _ in range(MAX_DRAWS if non_overlapping else 1):
            view.set_state(np.concatenate([env._simulation.rng.uniform(low, high), rest]), init=True)
            if not any(touching(view, other) for other in standing):
                break
        else:
            if non_overlapping:
                env.logger.warning(f"{view.name}: no free place in {MAX_DRAWS} draws; the last one is taken")
        if non_overlapping:
            standing.append(view)


def random_polygon_shape(
    env: EnvState,
    center_range: Sequence[float] | None = None,
    avg_radius_range: Sequence[float] | None = None,
    irregularity_range: Sequence[float] | None = None,
    spikeyness_range: Sequence[float] | None = None,
    num_vertices_range: Sequence[int] | None = None,
) -> None:
    """Give every polygon obstacle a new random outline, without moving it.

    Args:
        center_range: [xmin, ymin, xmax, ymax] of the centre in the body frame [m]; by default [0, 0, 10, 10].
        avg_radius_range: Bounds of the mean radius [m]; by default [0.1, 1].
        irregularity_range: Bounds of the unevenness of the angles between vertices; by default [0, 1].
        spikeyness_range: Bounds of the spread of the radii; by default [0, 1].
        num_vertices_range: Bounds of the number of vertices; by default [4, 10].
    """
    part = core.RandomPolygon(
        center_range=[float(v) for v in center_range or (0, 0, 10, 10)],
        avg_radius_range=[float(v) for v in avg_radius_range or (0.1, 1)],
        irregularity_range=[float(v) for v in irregularity_range or (0, 1)],
        spikeyness_range=[float(v) for v in spikeyness_range or (0, 1)],
        num_vertices_range=[int(v) for v in num_vertices_range or (4, 10)],
        closed=True,
    )
    for view in obstacle_list(env):
        if view.shape == "polygon":
            env._simulation.reshape(view.row, [part], seed=int(env._simulation.rng.integers(2**63)))
