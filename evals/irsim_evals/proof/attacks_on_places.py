"""Attacks on the layout: doors elsewhere, walls with gaps, mirrored worlds, bodies that are parked out of reach."""

from __future__ import annotations

import copy
import itertools
import math
from typing import Any

import numpy as np

from irsim_evals.proof.attacks import attack, rows_of
from irsim_evals.proof.operators import Change, Data, entries, items_of
from irsim_evals.proof.rewrites_of_layout import mirrored

_GAP = 0.9
"""Width of a gap in a wall [m]."""
_MIN_WALL = 1.5
"""Length from which on an obstacle counts as a wall [m]."""
_MAX_WALLS = 4
"""Number of walls that get a gap, and of doors that are moved."""


def _walls(data: Data) -> dict[int, tuple[np.ndarray, np.ndarray, float, str]]:
    """Number → middle, direction, length and key of the length of each obstacle that is a long fixed rectangle."""
    walls = {}
    for section, number, entry in entries(data):
        shape, rows = entry.get("shape"), rows_of(entry.get("state"))
        if section != "obstacle" or "kinematics" in entry or entry.get("number", 1) != 1 or len(rows) != 1:
            continue
        if isinstance(shape, dict) and shape.get("name") == "rectangle" and {"length", "width"} <= set(shape):
            key = max(("length", "width"), key=shape.__getitem__)
            angle = (rows[0][2] if len(rows[0]) > 2 else 0.0) + (math.pi / 2 if key == "width" else 0.0)
            if shape[key] >= _MIN_WALL:
                along = np.array([math.cos(angle), math.sin(angle)])
                walls[number] = (np.array(rows[0][:2]), along, float(shape[key]), key)
    return walls


def _set(entry: Data, middle: np.ndarray, key: str, length: float) -> None:
    entry["state"] = [*(round(float(value), 9) for value in middle), *entry["state"][2:]]
    entry["shape"][key] = length


@attack("doorway", "corridor", "pocket", "plan")
def walls_with_gaps(data: Data) -> Change:
    """A wall of two pieces with a gap between them."""
    for number, (middle, along, length, key) in itertools.islice(_walls(data).items(), _MAX_WALLS):
        made = copy.deepcopy(data)
        items = items_of(made, "obstacle")
        other = copy.deepcopy(items[number])
        other.pop("name", None)
        for piece, side in ((items[number], -1), (other, 1)):
            _set(piece, middle + side * (length + _GAP) / 4 * along, key, (length - _GAP) / 2)
        made["obstacle"] = [*items, other]
        yield f"a gap in obstacle[{number}]", made


@attack("doorway", "plan")
def doors_elsewhere(data: Data) -> Change:
    """A door as wide as before in another place of its wall: one piece of the wall is longer, the other shorter."""
    moved = 0
    for (i, a), (j, b) in itertools.permutations(_walls(data).items(), 2):
        across = np.array([-a[1][1], a[1][0]])
        apart = float((b[0] - a[0]) @ a[1])
        gap = apart - (a[2] + b[2]) / 2
        in_line = abs(float(b[1] @ across)) < 1e-6 and abs(float((b[0] - a[0]) @ across)) < 1e-3
        if not in_line or not 0.3 < gap < 4.0 or moved == _MAX_WALLS:
            continue
        moved += 1
        by = min(1.0, b[2] / 2)
        made = copy.deepcopy(data)
        items = items_of(made, "obstacle")
        _set(items[i], a[0] + by / 2 * a[1], a[3], a[2] + by)
        _set(items[j], b[0] + by / 2 * a[1], b[3], b[2] - by)
        yield f"the door between obstacle[{i}] and obstacle[{j}] {by:g} m on", made


def _mirror(data: Data, axis: int) -> Change:
    made = mirrored(copy.deepcopy(data), axis)
    if made is not None:
        yield f"{('left and right', 'up and down')[axis]} exchanged", made


@attack("beside", "goal_dx", "crosses", "one_way", "visits", "plan")
def mirror_x(data: Data) -> Change:
    """Left and right exchanged."""
    yield from _mirror(data, 0)


@attack("beside", "goal_dy", "crosses", "one_way", "visits", "plan")
def mirror_y(data: Data) -> Change:
    """Up and down exchanged."""
    yield from _mirror(data, 1)


@attack("crosses")
def parked_away(data: Data) -> Change:
    """A moving obstacle whose way lies in the corner of the world that is farthest from the robots."""
    world = data.get("world") or {}
    low = np.array((world.get("offset") or [0.0, 0.0])[:2], dtype=float)
    high = low + np.array([world.get("width", 10.0), world.get("height", 10.0)])
    robots = [row for section, _, entry in entries(data) if section == "robot" for row in rows_of(entry.get("state"))]
    for section, number, entry in entries(data):
        points = [row[:2] for key in ("state", "goal") for row in rows_of(entry.get(key))]
        if section != "obstacle" or not entry.get("behavior") or len(points) != 2 or not robots:
            continue
        way = np.array(points)
        places = [
            np.where(corner, high - 0.3 - way.max(axis=0), low + 0.3 - way.min(axis=0))
            for corner in itertools.product((False, True), repeat=2)
        ]
        by = max(places, key=lambda by: min(math.dist(way.mean(axis=0) + by, robot[:2]) for robot in robots))
        made = copy.deepcopy(data)
        changed: Any = items_of(made, section)[number]
        for key in ("state", "goal"):
            changed[key] = [*(round(float(value), 9) for value in np.array(changed[key][:2]) + by), *changed[key][2:]]
        yield f"{section}[{number}]: parked in a corner", made
