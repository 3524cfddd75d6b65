"""Properties of bodies: how many there are, with which values and sensors; and a body for each row of a table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any

import shapely

from irsim.common.arguments import is_number
from irsim.options.registry import SENSORS
from irsim_evals.grader.hues import discernible
from irsim_evals.grader.matching import Kind, Match, Quantity, checked, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, OfBodies, ScenePredicate, register, summary
from irsim_evals.grader.properties import PROPERTIES, Having, PropertyName, value_of, yaml_path
from irsim_evals.grader.words import OneOf

if TYPE_CHECKING:
    from irsim_evals.grader.body import GradedBody
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

SENSOR_KINDS: dict[str, Kind] = {
    "name": "name", "number": "count", "range_max": "length", "range_min": "size", "angle_range": "angle",
    "direction": "heading", "mounted": "length", "noise": "flag", "std": "size", "angle_std": "angle",
    "has_velocity": "flag", "motion_compensate": "flag", "velocity_noise_std": "size", "spacing": "angle",
}  # fmt: skip
"""Parameter → what it measures."""
_KEYS = {key for name in SENSORS.installed() if (one := SENSORS.get(name)) for key in one.options.model_fields}
SensorKey = Annotated[str, OneOf("parameter of a sensor", (*SENSOR_KINDS, *sorted(_KEYS - {*SENSOR_KINDS})))]
"""Parameter of a sensor."""


@register("count")
class Count(OfBodies, ScenePredicate):
    """How many bodies a selection holds, and how crowded the world is with them: one of both measures is enough."""

    number: Match
    """Accepted numbers."""
    cover: Match | None = None
    """Accepted shares of the world's area that they cover."""
    per_10_m2: Match | None = None
    """Accepted numbers for each 10 m² of the world."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Count them, and add up their areas if that is asked for."""
        bodies = material.bodies(scene, self.of)
        passed = matches(self.number, len(bodies), "count")
        expected, observed = f"{self.of}: {self.number.words()}", f"{self.of}: {len(bodies)}"
        if self.cover is None and self.per_10_m2 is None:
            return Observation(passed, expected, observed)
        area = shapely.box(*scene.bounds).area
        covered = shapely.union_all([body.footprint for body in bodies]).area / area
        asked = [(self.cover, covered, "of the area"), (self.per_10_m2, 10 * len(bodies) / area, "for each 10 m²")]
        crowded = [(match, value, what) for match, value, what in asked if match is not None]
        expected += ", " + " or ".join(f"{match.words()} {what}" for match, _, what in crowded)
        observed += "".join(f", {show(value)} {what}" for _, value, what in crowded)
        return Observation(passed and any(matches(m, v, "share") for m, v, _ in crowded), expected, observed)


@register("each")
class Each(OfBodies, ScenePredicate):
    """Every body of a selection has some properties. An empty selection fails."""

    has: Having
    """Property → accepted values."""
    share: Quantity = 1.0
    """Share of the bodies that must have them."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Look at each of them."""
        bodies = self.bodies(material, scene)
        words = ", ".join(f"{name} {match.words()}" for name, match in self.has.items())
        least = "each" if self.share == 1 else f"at least {self.share:.0%}"
        expected = f"{self.of}: {least} has {words}"
        wrong: list[tuple[Any, Any]] = []
        where, bad = None, 0
        for body in bodies:
            values = {name: value_of(scene, body, name) for name in self.has}
            off = [name for name, match in self.has.items() if not matches(match, values[name], PROPERTIES[name].kind)]
            bad += bool(off)
            if off:
                where = where or yaml_path(body, off[0])
                wrong.append((body, values[off[0]] if len(self.has) == 1 else {k: values[k] for k in off}))
        passed = bad <= (1 - self.share) * len(bodies) + 1e-9
        observed = summary(wrong) if wrong else f"all {len(bodies)}"
        return Observation(passed, expected, observed, None if passed else where)


@register("distinct")
class Distinct(OfBodies, ScenePredicate):
    """How many different values a property has among the bodies of a selection: numbers that the tolerance of the
    property tells apart, colors that look different."""

    property: PropertyName
    """Name of the property."""
    number: Match
    """Accepted numbers of different values."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Collect the values."""
        bodies = material.bodies(scene, self.of)
        every_value = [value_of(scene, body, self.property) for body in bodies]
        values = discernible(every_value) if self.property == "color" else self._different(every_value)
        passed = bool(bodies) and matches(self.number, len(values), "count")
        shown = ", ".join(sorted(map(show, values))[:6])
        expected = f"{self.of}: {self.number.words()} different values of {self.property}"
        where = yaml_path(bodies[0], self.property) if bodies else None
        return Observation(passed, expected, f"{len(values)}: {shown}", where)

    def _different(self, values: list[Any]) -> list[Any]:
        """The values without duplicates; values within the tolerance of the property count as equal."""
        kept: list[Any] = []
        kind = PROPERTIES[self.property].kind
        for value in sorted(values, key=lambda value: (value is None, value if is_number(value) else 0)):
            if not any(matches(Match(eq=other), value, kind) for other in kept):
                kept.append(value)
        return kept


@register("placed", "relations")
class Placed(OfBodies, ScenePredicate):
    """Each row of a table describes exactly one body of a selection, and each of its bodies has a row."""

    rows: list[Having]
    """For each row: property → accepted values."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Find a body for each row."""
        bodies = material.bodies(scene, self.of)
        expected = f"{self.of}: one for each of {len(self.rows)} rows"
        fits = [[k for k, body in enumerate(bodies) if self._fits(scene, body, row)] for row in self.rows]
        row_of: dict[int, int] = {}
        open_rows = [row for row in range(len(self.rows)) if not _assign(row, fits, row_of, set())]
        odd = [body for k, body in enumerate(bodies) if k not in row_of]
        if not open_rows and not odd:
            return Observation(True, expected, f"all {len(bodies)}")
        words = ["; ".join(f"{name} {match.words()}" for name, match in self.rows[row].items()) for row in open_rows]
        observed = "".join(f"no body with {text}. " for text in words[:3])
        if odd:
            observed += "in no row: " + summary([(body, self._values(scene, body)) for body in odd])
        marks = [Mark(points=[list(body.position)], text=body.name) for body in odd]
        return Observation(False, expected, observed, f"{odd[0].entry}.state" if odd else None, marks=marks)

    def _fits(self, scene: GradedScene, body: GradedBody, row: dict[str, Match]) -> bool:
        return all(matches(match, value_of(scene, body, key), PROPERTIES[key].kind) for key, match in row.items())

    def _values(self, scene: GradedScene, body: GradedBody) -> list[Any]:
        return [value_of(scene, body, name) for name in (self.rows[0] if self.rows else ())]


def _assign(row: int, fits: list[list[int]], row_of: dict[int, int], tried: set[int]) -> bool:
    """Give a row one of the bodies that fit it, moving other rows to other bodies where that helps."""
    for k in fits[row]:
        if k in tried:
            continue
        tried.add(k)
        if k not in row_of or _assign(row_of[k], fits, row_of, tried):
            row_of[k] = row
            return True
    return False


@register("sensor")
class Sensor(OfBodies, ScenePredicate):
    """Every body of a selection has sensors with some parameters. An empty selection fails."""

    has: Annotated[dict[SensorKey, Match], checked(SENSOR_KINDS, {"name": SENSORS.installed()})] = {}
    """Parameter of the sensor as the simulator holds it → accepted values. ``direction`` is where its middle beam
    points relative to the body, ``mounted`` how far it sits from the origin of the body, ``spacing`` the angle between
    two beams."""
    number: Match = Match(eq=1)
    """How many sensors of each body have them."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Look at the sensors of each body."""
        bodies = self.bodies(material, scene)
        words = ", ".join(f"{name} {match.words()}" for name, match in self.has.items()) or "sensors"
        expected = f"{self.of}: {self.number.words()} with {words}"
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
        return all(
            matches(match, parameter(sensor, key), SENSOR_KINDS.get(key, "name")) for key, match in self.has.items()
        )


def parameter(sensor: dict[str, Any], key: str) -> Any:
    """A parameter of a sensor; None if it has no such parameter."""
    offset = sensor.get("offset") or [0.0, 0.0, 0.0]
    if key in ("noise", "std", "angle_std") and "noise" in sensor:  # each counts only with the others
        std, angle_std = (sensor["noise"] and sensor.get(name, 0.0) for name in ("std", "angle_std"))
        return {"noise": bool(std or angle_std), "std": float(std), "angle_std": float(angle_std)}[key]
    if key == "mounted":
        return math.hypot(*offset[:2])
    if key == "direction":
        return float(offset[2]) if len(offset) > 2 else 0.0
    if key == "spacing":
        number, angle = sensor.get("number"), sensor.get("angle_range")
        gaps = (number or 0) - bool(sensor.get("endpoint", True))
        return angle / gaps if gaps > 0 and angle is not None else None
    return sensor.get(key)
