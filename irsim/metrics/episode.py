"""The metrics of one episode: of each robot, and of all robots together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from irsim.metrics.definitions import METRICS
from irsim.metrics.motion import motion_metrics
from irsim.metrics.progress import outcome_metrics, progress_metrics
from irsim.metrics.proximity import proximity_metrics
from irsim.metrics.reward import reward_metrics
from irsim.metrics.social import social_metrics
from irsim.metrics.trajectory import Track, tracks
from irsim.metrics.watching import Rows, Watching, blocking_objects, goal_visible_ratio, watching_metrics, zone_metrics
from irsim.navigation.clearances import Clearance, clearance
from irsim.navigation.geodesic import Geodesics, inscribed_radius
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
    """The metrics of an episode.

    Attributes:
        robots: Metrics of each robot by key (:data:`irsim.metrics.definitions.METRICS`); NaN where undefined.
        flags: Flags of each robot: ``unreachable`` (no path to a goal was found), ``no_approach`` (never on a collision
            course with a human, so ``time_to_collision_min`` is undefined).
        episode: The same keys for the episode, and the keys of :data:`irsim.metrics.definitions.EPISODE_METRICS`.
        names: Names of the robots.
        hits: Name of the first object that each robot touched before it arrived, None without a contact.
        clearance: Clearances of the robots.
        zones: Metrics of each zone by its name, see :func:`irsim.metrics.watching.zone_metrics`: means over the robots.
    """

    robots: list[dict[str, float]]
    flags: list[list[str]]
    episode: dict[str, float]
    names: list[str]
    hits: list[str | None]
    clearance: Clearance
    zones: dict[str, dict[str, float]]


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

    Each robot is measured until its first arrival: what happens afterwards is not caused by it.

    Args:
        trace: Trace from the start of the episode.
        scenario: The scenario that was simulated, or the simulation with the scene of the trace.
        events: Events of the episode.
        seed: With a scenario: the seed of the run.
        ways: Shortest paths in a world with the same static objects.
    """
    simulation = scenario if isinstance(scenario, Simulation) else Simulation(scenario, [seed])
    distances = clearance(trace, simulation)
    cut = tracks(trace, list(events), distances, simulation)
    geodesics = Geodesics(simulation) if ways is None else ways
    order = [metric.key for metric in METRICS]
    watching, blocking = Watching.read(simulation, events), blocking_objects(simulation)
    values, flags, zones = [], [], []
    for track in cut:
        rows = Rows(track.first, len(track.pose), track.step_time)
        zones.append(zone_metrics(watching, track.name, rows))
        watched = watching_metrics(watching, track.name, rows)
        watched["goal_visible_ratio"] = goal_visible_ratio(track.position, track.goal, simulation, blocking)
        made, odd = progress_metrics(track, geodesics, inscribed_radius(simulation, track.index))
        near, apart = proximity_metrics(track)
        metrics = outcome_metrics(track) | motion_metrics(track) | near | social_metrics(track) | made | watched
        metrics |= reward_metrics(track)
        if missing := [key for key in order if key not in metrics]:
            raise LookupError(f"no module of irsim/metrics computes {', '.join(missing)}")
        values.append({key: _without_rounding_error(metrics[key]) for key in order})
        flags.append(odd + apart)
    names = [track.name for track in cut]
    hits = [_partner(track) for track in cut]
    return EpisodeMetrics(values, flags, _of_episode(values), names, hits, distances, _of_zones(zones))


def episode_value(key: str, values: Sequence[float]) -> float:
    """Combine the values of the robots to one of the episode: whether all have it, the least, greatest or mean.

    Robots for which the value is undefined are left out.
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
    values = {metric.key: episode_value(metric.key, [robot[metric.key] for robot in robots]) for metric in METRICS}
    collided = any(not robot["success"] and not robot["timeout"] for robot in robots)
    values["timeout"] = float(not collided and not values["success"]) if robots else math.nan
    values["collision"] = float(collided) if robots else math.nan
    values["pedestrian_delay"] = math.nan  # needs a second run without robots, which irsim.benchmark makes
    times = [robot["time_to_goal"] for robot in robots]
    values["aggregated_time"] = max(times) if times and not any(map(math.isnan, times)) else math.nan
    values["restricted_time"] = math.nan  # needs the horizon, which irsim.benchmark has
    driven = math.fsum(robot["driving_time"] for robot in robots)
    contacts = math.fsum(robot["collision_count"] for robot in robots)
    values["contacts_per_hour"] = 3600.0 * contacts / driven if driven > 0 else math.nan
    values["explored"] = math.nan  # needs the fog at the end of the run, which irsim.benchmark has
    return values


def _of_zones(robots: list[dict[str, dict[str, float]]]) -> dict[str, dict[str, float]]:
    """Means over the robots of the metrics of each zone; empty without robots."""
    return {
        zone: {key: math.fsum(robot[zone][key] for robot in robots) / len(robots) for key in values}
        for zone, values in (robots[0] if robots else {}).items()
    }


def _without_rounding_error(value: float) -> float:
    """The value, or 0 if it is so small that it is a rounding error."""
    return 0.0 if abs(value) < _TINY else value
