"""The world built from a scenario as plain data, which is the same however the file expresses it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel

from irsim.diagnostics.diagnostic import format_path
from irsim.objects.extensions.behaviors import PythonBehaviors
from irsim.simulation.build import group_behaviors

if TYPE_CHECKING:
    from irsim.env import Env
    from irsim.objects.view import ObjectView
    from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["describe_world"]

_DECIMALS = 9
"""Decimals of the numbers in a description."""
_WORLD = (
    "width", "height", "offset", "step_time", "integration", "sample_time", "time_limit", "control_mode",
    "collision_mode", "contacts", "after_arrival", "step_mode", "boundary", "seed", "obstacle_map", "mdownsample",
    "fog_map", "fog_map_resolution", "zones",
)  # fmt: skip
_RECORD = (
    "role", "group", "static", "unobstructed", "goal_threshold", "arrive_mode", "wander", "loop", "target_roles",
    "tags", "fov", "fov_radius", "fov_occlusion", "watches", "wheelbase", "color", "description",
    "reflectivity", "material", "perceives",
)  # fmt: skip
_POSE = ("x", "y", "theta")
_CONTACT_WORLD = ("gravity",)
_CONTACT = ("mass", "friction", "inertia", "restitution", "drive_tau")


def describe_world(env: Env) -> dict[str, Any]:
    """Describe the present state of an environment: world frame, lengths in m, angles in rad, numbers to 1e-9.

    Returns:
        ``world``: extent, times and modes; ``objects``: one mapping per object (including the map and the walls around
        the world) with ``name``, ``entry`` (path in the file), ``role``, ``kinematics``, its own ``behavior`` and the
        ``group_behavior`` that it follows, both with all options, ``group_members`` (indices in ``objects`` of the
        group with that behavior), ``shape``, ``footprint`` (``{circle: [x, y, radius]}``,
        ``{polygons: [[[x, y], …], …]}`` or ``{lines: …}``; None for maps), ``pose``, ``extra_state`` (further state of
        the drive), ``goals``, effective limits ``vel_min``, ``vel_max``, ``acce``, and ``sensors`` with all options.
    """
    world = env.scenario.world
    contact = world.collision_mode == "contact"
    views = sorted([*env.robot_list, *env.obstacle_list], key=lambda view: view.index)
    led = _group_behaviors(env)
    return {
        "world": {key: _plain(getattr(world, key)) for key in (*_WORLD, *(_CONTACT_WORLD if contact else ()))},
        "objects": [_object(view, led, contact) for view in views],
    }


def _group_behaviors(env: Env) -> dict[int, tuple[Any, list[int]]]:
    """Index of each object that follows a group behavior → options of the behavior, indices of the group's members."""
    records = env.simulation.scenario.objects
    members: dict[int, list[int]] = defaultdict(list)
    for place, record in enumerate(records):
        if record.joined:
            members[record.group].append(place)
    own = PythonBehaviors(env.simulation)
    own.find()
    led: list[tuple[Any, list[int]]] = [
        (options, members[group]) for group, options in group_behaviors(records).items()
    ]
    led += [(records[group[0]].group_behavior, group) for group in own.groups]
    return {
        place: (options, group)
        for options, group in led
        for place in group
        if records[place].kinematics is not None and not records[place].static
    }


def _object(view: ObjectView, led: Mapping[int, tuple[Any, list[int]]], contact: bool) -> dict[str, Any]:
    record = view.record
    group_behavior, members = led.get(view.index, (None, []))
    facts: dict[str, Any] = {"name": view.name, "entry": format_path(record.path), "index": record.index}
    facts |= {key: _plain(getattr(record, key)) for key in _RECORD}
    if record.state_dim != len(getattr(record.kinematics, "state_rows", _POSE)):
        facts["state_dim"] = record.state_dim
    if record.group_name != f"{record.role}_{record.group}":
        facts["group_name"] = record.group_name
    if contact:
        facts |= {key: _plain(getattr(record, key)) for key in _CONTACT}
    facts |= {
        "kinematics": _options(record.kinematics),
        "shape": _shape(record),
        "footprint": _footprint(view),
        "pose": _plain(view.init_state[:3, 0]),
        "extra_state": _plain([value for value in record.state[3:] if any(record.state[3:])]),
        "velocity": _plain(record.velocity),
        "goals": [] if record.static else [_plain(goal[:, 0]) for goal in view.goals],
    }
    if record.appear_time:
        facts["appear_time"] = _plain(record.appear_time)
    if not record.static:
        facts |= {key: _plain(getattr(view, key)[:, 0]) for key in ("vel_min", "vel_max", "acce")}
        facts["angle_range"] = _plain(list(record.angle_range))
        facts["actuation"] = _options(record.actuation)
        if record.start_time:
            facts["start_time"] = _plain(record.start_time)
        facts |= {"behavior": _options(record.behavior), "group_behavior": _options(group_behavior)}
        facts["group_members"] = members
        if record.wander:
            facts |= {"range_low": _plain(record.range_low), "range_high": _plain(record.range_high)}
    facts["sensors"] = [_options(sensor, "type") for sensor in record.sensors]  # `type` repeats the name
    return facts


def _options(model: BaseModel | None, *without: str) -> Any:
    return None if model is None else _plain(model.model_dump(mode="json", exclude={"plot", *without}))


def _shape(record: ObjectRecord) -> Any:
    return _options(record.shape) if isinstance(record.shape, BaseModel) else {"name": record.shape.name}


def _footprint(view: ObjectView) -> Any:
    if view.record.is_terrain:
        return None
    if view.shape == "circle":
        x, y = view.geometry.centroid.coords[0]
        return {"circle": _plain([x, y, view.radius])}
    geometry = view.geometry
    parts = list(getattr(geometry, "geoms", [geometry]))
    if parts and parts[0].geom_type == "Polygon":
        return {"polygons": [_plain(list(part.exterior.coords)) for part in parts]}
    return {"lines": [_plain(list(part.coords)) for part in parts]}


def _plain(value: Any) -> Any:
    """A value as JSON types, with numbers rounded to :data:`_DECIMALS`."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if hasattr(value, "model_dump"):
        return _plain(value.model_dump(mode="json"))
    if isinstance(value, (float, np.floating)):
        short = round(float(value), _DECIMALS)
        return short + 0.0 if np.isfinite(short) else str(value)
    if value is None or isinstance(value, (bool, int, str)):
        return value
    return str(value)
