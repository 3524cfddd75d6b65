"""The options of the core for the features of an object: its drive, behavior, route and sensors, and its geometry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import irsim._core as core
from irsim.components.behaviors.follow import Follow
from irsim.components.sensors._gauges import GaugeOptions
from irsim.components.sensors._timing import TimedOptions
from irsim.options.registry import BEHAVIORS, DISTRIBUTIONS, KINEMATICS, PLANNERS, SENSORS, SHAPES, Registry

if TYPE_CHECKING:
    from pydantic import BaseModel

    from irsim.components.options import BehaviorOptions
    from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["Kernels", "kernel_options", "kernels_of", "parts_of", "placement_kernel"]

_USUAL_WIDTH = 0.3
"""Width of a body whose shape is not known [m]."""


@dataclass(frozen=True)
class Kernels:
    """The options of the core for one object; None for what it does not have, or what Python computes.

    Attributes:
        parts: Geometry in the body frame, or in the world frame for the map and the walls round the world.
        drive: Options of its drive.
        behavior: Options of the behavior that decides for it.
        route: Options of its path under ``follow``.
        sensors: Options of each sensor.
        timing: Times of each sensor; empty if all measure in each step.
    """

    parts: list[Any]
    drive: Any
    behavior: Any
    route: core.RouteOptions | None
    sensors: list[Any]
    timing: list[core.SensorTiming]


def kernels_of(record: ObjectRecord, group_behavior: BehaviorOptions | None, zones: Sequence[str]) -> Kernels:
    """Return the options of the core for one object.

    Args:
        record: The object.
        group_behavior: Behavior that drives its group; it replaces the object's own.
        zones: Names of the zones of the world.

    Raises:
        LookupError: A feature is not registered, or its shape has no geometry.
    """
    parts = parts_of(record.shape)
    if not (parts or record.is_terrain):
        raise LookupError(f"shape {record.shape.name!r} has no geometry")
    drive = behavior = route = None
    options: Any = record.behavior if group_behavior is None else group_behavior
    if isinstance(options, Follow):
        route, options = _route_options(options, zones), options.local
    if record.kinematics is not None:
        limits = {name: float("inf") for name, value in record.kinematics if value is None}
        if "track" in limits:
            limits["track"] = _width(parts)
        drive = kernel_options(KINEMATICS, record.kinematics, **{**limits, "wheelbase": record.wheelbase or 1.0})
        if options is not None and BEHAVIORS.get(str(getattr(options, "name", ""))) is not None:
            behavior = kernel_options(BEHAVIORS, options)
    sensors = [_sensor(options, zones) for options in record.sensors]
    return Kernels(parts, drive, behavior, route, sensors, _timing(record.sensors))


def _width(parts: Sequence[Any]) -> float:
    """Extent of a body across its heading [m]; of shapes that are drawn for each scene a usual one."""
    sides = [y for part in parts for _, y in getattr(part, "vertices", ())]
    sides += [part.center[1] + side * part.radius for part in parts if hasattr(part, "radius") for side in (-1, 1)]
    return max(sides) - min(sides) if sides and max(sides) > min(sides) else _USUAL_WIDTH


def _sensor(options: Any, zones: Sequence[str]) -> Any:
    """The options of a sensor in a world with these zones; None for one computed in Python."""
    if isinstance(options, GaugeOptions):
        return kernel_options(SENSORS, options, **options.resolved(list(zones)))
    realism = getattr(options, "realism", None)
    errors = None
    if realism is not None:
        spaces = max(1, options.number - options.endpoint)
        errors = realism.kernel(options.range_max, options.angle_range / spaces, options.scan_time)
    return kernel_options(SENSORS, options, realism=errors)


def _timing(sensors: Sequence[Any]) -> list[core.SensorTiming]:
    """When sensors measure and their data arrive; an empty list if all measure in each step."""
    times = [(one.rate or 0.0, one.latency) if isinstance(one, TimedOptions) else (0.0, 0.0) for one in sensors]
    late = any(rate > 0 or latency > 0 for rate, latency in times)
    return [core.SensorTiming(rate=rate, latency=latency) for rate, latency in times] if late else []


def parts_of(shape: Any) -> list[Any]:
    """Geometry for the core: in the body frame, or in the world frame for the map and the walls round the world."""
    if hasattr(shape, "fixed"):
        return list(shape.parts())
    feature = SHAPES.get(shape.name)
    if feature is None or feature.function is None:
        return []
    return list(feature.function(shape))


def kernel_options(registry: Registry, options: BaseModel, **resolved: Any) -> Any:
    """Return the options object of the core for an options model; None for features computed in Python.

    Args:
        registry: Registry of the feature.
        options: The options model.
        **resolved: Values of fields that depend on more than this model.

    Raises:
        LookupError: The feature is not registered.
    """
    feature = registry.get(str(getattr(options, "name", "")))
    if feature is None:
        raise LookupError(f"{type(options).__name__} is not a registered {registry.kind}")
    if feature.kernel is None:
        return None
    return feature.kernel(
        **{name: resolved[name] if name in resolved else getattr(options, name) for name in feature.kernel.fields}
    )


def placement_kernel(distribution: str) -> type[Any]:
    """The class of the core that holds placements of a distribution.

    Raises:
        LookupError: The distribution has no class.
    """
    feature = DISTRIBUTIONS.get(distribution)
    if feature is None or feature.kernel is None:
        raise LookupError(f"the distribution {distribution!r} has no kernel")
    return feature.kernel


def _route_options(options: Follow, zones: Sequence[str]) -> core.RouteOptions:
    """The options of the path of an object with the behavior ``follow`` in a world with these zones."""
    resolved = {"resolution": getattr(options.planner, "resolution", None) or 0.0}
    return core.RouteOptions(
        planner=kernel_options(PLANNERS, options.planner, **resolved),
        replan=options.replan or 0.0,
        lookahead=options.lookahead or 0.0,
        within=[] if options.within is None else options.within.points,
        avoid=[zones.index(name) for name in dict.fromkeys(options.avoid) if name in zones],
    )
