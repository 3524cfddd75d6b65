"""Entries of a scenario: drive, footprint, limits and sensors of a group of bodies."""

from __future__ import annotations

import math
from typing import Any

from irsim_evals.baselines.reading.request import Group, Request

__all__ = ["Entry", "half_extent", "lidar", "person", "robot", "static_body"]

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


def static_body(group: Group) -> Entry:
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
