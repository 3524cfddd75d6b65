"""Runs the episodes of several seeds as worlds that are stepped together, which is faster than one after another."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from irsim.benchmarks.controlled import ControllerJob, run_controlled
from irsim.benchmarks.episode import Episode, Job, Task, crowded, environment_of, measure, policy_of, run_task
from irsim.diagnostics.errors import PlacementError
from irsim.env import Env
from irsim.episodes.episode import horizon_of
from irsim.navigation.geodesic import Geodesics
from irsim.policies.driver import PolicyDriver, attach_policy, drivers_of
from irsim.scenario.limits import Limits
from irsim.simulation.events import read_events
from irsim.simulation.outcome import explored_share
from irsim.simulation.simulation import Simulation
from irsim.simulation.trace import Trace, record_worlds

__all__ = ["run_together", "worlds_at_once"]

_MAX_TRACE_BYTES = 64_000_000
"""Size of the traces that are held at once."""
_BYTES_PER_ROW = 75
"""Size of one object in one row of a trace."""


def run_together(job: Job, seeds: Sequence[int], ways: Geodesics | None = None) -> Iterator[dict[str, Any]]:
    """Run one episode for each seed; the results equal the results of :func:`irsim.benchmarks.episode.run_task`.

    A scenario in which Python code takes part runs one episode after another, unless that is a policy which decides in
    a batch as it does for single robots. Its first episode then runs alone, to time its decisions.

    Args:
        job: Scenario and behavior.
        seeds: The seeds.
        ways: Shortest paths in a world with the same static objects, if they are known.

    Yields:
        The result of each seed, in order.
    """
    if isinstance(job, ControllerJob):
        yield from run_controlled(job, seeds)
        return
    scene, horizons = _scene(job, seeds)
    alone = list(seeds)
    if scene is not None and _fit_together(scene.simulation):
        alone = alone[:1] if len(seeds) == 1 or drivers_of(scene.simulation) else []
    yield from (run_task(Task(job, seed), ways) for seed in alone)
    seeds = seeds[len(alone) :]
    if not seeds or scene is None:
        if scene is not None:
            scene.end(ending_time=0.0)
        return
    size = worlds_at_once(scene.simulation.objects, max(horizons.values()))
    ran: dict[int, tuple[Simulation, int, Trace]] = {}
    for place, seed in enumerate(seeds):
        if seed not in horizons:
            yield crowded()
            continue
        if seed not in ran:
            some = [one for one in seeds[place:] if one in horizons][:size]
            simulation = Simulation(scene.scenario, some)
            attach_policy(simulation, policy_of(job))
            traces = record_worlds(simulation, [horizons[one] for one in some])
            ran = {one: (simulation, world, trace) for world, (one, trace) in enumerate(zip(some, traces, strict=True))}
        simulation, world, trace = ran[seed]
        events = [event for event in read_events(simulation, world) if event.step <= trace.step[-1]]
        _draw(scene, seed)
        yield measure(Task(job, seed), Episode(trace, events, horizons[seed], world), scene, simulation, ways)
    scene.end(ending_time=0.0)


def worlds_at_once(objects: int, steps: int) -> int:
    """Number of worlds that are stepped together, so that their traces stay small.

    Args:
        objects: Number of objects of a world.
        steps: Largest number of steps.
    """
    return max(1, _MAX_TRACE_BYTES // (_BYTES_PER_ROW * max(1, objects) * max(1, steps)))


def _scene(job: Job, seeds: Sequence[int]) -> tuple[Env | None, dict[int, int]]:
    """An environment that shows the scene of one seed after another, and the horizon of each seed that has room."""
    limits = Limits(**dict(job.limits))
    scene: Env | None = None
    horizons: dict[int, int] = {}
    for seed in seeds:
        try:
            if scene is None:
                scene = environment_of(job, seed)
            else:
                _draw(scene, seed)
        except PlacementError:
            continue
        horizons[seed], _ = horizon_of(scene.simulation, job.steps, limits)
    return scene, horizons


def _fit_together(simulation: Simulation) -> bool:
    """Whether worlds of a scenario that are stepped together do what they do alone, and gain by it."""
    others = simulation.measurements or simulation.drives is not None or simulation.hooks is not None
    others = others or explored_share(simulation) is not None  # fog goes on after the end of an episode
    policies = [part.policy for part in simulation.decisions if isinstance(part, PolicyDriver)]
    return not others and len(policies) == len(simulation.decisions) and all(one.batch_invariant for one in policies)


def _draw(scene: Env, seed: int) -> None:
    """Draw the first scene of a seed.

    Raises:
        PlacementError: The seed leaves no room for an object.
    """
    scene.simulation.reseed([seed])
    scene.simulation.reset()
