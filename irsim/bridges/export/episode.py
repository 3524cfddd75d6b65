"""A recorded run as exporters read it: the chosen objects and their lidars, block by block, with velocities."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.export.readings import ExportedGauge, exported_gauges
from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.components.sensors._gauges import GaugeOptions
from irsim.options.base import Options
from irsim.options.registry import KINEMATICS, SENSORS
from irsim.runs.files import RunError, unreadable
from irsim.runs.reading import Run
from irsim.scenario.limits import Limits
from irsim.simulation.events import BETWEEN_STEPS
from irsim.simulation.trace import Trace

__all__ = ["CHOICES", "Actor", "Block", "ExportedEpisode", "Lidar", "open_episode"]

CHOICES = ("movers", "robots", "people", "all")
"""Words that choose objects: robots and obstacles that can move, robots, obstacles that can move, or all objects."""
_BLOCK_NUMBERS = 2_000_000
"""Number of values of one block, which bounds the memory of an export."""
_WORLD_FACTS = ("collision_mode", "contacts", "integration", "after_arrival", "step_time", "time_limit")
"""Keys of the world that decide what counts as a contact and as an arrival."""
_MAX_BLOCK_ROWS = 65_536


@dataclass(frozen=True)
class Actor:
    """An object that is exported.

    Attributes:
        index: Its index among all objects of the run.
        name: Its name.
        facts: Its entry in ``resolved.json``.
    """

    index: int
    name: str
    facts: dict[str, Any]

    @property
    def role(self) -> str:
        """``robot`` or ``obstacle``."""
        return str(self.facts["role"])

    @property
    def can_move(self) -> bool:
        """Whether it has a drive and may use it."""
        return self.drive is not None and not self.facts["static"]

    @property
    def has_goal(self) -> bool:
        """Whether it has a goal at the start; the goal of an obstacle which cannot move is only a default."""
        return bool(self.facts["goals"]) and (self.role == "robot" or self.can_move)

    @property
    def goes_on(self) -> bool:
        """Whether another goal follows each arrival."""
        return bool(self.facts["wander"] or self.facts["loop"])

    @property
    def drive(self) -> str | None:
        """Name of its drive, None without one."""
        kinematics = self.facts.get("kinematics")
        return str(kinematics["name"]) if isinstance(kinematics, dict) else None

    @property
    def controls(self) -> list[tuple[str, str]]:
        """Name and unit of each recorded control; of a drive that is not registered, only their number is known."""
        drive = self.drive
        if drive is None:
            return []
        count = min(3, int(self.facts["vel_dim"]))
        feature = KINEMATICS.get(drive)
        if feature is None:
            return [(f"control{number}", "control units") for number in range(count)]
        rows, units = feature.options.control_rows, feature.options.control_units  # type: ignore[attr-defined]
        return list(zip(rows, units, strict=True))[:count]

    @property
    def limits(self) -> tuple[list[float], list[float]]:
        """Lowest and highest value of each control."""
        count = len(self.controls)
        return [float(v) for v in self.facts["vel_min"]][:count], [float(v) for v in self.facts["vel_max"]][:count]


@dataclass(frozen=True)
class Lidar:
    """A range sensor whose scans were recorded.

    Attributes:
        key: Key of its ranges in the trace.
        actor: Position of its carrier among the actors.
        number: Its number among the native sensors of the carrier.
        beams: Number of beams.
        options: Its options.
    """

    key: str
    actor: int
    number: int
    beams: int
    options: dict[str, Any]

    @property
    def angles(self) -> tuple[float, float, float]:
        """Angle of the first and the last beam in the frame of the sensor, and between two beams [rad]."""
        if self.beams < 2:
            return 0.0, 0.0, 0.0
        opening = float(self.options["angle_range"])
        between = opening / (self.beams - 1 if self.options.get("endpoint", True) else self.beams)
        return -opening / 2, -opening / 2 + between * (self.beams - 1), between

    @property
    def limits(self) -> tuple[float, float]:
        """Shortest and longest range [m]."""
        return float(self.options["range_min"]), float(self.options["range_max"])


@dataclass(frozen=True)
class Block:
    """Successive rows of a run.

    Attributes:
        trace: The T rows of the M actors.
        velocity: (T, M, 3) mean velocity in the world frame [m/s] and yaw rate [rad/s] during the step that led to
            each row; NaN in the first row of a run.
        heading_before: (T, M) heading before that step [rad]; in the first row of a run the present one.
        between_steps: (T, M) whether it touched something within that step, and at neither end of it.
    """

    trace: Trace
    velocity: Floats
    heading_before: Floats
    between_steps: NDArray[np.bool_]

    @property
    def body_velocity(self) -> Floats:
        """(T, M, 3) forward and leftward velocity [m/s] and yaw rate [rad/s]; zero in the first row of a run."""
        x, y, rate = np.moveaxis(np.nan_to_num(self.velocity), 2, 0)
        cosine, sine = np.cos(self.heading_before), np.sin(self.heading_before)
        return np.stack([x * cosine + y * sine, y * cosine - x * sine, rate], axis=2)


@dataclass(frozen=True)
class ExportedEpisode:
    """One run, as far as it is exported.

    Attributes:
        run: The run.
        actors: The chosen objects.
        with_ranges: Whether the ranges of lidars are exported.
        limits: Limits of the reader of the scenario.
        progress: Callback with the number of rows read since the last call.
        options: Options of the format; None without options.
    """

    run: Run
    actors: tuple[Actor, ...]
    with_ranges: bool
    limits: Limits | None
    progress: Callable[[int], None]
    options: Options | None = None

    @cached_property
    def lidars(self) -> tuple[Lidar, ...]:
        """The range sensors of the actors, in their order; empty without ranges."""
        beams = {str(key): int(count) for key, count in self.run.meta["sensors"]} if self.with_ranges else {}
        result = []
        for position, actor in enumerate(self.actors):
            native = [options for options in actor.facts["sensors"] if _has_beams(options)]
            for number, options in enumerate(native):
                key = f"{actor.name}/{number}"
                if key in beams:
                    result.append(Lidar(key, position, number, beams[key], options))
        return tuple(result)

    @cached_property
    def gauges(self) -> tuple[ExportedGauge, ...]:
        """The sensors of the actors that report numbers; sensors that report rows of numbers belong to the ranges."""
        gauges = exported_gauges(self.run, self.actors)
        return tuple(gauge for gauge in gauges if self.with_ranges or not gauge.has_rows)

    @cached_property
    def last_step(self) -> int:
        """Last recorded step."""
        return self.run.last_step

    @property
    def last_scan(self) -> int:
        """Last step whose scans and readings are exported; -1 without any."""
        if not (self.lidars or self.gauges):
            return -1
        until = self.run.meta.get("scans_until")
        return self.last_step if until is None else min(self.last_step, int(until))

    @property
    def controls(self) -> int:
        """Greatest number of controls of an actor."""
        return max((len(actor.controls) for actor in self.actors), default=0)

    def blocks(self, *, scans: bool = True) -> Iterator[Block]:
        """Yield the run in blocks of limited size.

        Args:
            scans: Whether to read scans and readings, if any are exported.

        Raises:
            RunError: A file of the run has been changed, or no step was recorded.
        """
        measured = sum(lidar.beams for lidar in self.lidars) + sum(gauge.count for gauge in self.gauges)
        width = 16 * len(self.actors) + measured
        rows = min(_MAX_BLOCK_ROWS, max(2, _BLOCK_NUMBERS // max(1, width)))
        before: Floats | None = None
        chosen = [actor.index for actor in self.actors]
        aimless = [column for column, actor in enumerate(self.actors) if not actor.has_goal]
        for trace in self.run.blocks(rows, chosen, scans=scans and measured > 0):
            led = np.concatenate([trace.pose[:1] if before is None else before, trace.pose[:-1]])
            velocity = (trace.pose - led) / trace.step_time
            velocity[:, :, 2] = wrap(trace.pose[:, :, 2] - led[:, :, 2]) / trace.step_time
            if before is None:
                velocity[0] = math.nan
            before = trace.pose[-1:].copy()
            trace.goal[:, aimless] = math.nan
            yield Block(trace, velocity, led[:, :, 2], self._between_steps(trace))
            self.progress(len(trace))

    @cached_property
    def _contacts(self) -> NDArray[np.int64]:
        """(C, 2) step and position of the actor of each of its contacts between steps."""
        place = {actor.name: position for position, actor in enumerate(self.actors)}
        result = [
            (event.step, place[name])
            for event in self.run.events
            if event.kind in BETWEEN_STEPS
            for name in (event.object, event.partner)
            if name in place
        ]
        return np.array(result, dtype=np.int64).reshape(-1, 2)

    def _between_steps(self, trace: Trace) -> NDArray[np.bool_]:
        """(T, M) whether an actor touched something within the step that led to a row."""
        result = np.zeros((len(trace), len(self.actors)), dtype=bool)
        row, position = self._contacts[:, 0] - int(trace.step[0]), self._contacts[:, 1]
        here = (row >= 0) & (row < len(trace))
        result[row[here], position[here]] = True
        return result

    @property
    def facts(self) -> dict[str, Any]:
        """Facts of the run, as JSON types: what reproduces it, its objects, lidars and units of readings."""
        meta, result = self.run.meta, self.run.result
        resolved = self.run.resolved
        objects, built = resolved["objects"], resolved.get("built", {})
        named = ("id", "scenario", "seed", "step_time", "horizon", "options", "irsim", "python", "numpy", "created")
        return {
            **{key: meta.get(key) for key in named},
            "status": self.run.status,
            "outcome": None if result is None else result.outcome,
            "summary": None if result is None else result.summary,
            "last_step": self.last_step,
            "notes": self.run.notes,
            "scenario_text": self.run.scenario_text,
            "world": {key: resolved["world"].get(key) for key in _WORLD_FACTS},
            "objects": [
                {**_object_facts(item, resolved["radius"][row]), **{key: built[key][row] for key in built}}
                for row, item in enumerate(objects)
            ],
            "lidars": [
                {
                    "object": self.actors[lidar.actor].name,
                    "number": lidar.number,
                    "beams": lidar.beams,
                    "angles": lidar.angles,
                    **{key: lidar.options[key] for key in ("range_min", "range_max", "offset")},
                }
                for lidar in self.lidars
            ],
            **({"readings": {gauge.key: dict(gauge.units) for gauge in self.gauges}} if self.gauges else {}),
        }


def open_episode(
    run: Run,
    objects: str | Sequence[str],
    *,
    with_ranges: bool,
    limits: Limits | None = None,
    progress: Callable[[int], None] = lambda rows: None,
    options: Options | None = None,
    none: bool = False,
) -> ExportedEpisode:
    """A run with the objects to export.

    Args:
        run: The run.
        objects: One of :data:`CHOICES`, or names of objects.
        with_ranges: Whether to export the ranges of lidars.
        limits: Limits of the reader of the scenario.
        progress: Callback with the number of rows read since the last call.
        options: Options of the format.
        none: Whether a run without any such object is exported, too.

    Raises:
        RunError: No object has one of the names, no object is chosen, or the run cannot be read.
    """
    facts = run.resolved["objects"]
    if len(facts) != len(run.names):
        raise unreadable(f"resolved.json of run {run.id} has been changed")
    if isinstance(objects, str):
        if objects not in CHOICES:
            fix = f"choose {', '.join(CHOICES)}, or give a list of names"
            raise RunError("bad-argument", f"{objects!r} does not choose objects", fix, where="objects")
        chosen = [index for index, item in enumerate(facts) if _is_chosen(item, objects)]
    else:
        chosen = [run.index_of(name) for name in dict.fromkeys(objects)]
    if not chosen and not none:
        what, fix = f"run {run.id} has no {objects}", "choose all objects, or name some"
        if not facts:
            what, fix = f"run {run.id} has no objects", "export a run with robots or obstacles"
        raise RunError("bad-argument", what, fix, where="objects")
    actors = tuple(Actor(index, run.names[index], facts[index]) for index in chosen)
    return ExportedEpisode(run, actors, with_ranges, limits, progress, options)


def _is_chosen(facts: dict[str, Any], word: str) -> bool:
    if facts["role"] == "robot":
        return word != "people"
    return word == "all" or (word in ("movers", "people") and not facts["static"])


def _has_beams(options: dict[str, Any]) -> bool:
    """Whether a sensor is one of the core that measures ranges."""
    feature = SENSORS.get(str(options["name"]))
    return feature is not None and feature.kernel is not None and not issubclass(feature.options, GaugeOptions)


def _object_facts(item: dict[str, Any], radius: float) -> dict[str, Any]:
    """The facts of an object that do not change, which tables leave out."""
    drive = item.get("kinematics")
    return {
        "name": item["name"],
        "role": item["role"],
        "static": item["static"],
        "drive": drive["name"] if isinstance(drive, dict) else None,
        "wheelbase": item.get("wheelbase"),
        "goal_threshold": item.get("goal_threshold"),
        "arrive_mode": item.get("arrive_mode"),
        "unobstructed": item.get("unobstructed"),
        "shape": item["shape"],
        "radius": radius,
        "pose": item["state"][:3],
        "goals": item["goals"],
    }
