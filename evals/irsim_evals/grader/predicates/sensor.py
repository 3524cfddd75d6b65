"""``sensor``: every body of a selection carries a sensor with some parameters."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from irsim_evals.grader.matching import Kind, Match, matches, show
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene

KINDS: dict[str, Kind] = {
    "name": "name",
    "number": "count",
    "range_max": "length",
    "range_min": "size",
    "angle_range": "angle",
    "direction": "heading",
    "mounted": "length",
    "noise": "flag",
    "std": "size",
    "angle_std": "angle",
    "has_velocity": "flag",
    "motion_compensate": "flag",
    "velocity_noise_std": "size",
    "spacing": "angle",
}
"""Parameter → what it measures."""


@register("sensor")
class Sensor(ScenePredicate):
    """Every body of a selection has sensors with some parameters. An empty selection fails."""

    of: str
    """Name of the selection."""
    has: dict[str, Match] = {}
    """Parameter of the sensor as the simulator holds it → accepted values. ``direction`` is where its middle beam
    points relative to the body, ``mounted`` how far it sits from the origin of the body, ``spacing`` the angle between
    two beams."""
    number: Match = Match(eq=1)
    """How many sensors of each body have them."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Look at the sensors of each body."""
        bodies = material.bodies(scene, self.of)
        words = ", ".join(f"{name} {match.words()}" for name, match in self.has.items()) or "sensors"
        expected = f"{self.of}: {self.number.words()} with {words}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        for body in bodies:
            fit = [sensor for sensor in body.sensors if self._fits(sensor)]
            if not matches(self.number, len(fit), "count"):
                seen = "; ".join(
                    ", ".join(f"{key} {show(parameter(sensor, key))}" for key in self.has) for sensor in body.sensors
                )
                return Observation(
                    False, expected, f"{body.name}: {len(fit)}, sensors: {seen or 'none'}", f"{body.entry}.sensors"
                )
        return Observation(True, expected, f"all {len(bodies)}")

    def _fits(self, sensor: dict[str, Any]) -> bool:
        return all(matches(match, parameter(sensor, key), KINDS.get(key, "name")) for key, match in self.has.items())


def parameter(sensor: dict[str, Any], key: str) -> Any:
    """A parameter of a sensor; None if it has no such parameter."""
    offset = sensor.get("offset") or [0.0, 0.0, 0.0]
    if key == "mounted":
        return math.hypot(*offset[:2])
    if key == "direction":
        return float(offset[2]) if len(offset) > 2 else 0.0
    if key == "spacing":
        number, angle = sensor.get("number"), sensor.get("angle_range")
        return None if not number or number < 2 or angle is None else angle / (number - 1)
    value = sensor.get(key)
    return math.nan if value is None and key in ("range_max",) else value
