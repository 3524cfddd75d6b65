"""Checks that objects have the sensors which they decide from."""

from __future__ import annotations

from collections.abc import Iterator

from irsim.components.sensors.detector import Detector
from irsim.components.sensors.localization import Localization
from irsim.components.sensors.odometry import Odometry
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.messages.findings import Finding, error
from irsim.scenario.resolve.resolved import ObjectRecord


def check(context: Context) -> Iterator[Finding]:
    """Check all objects; one finding per path and code."""
    yield from distinct(finding for record in context.entry_objects for finding in _of_object(context, record))


def _of_object(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    needs = (
        (record.estimates, (Localization, Odometry), "localization", "an estimate of its pose"),
        (record.follows_tracks, (Detector,), "detector", "tracks of other objects"),
    )
    for needed, kinds, name, what in needs:
        if not needed or any(isinstance(sensor, kinds) for sensor in record.sensors):
            continue
        yield error(
            "perceives-without-sensor",
            context.entry_path(record, "perceives"),
            f"'{record.name}' decides from {what}, and has no sensor that reports it",
            given=record.perceives,
            fix=f"add {{name: {name}}} to its sensors, or write 'perceives: truth'",
        )
