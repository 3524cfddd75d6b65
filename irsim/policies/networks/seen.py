"""What robots observe, as the kernels of observation parts take it."""

from __future__ import annotations

import numpy as np

import irsim._core as core
from irsim.policies.observations import Map, Observations

__all__ = ["seen_rows"]


def seen_rows(observations: Observations) -> core.SeenRows:
    """The arrays of B robots for the core."""
    o, flag = observations, np.uint8
    rows = core.SeenRows(
        pose=o.pose,
        steering=o.steering,
        velocity=o.velocity,
        commanded=np.zeros_like(o.velocity) if o.commanded is None else o.commanded,
        yaw_rate=o.yaw_rate,
        control=o.control,
        low=o.low,
        high=o.high,
        goal=o.goal,
        goal_threshold=o.goal_threshold,
        radius=o.radius,
        arrived=o.arrived.astype(flag),
    )
    if (n := o.neighbors) is not None:
        arrived, robot = n.arrived.astype(flag), n.robot.astype(flag)
        zeros = np.zeros(n.mask.shape)
        extent = zeros if n.extent is None else n.extent
        own = zeros if n.own_extent is None else n.own_extent
        mask = n.mask.astype(flag)
        rows.set_neighbors(mask, n.position, n.heading, n.velocity, n.radius, arrived, robot, extent, own)
    if o.scan is not None:
        rows.set_scan(o.scan.ranges, o.scan.range_max)
    if o.maps is not None:
        distinct: dict[int, tuple[int, Map]] = {}  # rows of one world share their map
        for seen in o.maps:
            distinct.setdefault(id(seen), (len(distinct), seen))
        pictures = [(seen.occupied.astype(flag), seen.origin, seen.resolution) for _, seen in distinct.values()]
        rows.set_pictures(pictures, [distinct[id(seen)][0] for seen in o.maps])
    return rows
