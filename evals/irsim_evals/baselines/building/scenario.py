"""A scenario as a whole, and the reply that goes with it."""

from __future__ import annotations

import math
from typing import Any

from irsim_evals.baselines.building import layouts, people
from irsim_evals.baselines.building.bodies import Entry, half_extent, robot
from irsim_evals.baselines.edits import entries
from irsim_evals.baselines.reading.request import Group, Request

__all__ = ["build", "describe"]

_SIZE = (14.0, 12.0)
"""Width and height of a world whose size the request leaves open [m]."""


def build(request: Request) -> dict[str, Any]:
    """The scenario that a request asks for, as far as the rules go."""
    width, height = _world_size(request)
    x0, y0 = _corner(request, width, height)
    world: dict[str, Any] = {"width": width, "height": height}
    if (x0, y0) != (0.0, 0.0):
        world["offset"] = [x0, y0]
    for key in ("step_time", "time_limit"):
        if key in request.whole:
            world[key] = request.whole[key]
    if "perlin" in request.layouts:
        world["obstacle_map"] = {
            "name": "perlin",
            "resolution": request.whole.get("cell", 0.2),
            "fill": round(request.whole.get("fill", 0.2), 4),
            "seed": int(request.whole.get("seed", 1)),
        }
    elif "seed" in request.whole:
        world["seed"] = int(request.whole["seed"])
    if "fog" in request.layouts:
        world["fog_map"] = True
        world["fog_map_resolution"] = request.whole.get("cell", 0.25)
    obstacles: list[Entry] = []
    frame = layouts.add_walls(request, (x0, y0, x0 + width, y0 + height), obstacles)
    robots = _robots(request, frame)
    layouts.add_obstacles(request, frame, obstacles)
    if request.people or ("crowd" in request.layouts):
        people.add_people(request, frame, robots, obstacles)
    scenario: dict[str, Any] = {"world": world}
    if robots:
        scenario["robot"] = robots
    if obstacles:
        scenario["obstacle"] = obstacles
    return scenario


def _world_size(request: Request) -> tuple[float, float]:
    if request.size is not None:
        return request.size
    corridor = request.parts.get("corridor")
    if corridor is not None:
        return float(corridor.get("length", 12.0)), float(corridor.get("width", 2.0)) + 2
    ring = request.parts.get("ring", {})
    if "radius" in ring:
        side = 2 * float(ring["radius"]) + 3
        return side, side
    apart = max((group.facts.get("apart", 0.0) for group in request.robots), default=0.0)
    points = [place.point for place in request.places if place.point is not None]
    far = [1.5 + max((point[axis] for point in points), default=0.0) for axis in (0, 1)]
    room = max((facts.get("range", 0.0) for facts in request.lidars), default=0.0)
    return max(_SIZE[0], 1.4 * apart, far[0], room + 4), max(_SIZE[1], far[1])


def _corner(request: Request, width: float, height: float) -> tuple[float, float]:
    """The lower left corner: coordinates that run from a negative number belong to both axes."""
    low = request.whole.get("low")
    if low is None or low >= 0:
        return 0.0, 0.0
    return (low, low) if width == height else (-width / 2, -height / 2)


def _robots(request: Request, frame: layouts.Frame) -> list[Entry]:
    groups = [group for group in request.robots if group.number != 0]
    if not groups:
        if request.people and not request.lidars:
            return []
        groups = [Group(1, None, "circle")]
    entries = []
    for group in groups:
        number = min(group.number or 1, 500)
        if group.number is None and len(groups) == 1 and "swap" in request.layouts:
            number = 2
        entries.append((group, robot(group, request), number))
    total = sum(number for _, _, number in entries)
    behavior = request.behavior or ("orca" if total > 1 else "dash")
    for _, entry, number in entries:
        if "parked" in request.layouts and total == 1:
            entry.pop("vel_max"), entry.pop("vel_min"), entry.pop("kinematics")
        elif not request.undriven:
            entry["behavior"] = _behavior(behavior if behavior != "sfm" or not request.people else "dash", entry)
        if "random" in request.layouts and "wander" not in request.layouts:
            margin = half_extent(entry) + 0.2
            x0, y0, x1, y1 = frame
            entry["number"] = number
            entry["distribution"] = {
                "name": "random",
                "range_low": [round(x0 + margin, 3), round(y0 + margin, 3), -3.14],
                "range_high": [round(x1 - margin, 3), round(y1 - margin, 3), 3.14],
            }
        elif ("ring" in request.parts or "opposite" in request.layouts) and total > 1 and not request.people:
            radius = float(
                request.parts.get("ring", {}).get("radius", 0.4 * min(frame[2] - frame[0], frame[3] - frame[1]))
            )
            layouts.ring_of_robots(entry, number, radius, frame)
    placed = [item for item in entries if "distribution" not in item[1]]
    layouts.place_robots(request, placed, frame)
    way = people.way_of_robot(request, frame)
    if way is not None and total == 1 and placed:
        (sx, sy), (gx, gy) = way
        placed[0][1]["state"] = [*layouts.short(way[0]), round(math.atan2(gy - sy, gx - sx), 4)]
        placed[0][1]["goal"] = layouts.short(way[1])
    for _, entry, _ in placed:
        if "behavior" not in entry and not request.undriven:
            entry.pop("goal", None)
    return [entry for _, entry, _ in entries]


def _behavior(name: str, entry: Entry) -> Entry:
    options: Entry = {"name": name}
    if name == "rvo":
        options |= {"vxmax": entry["vel_max"][0], "vymax": entry["vel_max"][0]}
    return options


def describe(scenario: dict[str, Any]) -> str:
    """The assumptions, in words and numbers of the scenario."""
    world = scenario["world"]
    facts = [f"the world is {world['width']:g} x {world['height']:g} m"]
    for section, noun in (("robot", "robots"), ("obstacle", "obstacles")):
        for entry in scenario.get(section, []):
            number, radius = entry.get("number", 1), entry["shape"].get("radius")
            words = f"{number} {noun if number != 1 else noun[:-1]}"
            if section == "obstacle" and "kinematics" in entry:
                words = f"{number} people" if number != 1 else "1 person"
            words += f" of radius {radius:g} m" if radius else ""
            words += f", top speed {entry['vel_max'][0]:g} m/s" if "vel_max" in entry else ""
            facts.append(words + (f", behavior {entry['behavior']['name']}" if "behavior" in entry else ""))
    words = "Assumed, where the request leaves it open: " + "; ".join(facts) + "."
    names = {entry["behavior"]["name"] for _, entry in entries(scenario, "robot") if "behavior" in entry}
    if names & {"orca", "rvo", "sfm"}:
        words += f" No guarantee: {', '.join(sorted(names))} is a local law and can stop or touch where it is tight."
    if any(entry["kinematics"]["name"] == "acker" for _, entry in entries(scenario, "robot") if "kinematics" in entry):
        words += " A car cannot turn on the spot."
    return words
