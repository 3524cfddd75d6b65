"""Mutants with other keys, names, drives, behaviors and numbers of objects."""

from __future__ import annotations

import copy
from collections.abc import Callable
from functools import partial
from operator import mul
from typing import Any

from irsim.options.registry import BEHAVIORS, KINEMATICS, Registry
from irsim_evals.proof.operators import Change, Data, component, each_entry, entries, is_pose, items_of, operator


def _built_in(registry: Registry) -> list[str]:
    """Features that can drive a robot to its goal whatever else its entry says."""
    return [f.name for f in registry.features() if f.kernel is not None and getattr(f.options, "needs_goal", True)]


def _each_key(data: Data, change: Callable[[str, Data], Any], what: str) -> Change:
    """A change of each key of each entry."""
    for section, number, entry in entries(data):
        for key in entry:
            made = copy.deepcopy(data)
            change(key, items_of(made, section)[number])
            yield f"{section}[{number}].{key} {what}", made


@operator
def world_size(data: Data) -> Change:
    """Width or height doubled, or both swapped."""
    for key in ("width", "height"):
        made = copy.deepcopy(data)
        if component("world", key, partial(mul, 2))(made):
            yield f"world.{key} doubled", made
    made = copy.deepcopy(data)
    world = made.get("world")
    if isinstance(world, dict) and "width" in world and "height" in world:
        world["width"], world["height"] = world["height"], world["width"]
        yield "width and height swapped", made


@operator
def map_changed(data: Data) -> Change:
    """A generated map with half of its share occupied, with larger cells, or of another seed."""
    for key, factor in (("fill", 0.5), ("resolution", 2), ("seed", 2)):
        made = copy.deepcopy(data)
        if component("obstacle_map", key, partial(mul, factor))(made.get("world") or {}):
            yield f"world.obstacle_map.{key} x {factor:g}", made


@operator
def world_dropped(data: Data) -> Change:
    """A key of the world left out."""
    for key in list(data.get("world") or {}):
        made = copy.deepcopy(data)
        del made["world"][key]
        yield f"world.{key} left out", made


@operator
def key_dropped(data: Data) -> Change:
    """A key of an entry left out."""
    yield from _each_key(data, lambda key, entry: entry.pop(key), "left out")


def _swapped(data: Data, key: str, names: list[str], kept: tuple[str, ...]) -> Change:
    """Each other name of the options under a key, without the options but for some."""
    for name in names:

        def change(entry: Data, name: str = name) -> Any:
            given = entry.get(key)
            if not isinstance(given, dict) or given.get("name") == name:
                return False
            options = {option: given[option] for option in kept or given if option in given}
            entry[key] = {**options, "name": name}
            return True

        yield from each_entry(data, change, f"{key} {name}")


@operator
def kinematics_swapped(data: Data) -> Change:
    """Another drive, with the same options."""
    yield from _swapped(data, "kinematics", _built_in(KINEMATICS), ())


@operator
def behavior_swapped(data: Data) -> Change:
    """Another behavior."""
    yield from _swapped(data, "behavior", _built_in(BEHAVIORS), ("wander", "loop", "range_low", "range_high"))


@operator
def number_changed(data: Data) -> Change:
    """One object more or less in a group."""
    for by in (1, -1):

        def change(entry: Data, by: int = by) -> Any:
            if not isinstance(entry.get("number"), int) or entry["number"] + by < 1:
                return False
            entry["number"] += by
            return True

        yield from each_entry(data, change, f"number {by:+d}")


@operator
def entry_dropped(data: Data) -> Change:
    """An entry left out."""
    for section, number, _ in entries(data):
        made = copy.deepcopy(data)
        if isinstance(made[section], list):
            del made[section][number]
        else:
            del made[section]
        yield f"{section}[{number}] left out", made


@operator
def entry_doubled(data: Data) -> Change:
    """An object too many, somewhere free."""
    for section, number, _ in entries(data):
        made = copy.deepcopy(data)
        items = items_of(made, section)
        extra = copy.deepcopy(items[number])
        extra.pop("name", None)
        extra["number"] = 1
        extra.pop("distribution", None)
        x, y = _free_corner(made)
        extra["state"] = [x, y, 0.0]
        made[section] = [*items, extra]
        yield f"{section}[{number}] once more", made


def _free_corner(data: Data) -> tuple[float, float]:
    world = data.get("world") or {}
    x, y = (world.get("offset") or [0.0, 0.0])[:2]
    return x + 0.93 * world.get("width", 10), y + 0.07 * world.get("height", 10)


@operator
def role_flipped(data: Data) -> Change:
    """A robot among the obstacles, or the other way round."""
    for section, number, _ in entries(data):
        made = copy.deepcopy(data)
        items = items_of(made, section)
        entry = items.pop(number)
        other = "obstacle" if section == "robot" else "robot"
        made[other] = [*items_of(made, other), entry]
        made[section] = items
        if not items:
            del made[section]
        yield f"{section}[{number}] among the {other}s", made


@operator
def key_mistyped(data: Data) -> Change:
    """A key with a letter too many."""
    yield from _each_key(data, lambda key, entry: entry.update({f"{key}s": entry.pop(key)}), "with an s")


@operator
def stacked(data: Data) -> Change:
    """A distribution left out, so that all objects of a group stand in one place."""

    def change(entry: Data) -> Any:
        if entry.get("number", 1) < 2 or entry.pop("distribution", None) is None:
            return False
        if isinstance(entry.get("state"), list) and isinstance((entry["state"] or [None])[0], list):
            entry["state"] = entry["state"][0]
        return True

    yield from each_entry(data, change, "without its distribution")


@operator
def plugged(data: Data) -> Change:
    """A big disc halfway between the start and the goal of a robot."""
    for section, number, entry in entries(data):
        a, b = entry.get("state"), entry.get("goal")
        if section != "robot" or not (is_pose(a) and is_pose(b)):
            continue
        made = copy.deepcopy(data)
        disc = {"shape": {"name": "circle", "radius": 1.0}, "state": [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 0.0]}
        made["obstacle"] = [*items_of(made, "obstacle"), disc]
        yield f"a disc between start and goal of {section}[{number}]", made


@operator
def cosmetic(data: Data) -> Change:
    """Names, colors and a lidar that were not asked for."""

    def paint(entry: Data) -> Any:
        if isinstance(entry.get("color"), list) or entry.get("color") == "cycle":
            return False
        entry["color"] = "purple"
        return True

    def rename(entry: Data) -> Any:
        if entry.get("number", 1) != 1 or "name" in entry:
            return False
        entry["name"] = "whatever"
        return True

    def sense(entry: Data) -> Any:
        if entry.get("sensors") or "kinematics" not in entry:
            return False
        entry["sensors"] = [{"name": "lidar2d", "number": 12, "range_max": 3}]
        return True

    yield from each_entry(data, paint, "another color")
    yield from each_entry(data, rename, "a name")
    yield from each_entry(data, sense, "a lidar")
