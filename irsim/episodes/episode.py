"""One episode: read its scenario, choose its seed and horizon, and advance its environment."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from irsim.common.arguments import check_whole_number
from irsim.diagnostics.errors import OverLimitError
from irsim.env import Env
from irsim.results.run import HorizonSource, Until
from irsim.scenario.limits import Limits
from irsim.scenario.resolve.resolved import ResolvedScenario, random_parts
from irsim.simulation.build import steps_until
from irsim.simulation.events import first_collisions
from irsim.simulation.outcome import is_over
from irsim.simulation.time_limit import default_time_limit

if TYPE_CHECKING:
    from irsim.simulation.protocols import EpisodeRecorder
    from irsim.simulation.simulation import Simulation

__all__ = ["Progress", "advance", "horizon_of", "seed_of"]

Progress = Callable[[int, int], None]
"""Callback ``(steps_done, steps_total)``, called every few steps."""

_CHUNK_STEPS = 50
"""Number of steps between two calls of the progress callback."""


def seed_of(scenario: ResolvedScenario, seed: int | None) -> int | None:
    """The given seed, else the seed of the scenario, else 0 if nothing is random; None if a seed must be drawn."""
    chosen = scenario.world.seed if seed is None else seed
    return 0 if chosen is None and not random_parts(scenario) else chosen


def horizon_of(simulation: Simulation, steps: int | None, limits: Limits) -> tuple[int, HorizonSource]:
    """Greatest number of steps of an episode, and what determines it.

    A horizon that is derived from the scenario is cut to the limits; one that was asked for must be within them.

    Raises:
        OverLimitError: ``steps`` exceeds the limits.
        InputError: ``steps`` is not a whole number, or negative.
    """
    scenario = simulation.scenario
    most, what = _most_steps(len(scenario.objects), limits)
    if steps is not None:
        steps = check_whole_number("steps", steps)
        if most is not None and steps > most:
            raise OverLimitError(f"{steps:,} steps are too many: at most {what}", f"ask for at most {most:,} steps")
        return steps, "argument"
    limit = scenario.world.time_limit
    seconds = default_time_limit(simulation) if limit is None else limit
    horizon = steps_until(seconds, scenario.world.step_time)
    if most is not None and horizon > most:
        return most, "limits"
    return horizon, "default" if limit is None else "scenario"


def _most_steps(objects: int, limits: Limits) -> tuple[int | None, str]:
    """Greatest number of steps that the limits allow in one run, and the reason in words."""
    bounds: list[tuple[int, str]] = []
    if limits.steps is not None:
        bounds.append((limits.steps, f"{limits.steps:,} are run at once"))
    if limits.work is not None:
        each = limits.work // max(1, objects)
        bounds.append((each, f"{limits.work:,} steps x objects are run at once, and there are {objects:,} objects"))
    return min(bounds, default=(None, ""))


def advance(
    env: Env,
    steps: int,
    progress: Progress | None,
    *,
    until: Until = "done",
    recorder: EpisodeRecorder | None = None,
    follow: Progress | None = None,
) -> None:
    """Advance an environment, by default until every robot has arrived or stopped, or, without robots, all that moves.

    Args:
        env: The environment.
        steps: Greatest number of steps.
        progress: Callback ``(steps_done, steps_total)``.
        until: See :func:`irsim.run`.
        recorder: Records the steps.
        follow: Callback ``(steps_done, steps_total)``, called after every step.
    """
    until_done, touches = until != "time_limit", until == "first_collision"
    nobody = not env.simulation.robots.any()
    ended = partial(is_over, env.simulation) if nobody else env.done
    chunk = 1 if touches or follow is not None or (until_done and nobody) else _CHUNK_STEPS
    done, over = 0, until_done and bool(ended())
    while done < steps and not over:
        done += max(1, env.advance(min(chunk, steps - done), until_done=until_done, recorder=recorder))
        over = (until_done and bool(ended())) or (touches and _has_collided(env))
        for report in (follow, progress):
            if report is not None:
                report(done, done if over else steps)  # the count ends at its total


def _has_collided(env: Env) -> bool:
    """Whether a robot has touched something."""
    hits = first_collisions(env.simulation, env.events)
    return any(robot.name in hits for robot in env.robot_list)
