"""Errors that IR-SIM 2.12 tolerates, and what it does about them (section 14 of the format).

``irsim.make`` and ``irsim run`` do the same and warn; ``validate`` and all strict modes report an error. Each
function returns the edit that has the same effect, or None if 2.12 fails too.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from irsim.diagnostics.diagnostic import Edit, Path
from irsim.scenario.messages.findings import key_path
from irsim.scenario.model.lookup import at

__all__ = ["carry_on_group", "carry_on_type", "carry_on_unknown_key", "carry_on_value"]

_STRICT_SHAPES = ("circle", "rectangle")
_STRICT_SECTIONS = ("", "entry.kinematics", "gui.mouse", "world.zones", "world.zones.circle")
_FALLBACKS = {
    "world.collision_mode": "unobstructed",
    "world.control_mode": "auto",
    "entry.behavior.target_roles": "all",
    "entry.group_behavior.target_roles": "all",
    "gui.keyboard.backend": "mpl",
}
_SINGLE = ("entry.vel_min", "entry.vel_max")
_NAMES = ("entry.name", "entry.group_name", "world.status", "world.name")
_TRUNCATED = ("alpha", "offset", "goal", "range_low", "range_high", "center")
_CLIPPED = {"entry.number": 0, "entry.fov": 0.0, "entry.sensors.angle_range": 0.0}
_GAZE = ("gaze_vision_angle", "group_repulsion_threshold", "social_groups")
_CHECKED_IN_GROUPS = {"sfm": ("gamma", "relaxation_time", "sigma_obstacle", *_GAZE), "orca": ("maxNeighbors",)}
"""Keys whose wrong values make 2.12 fail to create a group behavior; it logs that and continues without one."""
_NO_CHANGE = 1e-9
"""Change of velocity that is too small to move an object [m/s]."""


def carry_on_group(path: Path, data: Any) -> Edit | None:
    """2.12 continues without a group behavior that has no name or that it fails to create.

    Args:
        path: Path of a wrong value, or of a missing name.
        data: The whole document.
    """
    if "group_behavior" not in path[:-1]:
        return None
    end = path.index("group_behavior") + 1
    options, key = at(data, path[:end]), path[end]
    if not isinstance(options, Mapping):
        return None
    name = options.get("name")
    if (key == "name" and name is None) or key in _CHECKED_IN_GROUPS.get(str(name), ()):
        return Edit("remove", path[:end])
    return None


def carry_on_unknown_key(path: Path, parent: Any) -> Edit | None:
    """2.12 ignores unknown keys, except where it passes them on to a constructor that fails."""
    section = key_path(path[:-1])
    if section in _STRICT_SECTIONS:
        return None
    if section in ("entry.shape", "entry.shape.parts") and isinstance(parent, Mapping):
        default = "circle" if section == "entry.shape" else None
        if str(parent.get("name", default)).lower() in _STRICT_SHAPES:
            return None
        if section == "entry.shape.parts" and path[-1] == "color":
            return None
    return Edit("remove", path)


def carry_on_type(kind: str, path: Path, value: Any) -> Edit | None:
    """2.12 takes booleans by truthiness, booleans as numbers, any scalar as a name, and one number as all limits."""
    if kind in ("bool_type", "bool_parsing"):
        return Edit("replace", path, bool(value))
    if kind in ("float_type", "int_type") and isinstance(value, bool):
        return Edit("replace", path, int(value))
    if kind == "list_type" and key_path(path) in _SINGLE and isinstance(value, (int, float)):
        return Edit("replace", path, [value])
    if kind == "string_type" and key_path(path) in _NAMES and isinstance(value, (str, int, float)):
        return Edit("replace", path, str(value))
    if kind in ("model_type", "model_attributes_type") and path in (("robot",), ("obstacle",)):
        return Edit("remove", path)
    return None


def carry_on_value(kind: str, path: Path, value: Any, max_length: int | None = None) -> Edit | None:
    """2.12 falls back to a default mode, clips, cuts long vectors, and notices bad colors only when it draws.

    With an ``acce`` of zero or less its ``rvo`` finds no new velocity, so the object does not move.
    """
    where = key_path(path)
    if kind == "unknown-value" and where in _FALLBACKS:
        return Edit("replace", path, _FALLBACKS[where])
    if kind == "unknown-color":
        return Edit("remove", path)
    if kind == "greater_than_equal" and where in _CLIPPED:
        return Edit("replace", path, _CLIPPED[where])
    if kind == "greater_than" and where == "entry.behavior.acce":
        return Edit("replace", path, _NO_CHANGE)
    if kind == "too_long" and where.rsplit(".", 1)[-1] in _TRUNCATED and max_length is not None:
        return Edit("replace", path, list(value)[:max_length])
    return None
