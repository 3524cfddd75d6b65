"""What only the built world tells about a scenario: whether things fit, and whether robots can get where they shall.

``irsim.validate`` adds these findings to those of :mod:`irsim.scenario.checks`. All work is bounded by counts, never by
a clock, so the same scenario gives the same findings everywhere.
"""

from __future__ import annotations

from collections.abc import Iterator

from irsim.scenario.checks import Context
from irsim.scenario.messages.findings import Finding
from irsim.validation.feasibility import (
    goal_clearance as goals,
)
from irsim.validation.feasibility import (
    random_placement as placing,
)
from irsim.validation.feasibility import (
    reachability as reach,
)
from irsim.validation.feasibility import (
    shared_goals as crowd,
)
from irsim.validation.feasibility import (
    time_budget as schedule,
)
from irsim.validation.feasibility.movers import movers_of
from irsim.validation.feasibility.scenes import scenes_of
from irsim.validation.feasibility.tally import Tally

__all__ = ["survey"]

_MOST_OBJECTS = 20_000


def survey(context: Context) -> Iterator[Finding]:
    """Findings about the world of a scenario without errors."""
    if len(context.resolved.objects) > _MOST_OBJECTS or context.document.fatal:
        return
    drawn = scenes_of(context)
    yield from placing.check(context, drawn)
    movers = movers_of(context)
    if not movers:
        return
    tally = Tally(len(drawn.scenes), random=drawn.random)
    for scene in drawn.scenes:
        passable = context.scenario.world.collision_mode in ("unobstructed", "reactive")
        roomless = set() if passable else goals.check(context, scene, movers, tally)
        if not passable:
            crowd.check(context, scene, movers, tally)
        ways = reach.check(context, scene, movers, tally, blocking=not passable, roomless=roomless)
        schedule.check(context, scene, movers, ways, tally)
    yield from tally.findings()
