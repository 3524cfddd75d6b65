"""Mutants with other numbers: places, angles, sizes, units, limits, sensors, and several things moved at once."""

from __future__ import annotations

import copy
import itertools
import math
from functools import partial
from operator import add, mul
from typing import Any

from irsim.common.arguments import is_number
from irsim_evals.proof.operators import Change, Data, component, each_entry, entries, is_pose, items_of, operator


@operator
def layout_shifted(data: Data) -> Change:
    """All obstacles a metre away, together."""
    fixed = [entry for section, _, entry in entries(data) if section == "obstacle" and "kinematics" not in entry]
    if len(fixed) < 2 or not all(is_pose(entry.get("state")) for entry in fixed):
        return
    for axis, by in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)):
        made = copy.deepcopy(data)
        for section, _, entry in entries(made):
            if section == "obstacle" and "kinematics" not in entry:
                entry["state"][axis] += by
        yield f"all obstacles {'xy'[axis]} {by:+g} m", made


@operator
def moved_along(data: Data) -> Change:
    """Start and goal of one robot moved together, so that its way stays as long as it was."""
    for axis, by in ((0, 0.7), (1, 0.7), (0, -0.7), (1, -0.7)):

        def change(entry: Data, axis: int = axis, by: float = by) -> Any:
            if not (is_pose(entry.get("state")) and is_pose(entry.get("goal"))):
                return False
            entry["state"][axis] += by
            entry["goal"][axis] += by
            return True

        yield from each_entry(data, change, f"start and goal {'xy'[axis]} {by:+g} m")


@operator
def turned_about_the_middle(data: Data) -> Change:
    """Start and goal of one robot turned about the middle of all starts, as if a circle were uneven."""
    movers = [e for *_, e in entries(data) if is_pose(e.get("state")) and is_pose(e.get("goal"))]
    if len(movers) < 3:
        return
    x, y = (sum(entry["state"][k] for entry in movers) / len(movers) for k in (0, 1))
    c, s = math.cos(0.15), math.sin(0.15)

    def change(entry: Data) -> Any:
        if not (is_pose(entry.get("state")) and is_pose(entry.get("goal"))):
            return False
        for value in (entry["state"], entry["goal"]):
            dx, dy = value[0] - x, value[1] - y
            value[0], value[1] = x + c * dx - s * dy, y + s * dx + c * dy
        return True

    yield from each_entry(data, change, "turned about the middle")


@operator
def on_top(data: Data) -> Change:
    """Something solid on the start of something that moves."""
    solid = [entry for _, _, entry in entries(data) if not entry.get("unobstructed") and entry.get("number", 1) == 1]
    places = [entry["state"] for entry in solid if "kinematics" in entry and is_pose(entry.get("state"))]
    if not places:
        return

    def change(entry: Data) -> Any:
        shape = entry.get("shape")
        own = isinstance(shape, dict) and ("vertices" in shape or "center" in shape)
        if own or entry.get("number", 1) != 1 or not is_pose(entry.get("state")) or entry.get("unobstructed"):
            return False
        other = next((place for place in places if place != entry["state"]), None)
        if other is None:
            return False
        entry["state"][:2] = [other[0] + 0.02, other[1]]
        return True

    yield from each_entry(data, change, "on the start of another")


@operator
def goal_outside(data: Data) -> Change:
    """A goal a little outside of the world."""
    world = data.get("world") or {}
    edge = (world.get("offset") or [0.0, 0.0])[0] + world.get("width", 10) + 0.4

    def change(entry: Data) -> Any:
        if not is_pose(entry.get("goal")) or "kinematics" not in entry:
            return False
        entry["goal"][0] = edge
        return True

    yield from each_entry(data, change, "goal outside of the world")


@operator
def start_and_goal_swapped(data: Data) -> Change:
    """Start and goal exchanged."""

    def change(entry: Data) -> Any:
        a, b = entry.get("state"), entry.get("goal")
        if not (is_pose(a) and is_pose(b)):
            return False
        a[0], a[1], b[0], b[1] = b[0], b[1], a[0], a[1]
        return True

    yield from each_entry(data, change, "start and goal swapped")


@operator
def transposed(data: Data) -> Change:
    """x and y of a start or a goal exchanged."""
    for key in ("state", "goal"):

        def change(entry: Data, key: str = key) -> Any:
            value = entry.get(key, [])
            if not is_pose(value) or value[0] == value[1]:
                return False
            value[0], value[1] = value[1], value[0]
            return True

        yield from each_entry(data, change, f"x and y of {key} swapped")


@operator
def moved(data: Data) -> Change:
    """A start or a goal a metre away."""
    for key in ("state", "goal"):
        for number, by in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)):
            yield from each_entry(data, component(key, number, partial(add, by)), f"{key}[{number}] {by:+g} m")


@operator
def degrees_for_radians(data: Data) -> Change:
    """Angles in degrees."""

    def opening(entry: Data) -> Any:
        sensors = [s for s in entry.get("sensors") or [] if isinstance(s, dict) and "angle_range" in s]
        for sensor in sensors:
            sensor["angle_range"] = math.degrees(sensor["angle_range"])
        return bool(sensors)

    yield from each_entry(data, component("state", 2, math.degrees), "heading in degrees")
    yield from each_entry(data, opening, "opening angle in degrees")


@operator
def turned(data: Data) -> Change:
    """A heading a quarter turn off."""
    yield from each_entry(data, component("state", 2, partial(add, math.pi / 2)), "a quarter turn to the left")
    yield from each_entry(data, component("state", 2, partial(add, math.pi)), "half a turn")


@operator
def size_scaled(data: Data) -> Change:
    """Half or twice the size: a diameter for a radius, a half length for a length."""
    for key in ("radius", "length", "width"):
        for factor in (0.5, 2.0):
            yield from each_entry(data, component("shape", key, partial(mul, factor)), f"shape.{key} x {factor:g}")


@operator
def unit_unconverted(data: Data) -> Change:
    """Centimetres for metres, km/h for m/s."""
    for key in ("radius", "length", "width"):
        yield from each_entry(data, component("shape", key, partial(mul, 100.0)), f"shape.{key} in centimetres")
    yield from each_entry(data, component("vel_max", 0, partial(mul, 3.6)), "speed in km/h")


@operator
def limits_changed(data: Data) -> Change:
    """Half or twice a limit."""
    for key in ("vel_max", "vel_min"):
        for number in range(3):
            for factor in (0.5, 2.0):
                change = component(key, number, partial(mul, factor))
                yield from each_entry(data, change, f"{key}[{number}] x {factor:g}")


@operator
def sensor_changed(data: Data) -> Change:
    """Half or twice a parameter of a sensor."""
    for section, number, entry in entries(data):
        for k, sensor in enumerate(entry.get("sensors") or []):
            for key, factor in itertools.product(("range_max", "number", "angle_range"), (0.5, 2.0)):
                if isinstance(sensor, dict) and is_number(sensor.get(key)):
                    made = copy.deepcopy(data)
                    value = sensor[key] * factor
                    items_of(made, section)[number]["sensors"][k][key] = round(value) if key == "number" else value
                    yield f"{section}[{number}].sensors[{k}].{key} x {factor:g}", made
