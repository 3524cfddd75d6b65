"""The metrics of one episode: of each robot, and of all together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from irsim.metrics.clearance import Clearance, clearance
from irsim.metrics.definitions import METRICS
from irsim.metrics.geodesic import Geodesics, inscribed_radius
from irsim.metrics.motion import motion
from irsim.metrics.outcome import outcome
from irsim.metrics.progress import progress
from irsim.metrics.proximity import space
from irsim.metrics.social import social
from irsim.metrics.trajectory import HOLONOMIC, Track, tracks
from irsim.simulation.events import partner_of
from irsim.simulation.simulation import Simulation

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario
    from irsim.simulation.events import Event
    from irsim.simulation.trace import Trace

__all__ = ["EpisodeMetrics", "episode_metrics", "episode_value", "robot_metrics"]

_TINY = 1e-12


@dataclass(frozen=True)
class EpisodeMetrics:
    """What an episode came to.

    Attributes:
        robots: For each robot its metrics by key (:data:`irsim.metrics.definitions.METRICS`); NaN where undefined.
        flags: For each robot what is odd: ``unreachable`` (no way to a goal was found), ``no_approach`` (there are
            humans, but contact with one never lay ahead: no ``time_to_collision_min``).
        episode: The same keys for the episode, and those of :data:`irsim.metrics.definitions.EPISODE_METRICS`.
        names: Names of the robots.
        hits: For each robot the name of what it touched first before it arrived, None if nothing.
        clearance: Distances of the robots.
    """

    robots: list[dict[str, float]]
    flags: list[list[str]]
    episode: dict[str, float]
    names: list[str]
    hits: list[str | None]
    clearance: Clearance


def robot_metrics(
    trace: Trace, scenario: ResolvedScenario | Simulation, events: Sequence[Event], *, seed: int = 0
) -> list[dict[str, float]]:
    """The metrics of each robot; see :func:`episode_metrics`."""
    return episode_metrics(trace, scenario, events, seed=seed).robots


def episode_metrics(
    trace: Trace,
    scenario: ResolvedScenario | Simulation,
    events: Sequence[Event],
    *,
    seed: int = 0,
    ways: Geodesics | None = None,
) -> EpisodeMetrics:
    """The metrics of an episode, sampled at every step.

    Each robot is measured until it first arrived: what happens afterwards is not its doing.

    Args:
        trace: From the start of the episode.
        scenario: What was simulated, or the simulation in the scene of the trace.
        events: What happened.
        seed: With a scenario: the seed of the run.
        ways: Shortest ways in a world in which the same things stand in the same places.
    """
    simulation = scenario if isinstance(scenario, Simulation) else Simulation(scenario, [seed])
    records = simulation.scenario.objects
    distances = clearance(trace, simulation)
    robots = distances.robots.tolist()
    cut = tracks(
        trace,
        list(events),
        distances,
        simulation,
        np.asarray(simulation.radius[: simulation.objects], dtype=np.float64),
        [_top_speed(records[robot].vel_max, records[robot].kinematics) for robot in robots],
    )
    geodesics = Geodesics(simulation) if ways is None else ways
    order = [metric.key for metric in METRICS]
    values, flags = [], []
    for track in cut:
        made, odd = progress(track, geodesics, inscribed_radius(simulation, track.index))
        near, apart = space(track)
        found = outcome(track) | motion(track) | near | social(track) | made
        values.append({key: _settled(found[key]) for key in order})
        flags.append(odd + apart)
    names = [track.name for track in cut]
    hits = [_partner(track) for track in cut]
    return EpisodeMetrics(values, flags, _of_episode(values), names, hits, distances)


def episode_value(key: str, values: Sequence[float]) -> float:
    """The value of an episode from those of its robots: all of them, the least, the greatest, or their mean.

    Robots for which it is undefined are left out.
    """
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return math.nan
    how = next(metric.robots for metric in METRICS if metric.key == key)
    if how in ("all", "min"):
        return min(known)
    return max(known) if how == "max" else math.fsum(known) / len(known)


def _partner(track: Track) -> str | None:
    if not track.collisions:
        return None
    event, _ = track.collisions[0]
    return partner_of(event, track.name)


def _of_episode(robots: list[dict[str, float]]) -> dict[str, float]:
    found = {metric.key: episode_value(metric.key, [robot[metric.key] for robot in robots]) for metric in METRICS}
    collided = any(not robot["success"] and not robot["timeout"] for robot in robots)
    found["timeout"] = float(not collided and not found["success"]) if robots else math.nan
    found["collision"] = float(collided) if robots else math.nan
    found["pedestrian_delay"] = math.nan  # takes a second run: irsim.benchmark makes it
    times = [robot["time_to_goal"] for robot in robots]
    found["aggregated_time"] = max(times) if times and not any(map(math.isnan, times)) else math.nan
    return found


def _settled(value: float) -> float:
    """Without the dust of rounding."""
    return 0.0 if abs(value) < _TINY else value


def _top_speed(vel_max: Sequence[float], kinematics: object) -> float:
    name = getattr(kinematics, "name", None)
    if name is None:
        return 0.0
    return float(max(vel_max[:2]) if name in HOLONOMIC else vel_max[0])  # not both at once: most behaviors never do
