"""Arrangements: walls, corridors, doorways, traps, rings; and the bodies that stand or drive in them."""

from __future__ import annotations

import math
from typing import Any

from irsim_evals.baselines.request import Group, Request

__all__ = [
    "Entry", "Frame", "Point", "add_obstacles", "add_walls", "half_extent", "lidar", "number_of",
    "person", "place_robots", "ring_of_robots", "robot", "short",
]  # fmt: skip

Entry = dict[str, Any]

_ROBOT_RADIUS = 0.3
_PERSON_RADIUS = 0.25
_OBSTACLE_RADIUS = 0.5
_BOX_SIDE = 1.0
_SPEED = 1.0
_WALKING_SPEED = 1.0
_FULL_TURN = 6.28318
"""Largest field of view of a lidar [rad]."""
_DEFAULT_BEAMS = 181


def robot(group: Group, request: Request) -> Entry:
    """Entry of a group of robots, without number, places and goals."""
    drive = group.drive or "diff"
    speed = float(group.facts.get("speed", _SPEED))
    turn = float(group.facts.get("turn", 1.5))
    side = float(group.facts.get("sideways", speed))
    steer = float(group.facts.get("steer", 0.6))
    limits = {
        "diff": [speed, turn],
        "omni": [speed, side],
        "omni_angular": [speed, side, turn],
        "acker": [speed, steer],
    }[drive]
    lowest = [-value for value in limits]
    if request.no_reverse:
        lowest[0] = 0.0
    entry: Entry = {
        "kinematics": {"name": drive},
        "shape": _shape(group, _ROBOT_RADIUS),
        "vel_max": [round(value, 6) for value in limits],
        "vel_min": [round(value, 6) for value in lowest],
    }
    if drive == "acker":
        length = entry["shape"].setdefault("length", 2 * entry["shape"].pop("radius", 0.9))
        entry["shape"] = {"name": "rectangle", "length": length, "width": entry["shape"].get("width", length / 2)}
        entry["shape"]["wheelbase"] = float(group.facts.get("wheelbase", round(0.6 * length, 3)))
    if request.lidars:
        entry["sensors"] = [lidar(facts) for facts in request.lidars]
    if request.colors:
        entry["color"] = "cycle"
    return entry


def person(group: Group, behavior: str) -> Entry:
    """Entry of people who walk."""
    speed = float(group.facts.get("speed", _WALKING_SPEED))
    options: Entry = {"name": behavior}
    if behavior == "rvo":
        options |= {"vxmax": speed, "vymax": speed}
    if behavior == "sfm":
        options |= {"vmax": speed}
    return {
        "kinematics": {"name": "omni"},
        "shape": {"name": "circle", "radius": float(group.facts.get("radius", _PERSON_RADIUS))},
        "vel_max": [speed, speed],
        "vel_min": [-speed, -speed],
        "behavior": options,
    }


def _static_body(group: Group) -> Entry:
    """Entry of obstacles that stand still."""
    if group.shape == "polygon":
        return {
            "shape": {"name": "polygon", "vertices": [[-0.5, -0.4], [0.5, -0.4], [0.6, 0.2], [0, 0.6], [-0.6, 0.2]]}
        }
    return {"shape": _shape(group, _OBSTACLE_RADIUS)}


def lidar(facts: dict[str, Any]) -> Entry:
    """Entry of a lidar."""
    angle = min(float(facts.get("angle", _FULL_TURN)), _FULL_TURN)
    beams = int(facts.get("beams", _DEFAULT_BEAMS))
    if "per_degree" in facts and "beams" not in facts:
        beams = round(math.degrees(angle)) + 1
    entry: Entry = {
        "name": facts.get("name", "lidar2d"),
        "range_max": float(facts.get("range", 5.0)),
        "angle_range": round(angle, 6),
        "number": beams,
    }
    if "mount" in facts:
        entry["offset"] = [0, 0, round(facts["mount"], 6)]
    if "velocity_noise" in facts:
        entry["velocity_noise_std"] = float(facts["velocity_noise"])
    if "motion_compensate" in facts:
        entry["motion_compensate"] = True
    return entry


def half_extent(entry: Entry) -> float:
    """Radius of a disc that holds the footprint of an entry [m]."""
    shape = entry["shape"]
    if "radius" in shape:
        return float(shape["radius"])
    if "vertices" in shape:
        return max(math.hypot(x, y) for x, y in shape["vertices"])
    return math.hypot(float(shape["length"]), float(shape["width"])) / 2


def _shape(group: Group, radius: float) -> Entry:
    facts = group.facts
    if "size" in facts:
        return {"name": "rectangle", "length": float(facts["size"][0]), "width": float(facts["size"][1])}
    if "length" in facts:
        width = float(facts.get("width", facts["length"] / 2))
        return {"name": "rectangle", "length": float(facts["length"]), "width": width}
    if group.shape == "rectangle":
        side = float(facts.get("side", facts.get("width", _BOX_SIDE)))
        return {"name": "rectangle", "length": side, "width": side}
    if "diameter" in facts:
        radius = float(facts["diameter"]) / 2
    return {"name": "circle", "radius": float(facts.get("radius", radius))}


_THICKNESS = 0.2
"""Thickness of a wall [m]."""
_MARGIN = 0.1
"""Distance from the edge of the world at which robots start, as a share of its size."""

Point = tuple[float, float]
Frame = tuple[float, float, float, float]
"""x0, y0, x1, y1 of the free space in which things are placed [m]."""


def add_walls(request: Request, frame: Frame, obstacles: list[Entry]) -> Frame:
    """Add corridor, doorway, trap and walls round the world; returns the space that is left for robots."""
    x0, y0, x1, y1 = frame
    parts = request.parts
    if "corridor" in parts:
        width = float(parts["corridor"].get("width", parts["corridor"].get("depth", 2.0)))
        middle = (y0 + y1) / 2
        for side in (-1, 1):
            y = middle + side * (width / 2 + _THICKNESS / 2)
            obstacles.append(_wall(((x0 + x1) / 2, y), x1 - x0, 0.0))
        return (x0, middle - width / 2, x1, middle + width / 2)
    if "trap" in parts:
        width, depth = float(parts["trap"].get("width", 3.0)), float(parts["trap"].get("depth", 2.0))
        back, middle = x0 + 0.6 * (x1 - x0), (y0 + y1) / 2
        obstacles.append(_wall((back + _THICKNESS / 2, middle), width + 2 * _THICKNESS, math.pi / 2))
        for side in (-1, 1):
            obstacles.append(_wall((back - depth / 2, middle + side * (width + _THICKNESS) / 2), depth, 0.0))
    elif "doorway" in parts:
        door = float(parts["doorway"].get("width", 1.2))
        x, middle = (x0 + x1) / 2, (y0 + y1) / 2
        length = max(0.1, (y1 - y0 - door) / 2)
        for y in (y0 + length / 2, y1 - length / 2):
            obstacles.append(_wall((x, y), length, math.pi / 2))
        return (x0, y0, x1, middle - door / 2)
    if "walls" in request.layouts:
        corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]]
        obstacles.append({"shape": {"name": "linestring", "vertices": corners}, "state": [0, 0, 0]})
    return frame


def _wall(middle: tuple[float, float], length: float, heading: float) -> Entry:
    shape = {"name": "rectangle", "length": round(length, 6), "width": _THICKNESS}
    return {"shape": shape, "state": [round(middle[0], 6), round(middle[1], 6), round(heading, 6)]}


def ring_of_robots(entry: Entry, number: int, radius: float, frame: Frame) -> None:
    """Put robots on a circle, each with the place opposite as its goal."""
    x0, y0, x1, y1 = frame
    entry["number"] = number
    entry["distribution"] = {"name": "circle", "center": [(x0 + x1) / 2, (y0 + y1) / 2], "radius": radius}


def place_robots(request: Request, entries: list[tuple[Group, Entry, int]], frame: Frame) -> None:
    """Give every robot a start and a goal: the points of the request, else its directions, else from left to right."""
    starts = [place.point for place in request.places if place.role == "start" and place.point is not None]
    goals = [place.point for place in request.places if place.role == "goal" and place.point is not None]
    total = sum(number for _, _, number in entries)
    rows, done = _rows(request, frame, total, entries), 0
    heading = next((p.signs for p in request.places if p.role == "heading"), None)
    goal_heading = next((p.signs for p in request.places if p.role == "goal-heading"), None)
    for group, entry, number in entries:
        states, ends = [], []
        for _ in range(number):
            start, goal = rows[done]
            start = starts[done] if done < len(starts) else start
            goal = goals[done] if done < len(goals) else goal
            angle = math.atan2(goal[1] - start[1], goal[0] - start[0])
            if heading is not None:
                angle = math.atan2(heading[1], heading[0])
            states.append([*short(start), round(angle, 4)])
            ends.append(
                [*short(goal), *([round(math.atan2(goal_heading[1], goal_heading[0]), 4)] if goal_heading else [])]
            )
            done += 1
        if goal_heading is not None:
            entry["arrive_mode"], entry["goal_threshold"] = "state", float(group.facts.get("threshold", 0.1))
        if number == 1:
            entry["state"], entry["goal"] = states[0], ends[0]
        else:
            entry["number"], entry["state"], entry["goal"] = number, states, ends


def _rows(
    request: Request, frame: Frame, total: int, entries: list[tuple[Group, Entry, int]]
) -> list[tuple[Point, Point]]:
    """Start and goal of each robot, side by side on the way that the directions of the request give."""
    x0, y0, x1, y1 = frame
    ways = [place for place in request.places if place.point is None]
    given_start = next((place.signs for place in ways if place.role == "start"), None)
    given_goal = next((place.signs for place in ways if place.role == "goal"), None)
    centered = "in the middle" in request.text and "people" not in request.text and not request.obstacles
    goal = given_goal or (_opposite(given_start) if given_start else (1.0, 0.0))
    start = given_start or ((0.0, 0.0) if centered and given_goal else _opposite(goal))
    largest = max((half_extent(entry) for _, entry, _ in entries), default=0.3)
    least = 0.04 if "corridor" in request.parts else _MARGIN

    def spot(signs: tuple[float, float], share: float) -> tuple[float, float]:
        inner = 0.5 - max(least, min(0.4, 1.5 * largest / max(x1 - x0, y1 - y0, 1e-6)))
        spread = 1 - 2 * _MARGIN
        if "swap" in request.layouts:
            spread = min(spread, 2.7 * largest * total / max(min(x1 - x0, y1 - y0), 1e-6))
        across = (share - 0.5) * spread
        x = 0.5 + signs[0] * inner + (across if signs[0] == 0 and signs[1] != 0 else 0)
        y = 0.5 + signs[1] * inner + (across if signs[1] == 0 and signs[0] != 0 else 0)
        return x0 + x * (x1 - x0), y0 + y * (y1 - y0)

    rows = []
    for k in range(total):
        share = (k + 0.5) / total
        a, b = spot(start, share), spot(goal, share)
        rows.append((b, a) if "swap" in request.layouts and k % 2 else (a, b))
    return rows


def _opposite(signs: Point) -> Point:
    return -signs[0], -signs[1]


def add_obstacles(request: Request, frame: Frame, obstacles: list[Entry]) -> None:
    """Add the obstacles of the request: at its points, in the middle, or spread round the middle."""
    x0, y0, x1, y1 = frame
    points = [place.point for place in request.places if place.role == "obstacle" and place.point is not None]
    total = sum(number_of(group, 3) for group in request.obstacles)
    done = 0
    for group in request.obstacles:
        number = number_of(group, 3)
        if number == 0:
            continue
        entry = _static_body(group)
        if "random" in request.layouts and not points:
            low, high = [x0 + 1.5, y0 + 1.5, -3.14], [x1 - 1.5, y1 - 1.5, 3.14]
            entry |= {"number": number, "distribution": {"name": "random", "range_low": low, "range_high": high}}
            obstacles.append(entry)
            continue
        spots = []
        for _ in range(number):
            if done < len(points):
                spots.append(points[done])
            elif (
                "middle" in request.text or "mitte" in request.text or "中间" in request.text or "medio" in request.text
            ):
                spots.append(((x0 + x1) / 2, y0 + (done + 1) / (total + 1) * (y1 - y0)))
            else:
                angle = 2 * math.pi * (done + 0.5) / total
                spots.append(
                    (
                        (x0 + x1) / 2 + 0.3 * (x1 - x0) * math.cos(angle),
                        (y0 + y1) / 2 + 0.3 * (y1 - y0) * math.sin(angle),
                    )
                )
            done += 1
        states: Any = [[*short(spot), 0] for spot in spots]
        obstacles.append(entry | ({"state": states[0]} if number == 1 else {"number": number, "state": states}))


def number_of(group: Group, default: int) -> int:
    """How many bodies a group has, at most 500."""
    return default if group.number is None else min(group.number, 500)


def short(point: Point) -> list[float]:
    """A point with four decimals."""
    return [round(float(point[0]), 4), round(float(point[1]), 4)]
