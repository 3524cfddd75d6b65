"""Rewrites of the world: the same things by other shapes, groups and entries."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from irsim_evals.grader.scene import GradedScene
from irsim_evals.proof.operators import Data, dump, entries, is_pose, rewrite


@rewrite
def one_entry_each(text: str, data: Data, scene: GradedScene) -> str | None:
    """Groups written out: one entry for each object, with its own pose and goal."""
    if scene.env.scenario.placements or not any(entry.get("number", 1) > 1 for *_, entry in entries(data)):
        return None
    bodies = iter(scene.bodies)
    made: Data = {key: value for key, value in data.items() if key not in ("robot", "obstacle")}
    for section, _, entry in entries(data):
        for _ in range(entry.get("number", 1)):
            body = next(bodies)
            one = {key: value for key, value in entry.items() if key not in ("number", "distribution", "state", "goal")}
            if any(
                isinstance(value, list) and value and isinstance(value[0], (list, dict))
                for key, value in ({**one, "waypoints": (one.get("waypoints") or [[]])[0]}).items()
                if key != "sensors"
            ):
                return None
            one["state"] = [round(value, 9) for value in body.pose]
            one["group"] = body.record.group
            if body.goals and "waypoints" not in one:
                one["goal"] = [round(value, 9) for value in body.goals[-1]]
            if one.get("color") == "cycle" or isinstance(one.get("color"), list):
                one["color"] = body.color
            if isinstance(one.get("name"), list):
                one["name"] = body.name
            made.setdefault(section, []).append(one)
    return dump(made)


def _rectangles(data: Data, change: Callable[[Data, Data], None]) -> str:
    """Apply a change to each static obstacle with the shape of a rectangle and one pose."""
    for section, _, entry in entries(data):
        shape = entry.get("shape")
        if section != "obstacle" or "kinematics" in entry or not isinstance(shape, dict) or entry.get("number", 1) != 1:
            continue
        if shape.get("name") == "rectangle" and is_pose(entry.get("state")):
            change(entry, shape)
    return dump(data)


@rewrite
def rectangles_as_polygons(text: str, data: Data, scene: GradedScene) -> str | None:
    """Rectangular obstacles as polygons with four corners in the world frame."""

    def change(entry: Data, shape: Data) -> None:
        x, y, *rest = entry["state"]
        heading = rest[0] if rest else 0.0
        c, s = math.cos(heading), math.sin(heading)
        a, b = shape.get("length", 1.0) / 2, shape.get("width", 1.0) / 2
        corners = [(-a, -b), (a, -b), (a, b), (-a, b)]
        entry["shape"] = {
            "name": "polygon",
            "vertices": [[round(x + c * u - s * v, 9), round(y + s * u + c * v, 9)] for u, v in corners],
        }
        entry["state"] = [0, 0, 0]

    return _rectangles(data, change)


@rewrite
def rectangles_turned(text: str, data: Data, scene: GradedScene) -> str | None:
    """Rectangular obstacles a quarter turn further, with length and width exchanged."""

    def change(entry: Data, shape: Data) -> None:
        shape["length"], shape["width"] = shape.get("width", 1.0), shape.get("length", 1.0)
        x, y, *rest = entry["state"]
        entry["state"] = [x, y, round((rest[0] if rest else 0.0) + math.pi / 2, 9)]

    return _rectangles(data, change)


@rewrite
def slightly_off(text: str, data: Data, scene: GradedScene) -> str | None:
    """Positions of robots a tenth of a millimetre off."""
    for section, _, entry in entries(data):
        if section == "robot" and is_pose(entry.get("state")):
            entry["state"][0] += 1e-4
    return dump(data)


@rewrite
def obstacles_in_reverse(text: str, data: Data, scene: GradedScene) -> str | None:
    """Obstacles in the opposite order."""
    given = data.get("obstacle")
    if not isinstance(given, list) or len(given) < 2 or scene.env.scenario.placements:
        return None
    data["obstacle"] = given[::-1]
    return dump(data)


@rewrite
def polygons_as_rectangles(text: str, data: Data, scene: GradedScene) -> str | None:
    """Polygons with four right angles as rectangles."""
    if scene.env.scenario.placements or len(scene.bodies) != sum(1 for _ in entries(data)):
        return None
    for body, (section, _, entry) in zip(scene.bodies, entries(data), strict=True):
        shape = entry.get("shape")
        if section != "obstacle" or not isinstance(shape, dict) or shape.get("name") != "polygon":
            continue
        if body.box is None or not body.static or "kinematics" in entry:
            continue
        entry["shape"] = {"name": "rectangle", "length": round(body.box.length, 9), "width": round(body.box.width, 9)}
        entry["state"] = [*(round(value, 9) for value in body.box.center), round(body.box.heading, 9)]
    return dump(data)


@rewrite
def entries_as_groups(text: str, data: Data, scene: GradedScene) -> str | None:
    """Static obstacles that differ only in their pose as one group with a list of poses."""
    groups: dict[str, list[Data]] = {}
    for section, _, entry in entries(data):
        if section != "obstacle" or "kinematics" in entry or "name" in entry or entry.get("number", 1) != 1:
            continue
        if is_pose(entry.get("state")):
            rest = {key: value for key, value in entry.items() if key != "state"}
            groups.setdefault(repr(sorted(rest.items())), []).append(entry)
    large = [group for group in groups.values() if len(group) > 1]
    if not large or not isinstance(data.get("obstacle"), list):
        return None
    for group in large:
        first, others = group[0], group[1:]
        states = [[*entry["state"], 0.0][:3] for entry in group]
        data["obstacle"] = [entry for entry in data["obstacle"] if not any(entry is other for other in others)]
        first.update({"number": len(group), "distribution": {"name": "manual"}, "state": states})
    return dump(data)


def mirrored(data: Data, axis: int) -> Data | None:
    """Everything mirrored about the middle of the world, along x (0) or y (1)."""
    world = data.get("world") or {}
    low, size = (world.get("offset") or [0.0, 0.0])[axis], world.get(("width", "height")[axis], 10.0)
    if world.get("obstacle_map") is not None:
        return None

    def pose(value: list[float]) -> list[float]:
        made = list(value)
        made[axis] = round(2 * low + size - made[axis], 9)
        if len(made) > 2:
            made[2] = round(math.pi - made[2] if axis == 0 else -made[2], 9)
        return made

    def poses(value: list[Any]) -> list[Any]:
        return [poses(item) for item in value] if isinstance(value[0], list) else pose(value)

    for *_, entry in entries(data):
        shape = entry.get("shape")
        if "distribution" in entry or isinstance(shape, list) or "sensors" in entry or entry.get("state") is None:
            return None
        for key in ("state", "goal", "waypoints"):
            if isinstance(entry.get(key), list) and entry[key]:
                entry[key] = poses(entry[key])
        if isinstance(shape, dict) and "vertices" in shape:
            # The heading is mirrored, too, so within the frame of the body only the sides change places.
            with_heading = len(entry["state"]) > 2
            if not with_heading:
                entry["state"] = [*entry["state"], math.pi if axis == 0 else 0.0]
            shape["vertices"] = [[x, -y] for x, y in shape["vertices"]]
    return data
