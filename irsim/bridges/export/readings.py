"""Sensors without beams of the exported objects: which numbers they report, in which units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from irsim.components.sensors._gauges import GaugeOptions
from irsim.options.registry import SENSORS
from irsim.runs.reading import Run

__all__ = ["ExportedGauge", "Owner", "exported_gauges"]


class Owner(Protocol):
    """An object that is exported."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def facts(self) -> dict[str, Any]:
        """Its entry in ``resolved.json``."""


@dataclass(frozen=True)
class ExportedGauge:
    """A sensor that reports numbers, of which readings were recorded.

    Attributes:
        key: Key of its readings in the trace.
        actor: Position of its carrier among the actors.
        units: Name and unit of each number of a row.
        count: How many numbers it reports; more than names if it reports rows of them.
        options: Its options.
    """

    key: str
    actor: int
    units: Mapping[str, str]
    count: int
    options: dict[str, Any]

    @property
    def sensor(self) -> str:
        """Its name on its carrier, such as ``odometry`` or ``odometry_2``."""
        return self.key.rpartition("/")[2]

    @property
    def has_rows(self) -> bool:
        """Whether it reports rows of numbers, as a detector does."""
        return self.count > len(self.units)


def exported_gauges(run: Run, actors: Sequence[Owner]) -> tuple[ExportedGauge, ...]:
    """The sensors of some objects whose readings a run has, in the order of the objects."""
    told = {str(key): ([str(name) for name in names], int(count)) for key, names, count in run.meta.get("gauges", ())}
    gauges = []
    for position, actor in enumerate(actors):
        counts: dict[str, int] = {}
        for options in actor.facts["sensors"]:
            name = str(options["name"])
            number = counts[name] = counts.get(name, 0) + 1
            key = f"{actor.name}/{name}" if number == 1 else f"{actor.name}/{name}_{number}"
            if key in told:
                names, count = told[key]
                known = _units(name, options)
                units = {one: known.get(one, "") for one in names}
                gauges.append(ExportedGauge(key, position, units, count, options))
    return tuple(gauges)


def _units(name: str, options: dict[str, Any]) -> dict[str, str]:
    """Units of the numbers of a sensor; empty for one of a plug-in that is not installed."""
    feature = SENSORS.get(name)
    if feature is None or not issubclass(feature.options, GaugeOptions):
        return {}
    return dict(feature.options.model_validate(options).numbers())
