"""Layouts: which parts of observations a policy sees, in which order."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.options.base import Options, problem
from irsim.options.selection import Select
from irsim.policies.networks.parts._options import PARTS, PartOptions
from irsim.policies.networks.values import Shape, Value
from irsim.policies.observations import Map, Observations
from irsim.policies.policy import Needs

__all__ = ["LAYOUT_VERSION", "Layout", "layout_bounds", "layout_needs", "layout_shapes", "observe"]

LAYOUT_VERSION = 1
"""Raised whenever a part gives other numbers for the same options."""


class Layout(Options):
    """The parts that a policy observes."""

    version: Literal[1] = 1
    """Version of the meaning of the parts."""
    parts: Annotated[list[Annotated[PartOptions, Select(PARTS)]], Field(min_length=1, max_length=32)]
    """The parts."""

    @model_validator(mode="after")
    def _fits_together(self) -> Layout:
        labels = [part.key for part in self.parts]
        twice = next((label for label in labels if labels.count(label) > 1), None)
        if twice is not None:
            raise problem("invalid-value", f"two parts are called '{twice}'", fix="give one of them another label")
        if len({part.needs().static_neighbors for part in self.parts if part.needs().neighbors}) > 1:
            raise problem("invalid-value", "'static' differs between two parts of neighbors", fix="give both the same")
        return self

    @cached_property
    def kernels(self) -> tuple[Any | None, ...]:
        """The options of each part for the core; None for a part that a Python function computes."""
        return tuple(_kernel(part) for part in self.parts)


def _kernel(part: PartOptions) -> Any | None:
    feature = PARTS.get(part.name)
    kernel = None if feature is None else feature.kernel
    return None if kernel is None else kernel(**{name: getattr(part, name) for name in kernel.fields})


def layout_needs(layout: Layout) -> Needs:
    """Observations of a policy with this layout: enough for every part."""
    needs = [part.needs() for part in layout.parts]
    seeing = [need for need in needs if need.neighbors]
    return Needs(
        neighbors=max((need.neighbors for need in needs), default=0),
        neighbor_range=max((need.neighbor_range for need in seeing), default=float("inf")),
        static_neighbors=any(need.static_neighbors for need in needs),
        neighbor_extents=any(need.neighbor_extents for need in needs),
        scan=any(need.scan for need in needs),
        map=any(need.map for need in needs),
        map_resolution=min((need.map_resolution for need in needs if need.map), default=Needs.map_resolution),
    )


def layout_shapes(layout: Layout) -> dict[str, Shape]:
    """Shape of each part, by its label."""
    return {part.key: Shape(len(part.channels()), part.members) for part in layout.parts}


def layout_bounds(layout: Layout) -> dict[str, tuple[Floats, Floats]]:
    """Lower and upper bounds of each part, (F,) or (K, F), by its label: for spaces of learning libraries."""
    bounds = {}
    for part in layout.parts:
        low, high = (np.array([channel[side] for channel in part.channels()], dtype=np.float64) for side in (1, 2))
        if part.members is not None:  # absent members hold zeros
            size = (part.members, len(low))
            low, high = (np.broadcast_to(b, size).copy() for b in (np.minimum(low, 0.0), np.maximum(high, 0.0)))
        bounds[part.key] = (low, high)
    return bounds


def observe(layout: Layout, observations: Observations) -> dict[str, Value]:
    """The parts of what B robots observe, by their labels.

    Args:
        layout: The parts.
        observations: Observations with :func:`layout_needs`.

    Returns:
        (B, F) vectors and (B, K, F) sets of float64.

    Raises:
        PolicyInputError: Something that a part needs is not observed.
    """
    rows = _seen_rows(observations)
    result = {}
    for part, kernel in zip(layout.parts, layout.kernels, strict=True):
        part.check(observations)
        if kernel is None:
            feature = PARTS.get(part.name)
            assert feature is not None
            assert feature.function is not None, "the registry refuses parts that nothing computes"
            result[part.key] = feature.function(observations, part)
        else:
            array, mask = core.look(kernel, rows)
            result[part.key] = Value(array, None if mask is None else mask.view(bool))
    return result


def _seen_rows(observations: Observations) -> core.SeenRows:
    """Observations of B robots, as the kernels of observation parts take them."""
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
