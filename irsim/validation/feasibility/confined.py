"""Whether the region and the zones of ``follow`` leave a path to each goal."""

from __future__ import annotations

from typing import Any

from irsim.episodes.planned_routes import planned_routes
from irsim.scenario.checks import Context
from irsim.scenario.checks.regions import ends_fit
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.reachability import Leg
from irsim.validation.feasibility.scenes import StartState
from irsim.validation.feasibility.tally import Tally

__all__ = ["check"]

_MAX_SCENES = 3
"""Number of scenes in which routes are planned."""


def check(context: Context, scene: StartState, movers: list[Mover], legs: dict[int, list[Leg]], tally: Tally) -> None:
    """Report goals that can be reached only by leaving ``within`` or entering ``avoid``."""
    confined = {
        mover.record.id: mover
        for mover in movers
        if _is_confined(mover) and legs.get(mover.record.id) and _ends_fit(context, scene, mover)
    }
    if not confined or scene.seed >= _MAX_SCENES:
        return
    goals = {key: scene.goals[key][: len(legs[key])] for key in confined}
    for key, routes in planned_routes(context.resolved, scene.seed, scene.pose, goals).items():
        index = next((i for i, route in enumerate(routes) if route is None), None)
        if index is not None:
            _report(confined[key], index, scene, tally)


def _is_confined(mover: Mover) -> bool:
    options: Any = mover.record.active_behavior
    confined = mover.behavior == "follow" and (options.within is not None or bool(options.avoid))
    return confined and not mover.record.wander


def _ends_fit(context: Context, scene: StartState, mover: Mover) -> bool:
    """Whether start and goals are where the object may be; other checks report the rest."""
    record = mover.record
    options: Any = record.active_behavior
    zones = [zone for zone in context.scenario.world.zones if zone.name in options.avoid]
    radius = record.shape.radius if record.shape.name == "circle" else 0.0
    return ends_fit(options, [scene.pose[record.id], *scene.goals[record.id]], zones, radius)


def _report(mover: Mover, index: int, scene: StartState, tally: Tally) -> None:
    options: Any = mover.record.active_behavior
    goals = scene.goals[mover.record.id]
    what = f"waypoint {index + 1} at" if len(goals) > 1 else "its goal"
    stays = "stays in 'within'" if options.within is not None else ""
    zones = ", ".join(f"'{name}'" for name in options.avoid)
    rules = " and ".join(filter(None, [stays, f"keeps out of {zones}" if zones else ""]))
    fixes = ["a wider 'within'"] if stays else []
    fixes += [f"a smaller zone than {zones}, or no zone in 'avoid'"] if zones else []
    fixes.append("more room beside the obstacles")
    tally.add_goal(
        "goal-unreachable",
        mover,
        index,
        f"'{mover.record.name}' cannot get to {what} ({goals[index][0]:g}, {goals[index][1]:g}): its planner finds no "
        f"path that {rules}, although obstacles alone leave one",
        ", or ".join(fixes),
    )
