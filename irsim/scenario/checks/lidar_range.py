"""Checks for lidars that see less far than their robot drives until it stands."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres, seconds
from irsim.components.sensors._timing import TimedOptions
from irsim.diagnostics.diagnostic import Path
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, hint
from irsim.scenario.model.actuation import per_control
from irsim.scenario.resolve.body_size import reach_of, top_speed
from irsim.scenario.resolve.braking import braking_of
from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["short_lidar"]


def short_lidar(context: Context, path: Path, sensor: Any, record: ObjectRecord) -> Iterator[Finding]:
    """A lidar whose beams, or whose view of the darkest surface, end before the place where its robot stands.

    Args:
        context: The scenario.
        path: Path of the sensor.
        sensor: A sensor of the object.
        record: The object.
    """
    if not getattr(sensor, "is_lidar", False) or record.static:
        return
    braking = braking_of(record)
    speed = top_speed(record) if braking is None else braking.speed
    if not 0 < speed < math.inf:
        return
    braked = 0.0 if braking is None else braking.distance
    time = _reaction_time(context, sensor, record)
    edge = max(0.0, reach_of(record.shape) - sensor.offset[0])
    needed = edge + speed * time + braked
    others = [other for other in context.resolved.objects if other is not record and not other.unobstructed]
    darkest = min(others, key=lambda other: other.reflectivity, default=None)
    seen = sensor.range_max
    if sensor.realism is not None and darkest is not None:
        seen = sensor.realism.range_of(darkest.reflectivity, seen)
    if not seen < needed < math.inf:  # who brakes by next to nothing needs more than any number
        return
    short = sensor.range_max < needed
    dark = "" if short or darkest is None else f" {darkest.called} (reflectivity {darkest.reflectivity:g}) from"
    longer = f"range_max: {math.ceil(10 * needed) / 10:g} or more" if short else "a larger range_dark of its realism"
    yield hint(
        "lidar-too-short",
        path,
        f"'{record.name}' may need {metres(needed)} to stop from {speed:g} m/s: {metres(speed * time)} until it brakes "
        f"({seconds(time)}), {metres(braked)} while it brakes, {metres(edge)} from the lidar to its edge; the lidar "
        f"sees{dark} {metres(sensor.range_max if short else seen)}",
        given=sensor.range_max if short else None,
        fix=f"{longer}, a lower vel_max, or a larger acce",
    )


def _reaction_time(context: Context, sensor: Any, record: ObjectRecord) -> float:
    """Longest time from the moment when something is in reach to the effect of a command that answers it [s]."""
    time = context.scenario.world.step_time
    if isinstance(sensor, TimedOptions):
        time += sensor.latency + (1.0 / sensor.rate if sensor.rate else 0.0)
    if (options := record.actuation) is not None:
        time += options.command_period
        time += max(per_control(options.delay, record.vel_dim)) + max(per_control(options.lag, record.vel_dim))
    return time
