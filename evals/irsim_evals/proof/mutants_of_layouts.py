"""Mutants that move several things at once, or something to where it must never be."""

from __future__ import annotations

import copy
import math
from typing import Any

from irsim_evals.proof.mutant import Change, Data, entries, operator, with_entry


def _is_pose(value: Any) -> bool:
    return isinstance(value, list) and len(value) > 1 and isinstance(value[0], (int, float))


@operator
def layout_shifted(data: Data) -> Change:
    """All obstacles a metre away, together."""
    fixed = [entry for section, _, entry in entries(data) if section == "obstacle" and "kinematics" not in entry]
    if len(fixed) < 2 or not all(_is_pose(entry.get("state")) for entry in fixed):
        return
    for component, by in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)):
        made = copy.deepcopy(data)
        for section, _, entry in entries(made):
            if section == "obstacle" and "kinematics" not in entry:
                entry["state"][component] += by
        yield f"all obstacles {'xy'[component]} {by:+g} m", made


@operator
def moved_along(data: Data) -> Change:
    """Start and goal of one robot moved together, so that its way stays as long as it was."""
    for section, number, _ in entries(data):
        for component, by in ((0, 0.7), (1, 0.7), (0, -0.7), (1, -0.7)):

            def change(entry: Data, component: int = component, by: float = by) -> Any:
                if not (_is_pose(entry.get("state")) and _is_pose(entry.get("goal"))):
                    return False
                entry["state"][component] += by
                entry["goal"][component] += by
                return True

            made = with_entry(data, section, number, change)
            if made is not None:
                yield f"{section}[{number}]: start and goal {'xy'[component]} {by:+g} m", made


@operator
def turned_about_the_middle(data: Data) -> Change:
    """Start and goal of one robot turned about the middle of all starts, as if a circle were uneven."""
    movers = [(s, n, e) for s, n, e in entries(data) if _is_pose(e.get("state")) and _is_pose(e.get("goal"))]
    if len(movers) < 3:
        return
    x, y = (sum(entry["state"][k] for _, _, entry in movers) / len(movers) for k in (0, 1))
    c, s = math.cos(0.15), math.sin(0.15)

    def change(entry: Data) -> Any:
        for value in (entry["state"], entry["goal"]):
            dx, dy = value[0] - x, value[1] - y
            value[0], value[1] = x + c * dx - s * dy, y + s * dx + c * dy

    for section, number, _ in movers:
        made = with_entry(data, section, number, change)
        if made is not None:
            yield f"{section}[{number}]: turned about the middle", made


@operator
def on_top(data: Data) -> Change:
    """Something solid on the start of something that moves."""
    solid = [entry for _, _, entry in entries(data) if not entry.get("unobstructed") and entry.get("number", 1) == 1]
    places = [entry["state"] for entry in solid if "kinematics" in entry and _is_pose(entry.get("state"))]
    if not places:
        return
    for section, number, _ in entries(data):

        def change(entry: Data) -> Any:
            shape = entry.get("shape")
            own = isinstance(shape, dict) and ("vertices" in shape or "center" in shape)
            if own or entry.get("number", 1) != 1 or not _is_pose(entry.get("state")) or entry.get("unobstructed"):
                return False
            other = next((place for place in places if place != entry["state"]), None)
            if other is None:
                return False
            entry["state"][:2] = [other[0] + 0.02, other[1]]
            return True

        made = with_entry(data, section, number, change)
        if made is not None:
            yield f"{section}[{number}]: on the start of another", made


@operator
def goal_outside(data: Data) -> Change:
    """A goal a little outside of the world."""
    world = data.get("world") or {}
    edge = (world.get("offset") or [0.0, 0.0])[0] + world.get("width", 10) + 0.4
    for section, number, _ in entries(data):

        def change(entry: Data) -> Any:
            if not _is_pose(entry.get("goal")) or "kinematics" not in entry:
                return False
            entry["goal"][0] = edge
            return True

        made = with_entry(data, section, number, change)
        if made is not None:
            yield f"{section}[{number}]: goal outside of the world", made
