"""All feasibility checks of a scenario.

``irsim.validate`` reports these findings besides :mod:`irsim.scenario.checks`. All work is bounded by counts, never by
a clock, so the same scenario gives the same findings on every machine.
"""

from __future__ import annotations

from collections.abc import Iterator

from irsim.scenario.checks import Context
from irsim.scenario.messages.findings import Finding
from irsim.validation.feasibility import (
    confined,
    door_jam,
    goal_clearance,
    policies,
    random_placement,
    reachability,
    shared_goals,
    time_budget,
    turning,
)
from irsim.validation.feasibility.movers import movers_of
from irsim.validation.feasibility.scenes import scenes_of
from irsim.validation.feasibility.tally import Tally

__all__ = ["feasibility_findings"]

_MAX_OBJECTS = 20_000
"""Scenarios with more objects are not checked."""


def feasibility_findings(context: Context, policy: str | None = None) -> Iterator[Finding]:
    """Check whether the objects of a scenario without errors fit, and whether its robots can reach their goals.

    Args:
        context: The scenario.
        policy: Name of the policy that is to drive the robots; None: their own behaviors.
    """
    if len(context.resolved.objects) > _MAX_OBJECTS or context.document.fatal:
        return
    yield from policies.check(context, policy)
    drawn = scenes_of(context)
    yield from random_placement.check(context, drawn)
    movers = movers_of(context)
    if not movers:
        return
    tally = Tally(len(drawn.scenes), random=drawn.random)
    passable = context.scenario.world.collision_mode in ("unobstructed", "reactive")
    for scene in drawn.scenes:
        tally.seed = scene.seed
        blocked_goals = set() if passable else goal_clearance.check(context, scene, movers, tally)
        if not passable:
            shared_goals.check(context, scene, movers, tally)
        legs = reachability.check(context, scene, movers, tally, blocking=not passable, blocked_goals=blocked_goals)
        time_budget.check(context, scene, movers, legs, tally)
        turning.check(context, scene, movers, legs, tally)
        confined.check(context, scene, movers, legs, tally)
        door_jam.check(context, scene, movers, legs, tally)
    yield from tally.findings()
