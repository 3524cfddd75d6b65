"""A scenario as a whole with its people, and the reply that goes with it."""

from __future__ import annotations

import math
import re
from typing import Any

from irsim_evals.baselines import layouts
from irsim_evals.baselines.edits import entries
from irsim_evals.baselines.language import DIRECTIONS
from irsim_evals.baselines.layouts import Entry, Frame, Point, half_extent, number_of, person, robot, short
from irsim_evals.baselines.request import Group, Request

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
        _add_people(request, frame, robots, obstacles)
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
    way = _way_of_robot(request, frame)
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


_CROWD_DENSITY = 0.25
"""People for each square metre of a crowd."""
_STAGGER_S = 1.2
"""Time between two people who cross one after the other [s]."""
_FIRST_S = 1.5
"""Time after which the first of them crosses [s]."""
_DRIVES = (
    r"(?:drives?|goes|moves?|heads?|travels?|runs?|fährt|va|avanza|conduce|circula|行驶|驶)"
    r"\s*(?:to the |nach |hacia el |al |straight )?"
)
_SOME = r"(\d+)(?: of them)? ?(?:people|persons?|pedestrians?|walkers?)?"
_TOWARDS = rf"{_SOME} (?:walk|come|move|approach)\w* ?(?:towards?|nearer|closer|up to|it\b)"
_AWAY = rf"{_SOME} (?:walk|go|move)\w* away"
_OTHERS = r"(\d+) (?:others|more people|other people|weitere|otros|otras)"

Way = tuple[Point, Point]


def _add_people(request: Request, frame: Frame, robots: list[Entry], obstacles: list[Entry]) -> None:
    """Add the people of the request to the obstacles."""
    x0, y0, x1, y1 = frame
    group = Group(None, None, "circle")
    for one in request.people:
        group.number = one.number if group.number is None else group.number
        group.facts = {**one.facts, **group.facts}
    number = number_of(group, 4)
    if "crowd" in request.layouts and group.number is None:
        number = max(6, round(_CROWD_DENSITY * (x1 - x0) * (y1 - y0)))
    avoiding = request.behavior if request.behavior in ("orca", "rvo", "sfm") else None
    if "wander" in request.layouts or "crowd" in request.layouts:
        entry = person(group, avoiding or "sfm")
        entry["behavior"]["wander"] = True
        low, high = [x0 + 0.5, y0 + 0.5, -3.14], [x1 - 0.5, y1 - 0.5, 3.14]
        entry["distribution"] = {"name": "random", "range_low": low, "range_high": high}
        obstacles.append(entry | {"number": number})
        return
    if "talking" in request.layouts:
        obstacles.append(_talking(group, number, float(request.parts.get("ring", {}).get("diameter", 1.6)), frame))
        others = re.search(_OTHERS, request.text)
        number = int(others[1]) if others else 0
    ways = _ways(request, number, frame, robots, float(group.facts.get("speed", 1.0)))
    if not ways:
        return
    entry = person(group, avoiding or "dash")
    states: Any = [[*short(a), round(math.atan2(b[1] - a[1], b[0] - a[0]), 4)] for a, b in ways]
    goals: Any = [short(b) for _, b in ways]
    if len(ways) == 1:
        obstacles.append(entry | {"state": states[0], "goal": goals[0]})
    else:
        obstacles.append(entry | {"number": len(ways), "state": states, "goal": goals})


def _way_of_robot(request: Request, frame: Frame) -> Way | None:
    """The way of a robot before which people cross; None if there are no crossings."""
    if "crossing" not in request.layouts or not request.people:
        return None
    along = next((s for words, s in DIRECTIONS if re.search(rf"{_DRIVES}(?:{words})", request.text)), (1.0, 0.0))
    x0, y0, x1, y1 = frame
    middle = ((x0 + x1) / 2, (y0 + y1) / 2)
    half = 0.5 * min((x1 - x0) / max(abs(along[0]), 1e-9), (y1 - y0) / max(abs(along[1]), 1e-9)) - 1.0
    return (
        (middle[0] - half * along[0], middle[1] - half * along[1]),
        (middle[0] + half * along[0], middle[1] + half * along[1]),
    )


def _ways(request: Request, number: int, frame: Frame, robots: list[Entry], speed: float) -> list[Way]:
    towards, away = re.search(_TOWARDS, request.text), re.search(_AWAY, request.text)
    if (towards or away) and robots and "state" in robots[0]:
        return _radial(int(towards[1]) if towards else 0, int(away[1]) if away else 0, frame, robots[0]["state"])
    way = _way_of_robot(request, frame)
    if way is not None:
        return _crossing(request, number, frame, way, speed)
    x0, y0, x1, y1 = frame
    width, height = x1 - x0, y1 - y0
    ways: list[Way] = []
    for k in range(number):
        y = y0 + (0.15 + 0.7 * (k + 0.5) / number) * height
        if "corridor" in request.parts or "both-ways" in request.layouts:
            step = (k // 2 + 1) * 0.8 / (number + 2) * width
            left, right = (x0 + step, y), (x1 - step, y)
            ways.append((left, (x1 - 0.04 * width, y)) if k % 2 else (right, (x0 + 0.04 * width, y)))
        else:
            y = y0 + (0.25 + 0.5 * (k + 0.5) / number) * height
            ways.append(((x1 - 0.08 * width, y), (x0 + 0.08 * width, y)))
    return ways


def _crossing(request: Request, number: int, frame: Frame, way: Way, speed: float) -> list[Way]:
    """People who cross a way from one side, each farther away and farther along than the one before."""
    (sx, sy), (gx, gy) = way
    length = math.dist(*way)
    dx, dy = (gx - sx) / length, (gy - sy) / length
    side = (
        -1.0 if re.search(r"from (?:its|the|his|the robot's)? ?left|von links|de izquierda|从左", request.text) else 1.0
    )
    rx, ry = side * dy, -side * dx
    room = 0.5 * min((frame[2] - frame[0]) / max(abs(rx), 1e-9), (frame[3] - frame[1]) / max(abs(ry), 1e-9)) - 0.5
    ways: list[Way] = []
    for k in range(number):
        far = min(room, (_FIRST_S + _STAGGER_S * k) * speed)
        s = length * (0.4 + 0.5 * (k + 0.5) / number)
        spot = (sx + s * dx, sy + s * dy)
        end = min(room, 4.0)
        ways.append(((spot[0] + far * rx, spot[1] + far * ry), (spot[0] - end * rx, spot[1] - end * ry)))
    return ways


def _radial(towards: int, away: int, frame: Frame, pose: list[float]) -> list[Way]:
    """People in front of a robot who come nearer or go away."""
    x, y, heading = pose
    far = 0.6 * max(frame[2] - frame[0], frame[3] - frame[1])
    ways: list[Way] = []
    for k in range(towards + away):
        angle = heading + (k + 0.5 - (towards + away) / 2) * 0.45
        near_spot = (x + 2.0 * math.cos(angle), y + 2.0 * math.sin(angle))
        far_spot = (x + far * math.cos(angle), y + far * math.sin(angle))
        ways.append((far_spot, near_spot) if k < towards else (near_spot, far_spot))
    return ways


def _talking(group: Group, number: int, across: float, frame: Frame) -> Entry:
    """People on a circle who face its middle."""
    x, y = (frame[0] + frame[2]) / 2, (frame[1] + frame[3]) / 2
    states = []
    for k in range(number):
        angle = 2 * math.pi * k / number
        spot = (x + across / 2 * math.cos(angle), y + across / 2 * math.sin(angle))
        states.append([*short(spot), round(math.remainder(angle + math.pi, 2 * math.pi), 4)])
    return {"number": number, "shape": {"name": "circle", "radius": group.facts.get("radius", 0.25)}, "state": states}
