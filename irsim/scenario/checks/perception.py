"""Checks that objects have the sensors which they decide from, and that these are good enough to arrive."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres
from irsim.components.sensors.detector import Detector
from irsim.components.sensors.localization import Localization
from irsim.components.sensors.odometry import Odometry
from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.resolve.body_size import SizedBody, SizedShape
from irsim.scenario.resolve.odometry_drift import Drift, Slippage, drift_of
from irsim.scenario.resolve.resolved import ObjectRecord


def check(context: Context) -> Iterator[Finding]:
    """Check all objects; one finding per path and code."""
    yield from distinct(finding for record in context.entry_objects for finding in _of_object(context, record))


def _of_object(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    path = context.entry_path(record, "perceives")
    if record.perceives != "truth" and (why := context.why_undriven(record)) is not None:
        yield warning(
            "perceives-unused",
            path,
            f"'{record.name}' {why}, so nothing decides from what it perceives",
            given=record.perceives,
            fix="remove 'perceives'",
            edit=Edit("remove", path) if path[-1] == "perceives" else None,
        )
        return
    needs = (
        (record.estimates, (Localization, Odometry), "localization", "an estimate of its pose"),
        (record.follows_tracks, (Detector,), "detector", "tracks of other objects"),
    )
    for needed, kinds, name, what in needs:
        if not needed or any(isinstance(sensor, kinds) for sensor in record.sensors):
            continue
        yield error(
            "perceives-without-sensor",
            path,
            f"'{record.name}' decides from {what}, and has no sensor that reports it",
            given=record.perceives,
            fix=f"add {{name: {name}}} to its sensors, or write 'perceives: truth'",
        )
    if record.estimates and not any(isinstance(sensor, Localization) for sensor in record.sensors):
        yield from _drifts(context, record)


def _drifts(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    """Odometry that is farther off at the goal than the goal is wide."""
    place = next((k for k, sensor in enumerate(record.sensors) if isinstance(sensor, Odometry)), None)
    placed = any(record.id in placement.objects for placement in context.resolved.placements)
    if place is None or placed or not record.goals or record.wander:
        return
    sensor: Any = record.sensors[place]
    legs = SizedBody(record, SizedShape(record.shape)).legs
    sideways = getattr(record.kinematics, "speeds", 1) == 2
    drift = drift_of(sensor, legs, None if sideways else record.state[2], _slippage(context, record, sensor))
    if not drift.error > record.goal_threshold:
        return
    worst = max(drift.parts, key=drift.parts.__getitem__)
    way = sum(math.dist(a, b) for a, b in legs)
    yield hint(
        "odometry-drifts",
        (*context.entry_path(record, "sensors"), place),
        f"'{record.name}' goes by its odometry alone, which is off by {metres(min(drift.error, way))} (root mean "
        f"square) after {metres(way)} of way, mostly by {worst}; its goal_threshold is {metres(record.goal_threshold)}",
        fix="add {name: localization} to its sensors" + _smaller(sensor, drift, worst, record.goal_threshold),
    )


def _slippage(context: Context, record: ObjectRecord, sensor: Odometry) -> Slippage | None:
    """The ground on the way of an object; None if its wheels do not slip."""
    world, drive = context.resolved.world, record.kinematics
    if not world.has_grounds or "slip" not in getattr(drive, "feels", ()):
        return None
    fastest = record.vel_max[0] if record.vel_max and math.isfinite(record.vel_max[0]) else 0.0
    beside = (getattr(drive, "track", None) or sensor.track) if hasattr(drive, "track") else None
    return Slippage(world.zones, max(fastest, 0.1), beside, world.step_time)


def _smaller(sensor: Odometry, drift: Drift, key: str, threshold: float) -> str:
    """The value of the worst key with which the error is the threshold, if that key alone can do it."""
    if key not in type(sensor).model_fields:
        return ""  # it is the ground, not the sensor
    others = drift.error**2 - drift.parts[key] ** 2
    if not 0 <= others < threshold**2:
        return ""
    value = getattr(sensor, key) * math.sqrt(threshold**2 - others) / drift.parts[key]
    digits = 1 - math.floor(math.log10(abs(value)))
    value = math.copysign(math.floor(abs(value) * 10**digits) / 10**digits, value)
    return f", or write {key}: {value:g}"
