"""Sensors and fields of view."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from irsim.scenario.checks._context import Context
from irsim.scenario.findings import Finding, error, hint


def check(context: Context) -> Iterator[Finding]:
    """By entry."""
    for path, entry, records in context.entries():
        seen = set()
        for record in records:
            where = context.entry_path(record, "sensors")
            if where in seen:
                continue
            seen.add(where)
            for index, sensor in enumerate(record.sensors):
                yield from _sensor(context, (*where, index), sensor)
        if not records:
            continue
        lidar = next((s for s in records[0].sensors if getattr(s, "is_lidar", False)), None)
        if entry.fov is None and entry.fov_radius is not None:
            reach = "the lidar's range_max is used" if lidar is not None else "there is no field of view"
            yield hint(
                "fov-radius-ignored",
                (*path, "fov_radius"),
                f"without 'fov' this radius does not count: {reach}",
                fix="add 'fov' (radians)",
            )
        if entry.fov is not None and entry.fov_radius is None and lidar is None:
            yield hint("fov-without-radius", (*path, "fov"), "without 'fov_radius' nothing is in view", fix="add it")


def _sensor(context: Context, path: Any, sensor: Any) -> Iterator[Finding]:
    if getattr(sensor, "is_lidar", False) and sensor.range_min >= sensor.range_max:
        written = "range_min" if "range_min" in sensor.model_fields_set else "range_max"
        yield error(
            "range-order",
            (*path, written),
            f"range_min {sensor.range_min:g} is not below range_max {sensor.range_max:g}",
            given=getattr(sensor, written),
            fix="range_min must be smaller than range_max",
        )
    if sensor.name == "contact2d" and context.scenario.world.collision_mode != "contact":
        yield hint("contact-without-mode", path, "there are no contact forces without 'collision_mode: contact'")
