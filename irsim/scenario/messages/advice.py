"""Advice on keys that the language lacks, such as ``diameter``, and on poses written as one flat list of numbers."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from irsim.common.arguments import is_number
from irsim.diagnostics.diagnostic import Path
from irsim.options.vectors import is_vector
from irsim.scenario.messages.findings import key_path
from irsim.scenario.messages.number_text import read_number
from irsim.scenario.model.lookup import at
from irsim.scenario.yaml.formatting import flow

__all__ = ["Poses", "advice_on_key", "split_poses", "split_waypoints", "vector_of"]


_HEADINGS = ("theta", "yaw", "heading", "angle", "orientation")
_HEADING_TOLERANCES = tuple(
    f"{what}_{last}"
    for what in ("goal_angle", "goal_heading", "goal_yaw", "goal_theta", "heading", "yaw", "theta", "yaw_goal")
    for last in ("threshold", "tolerance")
)
_SIDES = ("size", "dimensions", "extent")


_SPEEDS = ("speed", "max_speed", "speed_max", "maxspeed", "vmax", "v_max", "vel_max", "max_vel", "max_velocity")
_OWN_SPEEDS = ("maxSpeed", "vmax")
"""Keys of the behaviors that have a limit of their own."""


def advice_on_key(path: Path, data: Any, allowed: Sequence[str]) -> tuple[str | None, str | None]:
    """Advice in words on an unknown key, and the key to rename it to if that may be what was meant.

    Args:
        path: Path of the unknown key.
        data: The whole document.
        allowed: Keys that it may have.
    """
    key, parent, value = str(path[-1]).lower(), at(data, path[:-1]), at(data, path)
    if not isinstance(parent, Mapping):
        return None, None
    where = key_path(path[:-1])
    if where in ("entry.behavior", "entry.group_behavior") and key in _SPEEDS:
        if (own := next((name for name in _OWN_SPEEDS if name in allowed), None)) is not None:
            return (None, None) if own in parent else (f"rename it to '{own}'", own)
        limits = flow(value) if is_vector(value) else f"[{_text(value)}, ...]"
        return f"it belongs beside 'behavior': vel_max: {limits}, one number per control of the drive", None
    if where == "world":
        return (_sides(value, "width", "height"), None) if key in _SIDES else (None, None)
    if where == "entry":
        return _of_entry(key, value, parent), None
    if where in ("entry.shape", "entry.shape.parts"):
        return _of_shape(key, value, parent)
    return None, None


_MOST_NUMBERS = 4
"""Most numbers of a vector that a text may mean."""


def vector_of(value: Any) -> list[float] | None:
    """The vector that a mapping such as ``{x: 9, y: 5}``, or a text such as ``9, 5``, means; None for other values."""
    if isinstance(value, str):
        parts = re.split(r",?\s+", value.strip("() "), maxsplit=_MOST_NUMBERS)  # "1,5" is one number
        numbers = [one for part in parts if (one := read_number(part, None).value) is not None]
        if not 2 <= len(numbers) == len(parts) <= _MOST_NUMBERS:
            return None
        return [int(one) if one.is_integer() else one for one in numbers]
    if not isinstance(value, Mapping) or not {"x", "y"} <= set(value):
        return None
    heading = [key for key in value if key in _HEADINGS]
    numbers = [value["x"], value["y"], *(value[key] for key in heading[:1])]
    return numbers if len(numbers) == len(value) and is_vector(numbers) else None


def _of_entry(key: str, value: Any, parent: Mapping[Any, Any]) -> str | None:
    if key in ("x", "y") or key in _HEADINGS:
        pose = _pose(key, value, parent)
        return f"it belongs in 'state', which is [x, y, theta]: {pose}"
    if key in _HEADING_TOLERANCES:
        return "see arrive_mode: state: the heading counts, and goal_threshold holds for metres and radians together"
    if key in ("radius", "diameter"):
        return f"it belongs in 'shape': {{name: circle, radius: {_half(value) if key == 'diameter' else _text(value)}}}"
    if key in ("length", "width"):
        sides = (_text(parent.get("length")), _text(parent.get("width")))
        return f"it belongs in 'shape': {{name: rectangle, length: {sides[0]}, width: {sides[1]}}}"
    return None


def _pose(key: str, value: Any, parent: Mapping[Any, Any]) -> str:
    """The state given by the keys of an entry; a missing coordinate stays a letter."""
    known: dict[str, Any] = dict(zip(("x", "y", "theta"), ("x", "y", 0), strict=True))
    written: Any = next((parent[name] for name in ("state", "pose", "position", "start") if name in parent), None)
    if is_vector(written):
        known.update(zip(known, written, strict=False))
    known.update({name: parent[name] for name in ("x", "y") if is_number(parent.get(name))})
    if key in _HEADINGS and is_number(value):
        known["theta"] = round(math.radians(value), 4) if abs(value) > 2 * math.pi else value
    return f"state: {flow(list(known.values()))}"


def _of_shape(key: str, value: Any, parent: Mapping[Any, Any]) -> tuple[str | None, str | None]:
    if key == "diameter":
        return f"write half of it as the radius: 'radius: {_half(value)}'", None
    if str(parent.get("name")).lower() != "rectangle":
        return None, None
    if key in _SIDES:
        return _sides(value, "length", "width"), None
    if key in ("height", "depth", "breadth"):
        other = "width" if "length" in parent else "length"
        if other in parent:
            return None, None
        return f"rename it to '{other}': 'length' is along the heading (x where it is 0), 'width' across", other
    return None, None


def _sides(value: Any, first: str, second: str) -> str:
    if isinstance(value, (list, tuple)) and len(value) == 2 and is_vector(value):
        return f"write '{first}: {flow(value[0])}' and '{second}: {flow(value[1])}'"
    return f"write '{first}' and '{second}'"


def _half(value: Any) -> str:
    return flow(value / 2) if is_number(value) else "..."


def _text(value: Any) -> str:
    return flow(value) if is_number(value) else "..."


_HEADING_STEP = math.pi / 4
"""Written headings are usually multiples of an eighth of a turn [rad]."""
_HEADING_ROUNDING = 0.01
"""Deviation of a written heading from such a multiple [rad]."""
_POSE_SIZE = 3
"""Numbers of a pose: x, y and heading."""
_FULL_TURN = 2 * math.pi


class Poses(NamedTuple):
    """Poses found in a flat list of numbers.

    Attributes:
        value: Vectors of two or three numbers; for several objects one list of them per object.
        sure: Whether there is no other way to split the list.
    """

    value: list[Any]
    sure: bool = True


def split_poses(numbers: Any) -> Poses | None:
    """The poses of two or three numbers each in a flat list; None if it is not clear where each ends."""
    if not is_vector(numbers) or any(isinstance(number, bool) for number in numbers):
        return None
    count = len(numbers)
    if count == 4 and _is_heading(numbers[2]) and numbers[3] == 0:  # one pose with the steering angle of a car
        return None
    in_pairs, in_poses = count > 0 and count % 2 == 0, count > 0 and count % _POSE_SIZE == 0
    if not in_pairs and not in_poses:
        return None
    thirds = numbers[2::_POSE_SIZE]
    if in_poses and (not in_pairs or all(_is_heading(number) for number in thirds)):
        return Poses(_cut(numbers, _POSE_SIZE), all(abs(number) <= _FULL_TURN for number in thirds))
    return Poses(_cut(numbers, 2), not in_poses or any(abs(number) > _FULL_TURN for number in thirds))


def split_waypoints(path: Path, data: Any) -> Poses | None:
    """The waypoints of a list in which some elements hold the numbers of several poses; None if it is not clear.

    Args:
        path: Path of one of those elements.
        data: The whole document.
    """
    points, entry = at(data, path[:-1]), at(data, path[: path.index("waypoints")])
    if not isinstance(points, (list, tuple)) or not isinstance(entry, Mapping):
        return None
    split = [Poses([point]) if _is_pose(point) else split_poses(point) for point in points]
    readable = [poses for poses in split if poses is not None]
    if len(readable) < len(points):
        return None
    sure = all(poses.sure for poses in readable)
    if path[-2] == "waypoints" and entry.get("number", 1) == len(points) > 1 and not any(map(_is_pose, points)):
        return Poses([poses.value for poses in readable], sure)
    return Poses([pose for poses in readable for pose in poses.value], sure)


def _is_pose(point: Any) -> bool:
    return is_vector(point) and len(point) in (2, _POSE_SIZE)


def _is_heading(number: float) -> bool:
    remainder = math.remainder(number, _HEADING_STEP)
    return abs(number) < math.pi + _HEADING_ROUNDING and abs(remainder) < _HEADING_ROUNDING


def _cut(numbers: Sequence[Any], size: int) -> list[list[Any]]:
    return [list(numbers[i : i + size]) for i in range(0, len(numbers), size)]
