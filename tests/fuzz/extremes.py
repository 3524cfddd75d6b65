"""Each number of the language at its extremes: documents that differ from a small scenario in one number.

The schema of scenarios is walked: every key, every feature, every element of a vector.
"""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Iterator
from typing import Any

import yaml

from tests.fuzz.grammar import schema

__all__ = ["EXTREMES", "bounds_of", "documents", "places"]

EXTREMES: tuple[float, ...] = (
    0, 1, -1, 5e-324, -5e-324, 1e-300, 1e-9, -1e-9, 1e6, -1e6, 2**31, -(2**31) - 1, 2**53 + 1, 2**64, 1e18, 1e154,
    -1e300, 1.7976931348623157e308, math.inf, -math.inf, math.nan,
)  # fmt: skip
_ROBOT = {
    "kinematics": {"name": "diff"}, "shape": {"name": "circle", "radius": 0.2}, "behavior": {"name": "dash"},
    "state": [2, 5, 0], "goal": [8, 5, 0], "sensors": [{"name": "lidar2d", "number": 16}],
}  # fmt: skip
_SCENE = {
    "world": {"width": 10, "height": 10, "seed": 1},
    "robot": [_ROBOT, {**_ROBOT, "kinematics": {"name": "omni"}, "state": [8, 5, 0], "goal": [2, 5, 0]}],
    "obstacle": [{"shape": {"name": "rectangle", "length": 1, "width": 1}, "state": [5, 8, 0]}],
}
_WITH: dict[str, dict[str, Any]] = {
    "times": {"poses": [[1, 1, 0], [2, 1, 0]]}, "poses": {"times": [0.0, 0.2]},
    "waypoints": {"goal": None}, "inertia": {"mass": 1},
    "mdownsample": {"obstacle_map": "cave.png"}, "fog_map_resolution": {"fog_map": True},
}  # fmt: skip
"""Keys without which another has no effect."""
_SWITCHES = ("noise", "random_shape", "fog_map", "show_trail", "show_trajectory", "show_text", "show_fov", "wander")
"""Switches of features that are on while their numbers are varied."""
_SAMPLES = {
    "vertices": [[0, 0], [1, 0], [0, 1]], "polygon": [[1, 1], [3, 1], [2, 3]], "path": "cave.png",
    "num_vertices_range": [4, 8], "social_groups": [[0]], "center_range": [0, 0, 0, 0],
    "angle_range": [-3.14159265, 3.14159265],
    "times": [0.0, 0.2], "poses": [[1, 1, 0], [2, 1, 0]],
    "vel_max": [1, 1], "acce": [1, 1], "velocity": [1, 1], "vel_min": [-1, -1],
}  # fmt: skip
"""Ordinary values that the schema does not give."""
_LISTS = ("robot", "obstacle", "sensors", "zones", "parts", "keep_clear", "bridges")
"""Keys whose mappings stand in a list."""
_LIMIT = 6
"""Levels of components within components, such as a local behavior of `follow`."""

_CONTACT = {"mass", "inertia", "friction", "restitution", "gravity", "drive_tau", "tau", "force_scale"}
"""Keys of bodies that push one another."""
_CONTROLS = {"vel_max", "vel_min", "acce", "velocity", "state", "goal"}
_DRIVES = ("omni", "acker")
"""Drives, besides `diff`, with which keys of motion are varied."""

Place = tuple[tuple[str | int, ...], dict[str, Any], Any]
"""Path of a number, its part of the schema, and the document."""


def places() -> list[Place]:
    """Every number of the language, in a document in which it has an ordinary value."""
    matches: dict[str, Place] = {}
    root = schema()["$defs"]["Scenario"]["properties"]
    for section, depth in (("world", 0), ("gui", 0), ("robot", 0), ("obstacle", _LIMIT)):
        for entry in _objects(root[section]):
            for path, number, mapping in _of_mapping(entry, depth):
                scene, listed = copy.deepcopy(_SCENE), section in _LISTS
                around = scene.get(section, {})
                mapping = {**(around[0] if listed else around), **mapping}
                scene[section] = [mapping, *around[1:]] if listed else mapping
                whole = (section, *((0,) if listed else ()), *path)
                if _CONTACT & set(path):
                    scene["world"] = {**scene["world"], "collision_mode": "contact"}
                matches.setdefault(json.dumps([whole, scene]), (whole, number, scene))
                for drive in _DRIVES if listed and _CONTROLS & set(path) else ():
                    other = copy.deepcopy(scene)
                    other[section][0]["kinematics"] = {"name": drive}
                    matches.setdefault(json.dumps([whole, other]), (whole, number, other))
    return list(matches.values())


def documents(part: int = 0, parts: int = 1, more: bool = True) -> Iterator[tuple[str, str]]:
    """Name and text of each document, or of one part of them.

    Args:
        part: Which part.
        parts: Number of parts.
        more: Also the values at the bounds of each number.
    """
    index = 0
    for path, number, scene in places():
        for value in (*EXTREMES, *(bounds_of(number) if more else ())):
            if index % parts == part:
                text = yaml.safe_dump(_replaced(scene, path, value), sort_keys=False, default_flow_style=None)
                yield f"{'.'.join(str(word) for word in path)} = {value!r}", text
            index += 1


def bounds_of(number: dict[str, Any]) -> list[float]:
    """The extreme values that a part of the schema allows."""
    low, high = number.get("minimum"), number.get("maximum")
    matches = [value for value in (low, high) if value is not None]
    if "exclusiveMinimum" in number:
        matches.append(math.nextafter(number["exclusiveMinimum"], math.inf) if number["type"] == "number" else 1)
    return matches


def _objects(node: Any) -> list[dict[str, Any]]:
    """The mappings that a node describes."""
    if "$ref" in node:
        node = schema()["$defs"][node["$ref"].rpartition("/")[2]]
    if "anyOf" in node or "oneOf" in node:
        return [one for option in node.get("anyOf", node.get("oneOf")) for one in _objects(option)]
    if node.get("type") == "array" and "items" in node:
        return _objects(node["items"])
    return [node] if "properties" in node else []


def _of_mapping(node: dict[str, Any], depth: int) -> Iterator[Place]:
    """Numbers of a mapping, in the smallest mapping that has them."""
    base = _base(node)
    for key, part in node["properties"].items():
        together = {**base, **_WITH.get(key, {})}
        for number, value, inside in _numbers(part, key):
            yield (key, *inside), number, {**together, key: value}
        for component in _objects(part) if depth < _LIMIT else ():
            for path, number, mapping in _of_mapping(component, depth + 1):
                listed = key in _LISTS
                inner = (key, 0, *path) if listed else (key, *path)
                yield inner, number, {**together, key: [mapping] if listed else mapping}


def _base(node: dict[str, Any]) -> dict[str, Any]:
    """The smallest mapping that a node describes, with its switches on."""
    given = node["properties"]
    names = [key for key in given if key in node.get("required", ()) or (key == "name" and "const" in _first(given))]
    base = {key: _sample(given[key], key) for key in names}
    return base | {key: True for key in _SWITCHES if key in given and given[key].get("type") == "boolean"}


def _first(given: dict[str, Any]) -> dict[str, Any]:
    name = given.get("name", {})
    return name["anyOf"][0] if "anyOf" in name else name


def _sample(node: Any, key: str) -> Any:
    """An ordinary value."""
    if key in _SAMPLES:
        return copy.deepcopy(_SAMPLES[key])
    if "$ref" in node:
        node = {**schema()["$defs"][node["$ref"].rpartition("/")[2]], **{k: v for k, v in node.items() if k != "$ref"}}
    if "const" in node:
        return node["const"]
    if "enum" in node:
        return node["enum"][0]
    if node.get("examples"):
        return copy.deepcopy(node["examples"][0])
    if "anyOf" in node:
        return _sample(next(option for option in node["anyOf"] if option.get("type") != "null"), key)
    kind = node.get("type")
    if kind == "array":
        return [_sample(node.get("items", {}), "") for _ in range(max(1, node.get("minItems", 1)))]
    if kind in ("number", "integer"):
        return node["default"] if isinstance(node.get("default"), (int, float)) else max(1, node.get("minimum", 1))
    if kind == "object":
        return _base(node) if "properties" in node else {}
    return {"boolean": True}.get(str(kind), "a")


def _numbers(node: Any, key: str) -> Iterator[tuple[dict[str, Any], Any, tuple[int, ...]]]:
    """Numbers of the value of a key: part of the schema, the value, and the place of the number in it."""
    options = node.get("anyOf", [node])
    single = any(option.get("type") == "number" for option in options)
    for option in options:
        if single and option.get("items", {}).get("type") == "number":
            continue  # a list with one number per object
        if option.get("type") in ("number", "integer") and not {"const", "enum"} & set(option):
            yield option, _sample(option, ""), ()
        elif option.get("type") == "array" and "items" in option:
            whole = _sample(option, key)
            for number, value, deeper in _numbers(option["items"], ""):
                flat = not isinstance(whole[0], (list, dict))
                for index in dict.fromkeys((0, len(whole) - 1)) if flat == (not deeper) else ():
                    filled = whole if flat else [value if k == index else item for k, item in enumerate(whole)]
                    yield number, filled, (index, *deeper)


def _replaced(scene: dict[str, Any], path: tuple[str | int, ...], value: float) -> dict[str, Any]:
    changed = copy.deepcopy(scene)
    at: Any = changed
    for word in path[:-1]:
        at = at[word]
    at[path[-1]] = value
    return json.loads(json.dumps(changed)) if isinstance(value, int) else changed
