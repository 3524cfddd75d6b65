"""Overlays of a snapshot: what it shows besides bodies, such as names, free space and planned paths."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Literal

import numpy as np

from irsim.common.outline import Polygon
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import nearest
from irsim.diagnostics.errors import InputError
from irsim.episodes.planned_routes import planned_routes
from irsim.episodes.scene_summary import called
from irsim.results.picture import RobotPlan

if TYPE_CHECKING:
    from irsim.common.arrays import Floats
    from irsim.env import Env
    from irsim.graphics.scene.scene import Scene
    from irsim.rendering.planned_paths import PlannedPath
    from irsim.rendering.snapshot import Extra

__all__ = [
    "OVERLAYS",
    "Overlay",
    "additions",
    "footprint_of",
    "overlays_from",
    "plan_results",
    "plot_keys",
    "requested_plans",
]

_MAX_POSES = 2000
"""Greatest number of poses along a path."""
_POSE_STEP_M = 0.05
"""Distance between poses along a path, unless that takes too many [m]."""
Overlay = Literal["names", "goals", "paths", "sensors", "zones", "clearance", "plan"]
OVERLAYS: dict[Overlay, tuple[str, ...]] = {
    "names": ("show_text", "show_goal_text"),
    "goals": ("show_goal",),
    "paths": ("show_trajectory",),
    "sensors": ("show_sensor",),
    "zones": (),
    "clearance": (),
    "plan": (),
}
"""Overlays, and the plot keys that switch each of them."""


def overlays_from(words: Iterable[str]) -> list[Overlay]:
    """The overlays with some names.

    Raises:
        InputError: A name does not belong to an overlay.
    """
    known: dict[str, Overlay] = {name: name for name in OVERLAYS}
    asked = [word.strip() for word in words if word.strip()]
    unknown = next((word for word in asked if word not in known), None)
    if unknown is not None:
        near = nearest(unknown, OVERLAYS)
        fix = (f"write {near!r}; " if near else "") + f"overlays are {', '.join(OVERLAYS)}"
        raise InputError(f"{clean(unknown, 40)!r} is not a valid overlay", fix)
    return [known[word] for word in asked]


def plot_keys(overlays: Iterable[Overlay] | None) -> dict[str, bool]:
    """Plot keys that override the keys of objects; empty if no overlays are given."""
    if overlays is None:
        return {}
    shown = set(overlays)
    return {key: name in shown for name, keys in OVERLAYS.items() for key in keys}


def requested_plans(env: Env, overlays: Collection[Overlay] | None) -> list[PlannedPath]:
    """Paths planned for the robots of an environment, if the overlay ``plan`` is requested."""
    if not overlays or "plan" not in overlays:
        return []
    from irsim.rendering.planned_paths import plan_paths

    return plan_paths(env.simulation, routes=_routes(env))


def additions(env: Env, overlays: Collection[Overlay] | None, ways: list[PlannedPath]) -> Extra:
    """A function that draws the overlays that no plot key switches, and contacts within a step, which always show."""
    from irsim.graphics.scene.style import Palette
    from irsim.graphics.scene.zones import draw_zones
    from irsim.rendering.clearance_map import draw_clearance
    from irsim.rendering.planned_paths import draw_plans
    from irsim.rendering.snapshot import draw_between_steps

    modern = env.scenario.world.plot.style == "modern"  # draws zones and contacts itself

    def add(scene: Scene) -> None:
        if overlays and "clearance" in overlays:
            draw_clearance(scene, env.simulation, path=footprint_of(env, ways))
        if modern:
            draw_plans(scene, ways)
            return
        if overlays is None or "zones" in overlays:
            draw_zones(env.scenario.world.zones, Palette().zone, scene.extent).add_to(scene)
        draw_plans(scene, ways)
        if env.simulation.between_steps.any():
            draw_between_steps(scene, env.simulation, env.events)

    return add


def footprint_of(env: Env, ways: list[PlannedPath]) -> tuple[Polygon, Floats] | None:
    """Body of the smallest robot and its poses along its path, for `clearance`; None if it is round or has no path."""
    from irsim.rendering.clearance_map import smallest_robot
    from irsim.rendering.planned_paths import plan_paths, poses_along

    row = smallest_robot(env.simulation)
    view = next((view for view in env.robot_list if view.row == row), None)
    if view is None or view.shape == "circle" or view.original_geometry.geom_type != "Polygon":
        return None
    plans = ways or plan_paths(env.simulation, routes=_routes(env))
    line = next((way.points for way in plans if way.robot == view.id and len(way.points) > 1), None)
    if line is None:
        return None
    length = float(np.hypot(*np.diff(line, axis=0).T).sum())
    poses = poses_along(view, line, max(length / _MAX_POSES, _POSE_STEP_M))
    return Polygon(np.asarray(view.original_geometry.exterior.coords)[:-1, :2]), poses


def plan_results(env: Env, ways: list[PlannedPath]) -> list[RobotPlan]:
    """The planned paths as results."""
    labels = {view.id: view.label for view in env.robot_list}
    return [
        RobotPlan(
            name=way.name,
            label=labels[way.robot],
            own=way.own,
            length=way.length,
            margin=None if way.margin.nearest is None else way.margin.distance,
            nearest=way.margin.nearest,
            nearest_called=None if way.margin.nearest is None else called(env.scenario, way.margin.nearest),
            tightest=way.margin.pose[:2],
            lost=way.lost,
        )
        for way in ways
    ]


def _routes(env: Env) -> dict[int, list[Floats | None]]:
    """Routes of robots with the behavior ``follow`` to their remaining goals, by id."""
    from irsim.rendering.planned_paths import remaining_goals

    following = {record.id for record in env.scenario.objects if getattr(record.behavior, "name", "") == "follow"}
    ways = {
        view.id: [goal.tolist() for goal in remaining_goals(view)]
        for view in env.robot_list
        if view.id in following and view.goal is not None and not view.arrive and env.simulation.appeared[view.row] >= 0
    }
    if not ways:
        return {}
    state, rows = env.simulation.state, {view.id: view.row for view in env.objects}
    appeared = env.simulation.appeared
    poses = {
        key: (state.pose[row] if appeared[row] >= 0 else state.initial_state(row)[:3]).tolist()
        for key, row in rows.items()
    }
    if int(env.simulation.count[0]) == 0:
        return planned_routes(env.scenario, env.seed, poses, ways)
    now: dict[int, list[Floats | None]] = {key: [state.route(rows[key])] for key in ways}
    later = {key: goals[1:] for key, goals in ways.items() if len(goals) > 1 and now[key][0] is not None}
    ahead = planned_routes(env.scenario, env.seed, poses | {key: ways[key][0] for key in later}, later)
    return {key: [*legs, *ahead.get(key, [])] for key, legs in now.items()}
