"""Definitions of all metrics: key, unit, meaning, and how the values of several robots combine.

The module of a family computes a value from the fields of ``Track`` (``trajectory.py``), which ends at the arrival, and
returns it under its key; NaN where it is undefined. A metric of the whole episode goes to ``EPISODE_METRICS`` and to
``_of_episode`` in ``episode.py``. A new metric is an extra. ``skills/irsim-benchmark/scripts/verdict.py`` runs without
irsim, so it has the key, too: in ``MORE``, ``LESS`` or ``EITHER``, and in ``SHARES`` if the unit is ``0/1``. Results
of benchmarks, ``irsim describe KEY`` and the MCP tools need no change; the printed table of a benchmark
(``benchmarks/report/markdown.py``) and the result of one run (``results/run.py``) show a choice.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

__all__ = ["EPISODE_METRICS", "METRICS", "Metric"]

Combined = Literal["mean", "min", "max", "all"]


@dataclass(frozen=True, slots=True)
class Metric:
    """One metric of a robot.

    Attributes:
        key: Name of the metric in results.
        unit: Unit of the value; ``0/1`` for a proportion.
        text: Meaning of the metric.
        robots: How the values of all robots combine to the value of the episode.
        canonical: Whether it belongs to the canonical set; otherwise it is a widely used extra.
        better: Whether more or less is better, None if that depends.
    """

    key: str
    unit: str
    text: str
    robots: Combined = "mean"
    canonical: bool = True
    better: Literal["more", "less"] | None = None


def _metrics(canonical: bool) -> tuple[Callable[..., Metric], ...]:
    """Makers of metrics of which less, more, or either is better."""
    return tuple(partial(Metric, canonical=canonical, better=better) for better in ("less", "more", None))


def _canonical() -> tuple[Metric, ...]:
    less, more, either = _metrics(canonical=True)
    return (
        more("success", "0/1", "arrived before the horizon, no collision before", "all"),
        more("goal_reached", "0/1", "arrived before the horizon, collisions or not", "all"),
        less("collision_count", "count", "contacts that began before it arrived"),
        less("collision_steps", "count", "steps in contact before it arrived"),
        less("wall_collisions", "count", "of the contacts, those with static objects and maps"),
        less("agent_collisions", "count", "of the contacts, those with other robots"),
        less("human_collisions", "count", "of the contacts, those with humans"),
        less("timeout", "0/1", "neither arrived nor stopped by a collision at the horizon", "max"),
        less("failure_to_progress", "count", "5 s windows in which the path to the goal became < 0.1 m shorter"),
        less("stalled_time", "s", "slower than 0.05 m/s and 0.05 rad/s, not arrived"),
        less(
            "time_to_goal",
            "s",
            "time of first arrival; of an episode the mean of the robots that arrived, also if others did not",
        ),
        less("path_length", "m", "distance travelled until it arrived (in the result of one run: to its end)"),
        more("spl", "0-1", "success x L*/max(path, L*), L* the shortest path round static objects"),
        either("velocity_min", "m/s", "lowest speed until it arrived", "min"),
        more("velocity_avg", "m/s", "distance travelled / time until it arrived"),
        either("velocity_max", "m/s", "highest speed until it arrived", "max"),
        either("acceleration_min", "m/s^2", "smallest magnitude of the acceleration vector", "min"),
        less("acceleration_avg", "m/s^2", "mean magnitude of the acceleration vector"),
        less("acceleration_max", "m/s^2", "largest magnitude of the acceleration vector", "max"),
        either("jerk_min", "m/s^3", "smallest magnitude of the jerk vector", "min"),
        less("jerk_avg", "m/s^3", "mean magnitude of the jerk vector"),
        less("jerk_max", "m/s^3", "largest magnitude of the jerk vector", "max"),
        more("clearing_distance_min", "m", "smallest distance to static objects, surface to surface", "min"),
        more("clearing_distance_avg", "m", "mean distance to the nearest static object"),
        more("space_compliance", "0-1", "share of time with every human at 0.5 m or more"),
        less("personal_space_intrusion_ratio", "0-1", "share of time with a human closer than 0.5 m"),
        more("distance_to_human_min", "m", "smallest distance to a human, surface to surface", "min"),
        either("time_to_collision_min", "s", "shortest time to contact with a human at constant velocities", "min"),
    )


def _extras() -> tuple[Metric, ...]:
    less, more, either = _metrics(canonical=False)
    return (
        either("proxemics_intimate_ratio", "0-1", "share of time with the nearest human closer than 0.45 m"),
        either("proxemics_personal_ratio", "0-1", "share of time with the nearest human at 0.45 to 1.2 m"),
        either("proxemics_social_ratio", "0-1", "share of time with the nearest human at 1.2 to 3.6 m"),
        either("proxemics_public_ratio", "0-1", "share of time with the nearest human at 3.6 m or more"),
        either("distance_to_human_avg", "m", "mean distance to the nearest human"),
        less("min_distance_to_goal", "m", "smallest distance to the present goal, straight", "min"),
        less("final_distance_to_goal", "m", "last distance to the present goal, straight"),
        less(
            "cumulative_heading_change",
            "rad",
            "sum of absolute heading changes; of the direction of motion for omni, omni_angular",
        ),
        less(
            "path_irregularity",
            "rad",
            "cumulative_heading_change, minus the shortest path's (with the first turn, if it must turn to move)",
        ),
        less("path_efficiency", "ratio", "path length of a robot that arrived / L*, the shortest path; 1 is best"),
        less("curvature", "1/m", "mean Menger curvature of points at least 0.05 m apart"),
        less("roughness", "1/m", "mean absolute change of that curvature"),
        less("angle_over_length", "rad/m", "cumulative_heading_change / path length"),
        less("motion_energy", "m^2/s", "sum of squared speed times dt, unit mass"),
        more("stl", "0-1", "success x T*/max(T, T*), T* = L* / its top speed, forward or sideways"),
        more("barn_score", "0-0.5", "success x T*/clip(T, 2T*, 8T*), T* = L*/2"),
        less("discomfort_ratio", "0-1", "share of time with 0 < distance to a human < 0.2 m"),
        either("discomfort_min_dist", "m", "mean of such distances"),
        more(
            "crowdnav_reward",
            "-",
            "1 on arrival, -0.25 on collision, (d - 0.2 m) x 0.5 x dt per step with a human at 0 < d < 0.2 m, each x "
            "0.9^(t x top speed)",
        ),
        less("near_misses", "count", "times a human came within 0.2 m and went without contact"),
        less("freezing_count", "count", "stalls of 2 s or more, not arrived"),
        less("freezing_time", "s", "time in such stalls"),
        more(
            "success_in_belief", "0/1", "where it perceives an estimate: believed to have arrived, no collision", "all"
        ),
        more("min_clearance", "m", "smallest distance to anything that can be hit, surface to surface", "min"),
        less(
            "contacts_between_steps",
            "count",
            "contacts that began and ended within one step, before it arrived; collisions only with world.contacts: "
            "swept",
        ),
        either(
            "human_collisions_by_robot", "count", "of those with humans, where it went faster to the contact, or both"
        ),
        either("human_collisions_by_human", "count", "of those with humans, where the human did, or both"),
        less("group_space_intrusion_ratio", "0-1", "share of time in the space of a social group"),
        less("group_collision_rate", "0/1", "entered the space of a social group", "max"),
        less("social_force_robot", "m/s", "norm of the social force of humans on it, summed times dt"),
        less("social_force_agents", "m/s", "norms of its social forces on humans, summed times dt"),
        less("social_work", "m/s", "both of these together"),
        less("obstacle_force_robot", "m/s", "push of the nearest static object on it, summed times dt"),
        either("obstacle_force_agents", "m/s", "pushes of the nearest static objects on humans, summed times dt"),
        either("pedestrian_velocity_avg", "m/s", "mean speed of the humans until it arrived"),
        less("control_effort", "s", "squared controls, each over its limit, summed times dt"),
        either("time_in_zone", "s", "its footprint overlapped a region of world.zones"),
        either(
            "zone_crossings",
            "count",
            "entries into regions of world.zones, plus crossings of its lines: +1 from left to right, -1 from right to "
            "left",
        ),
        either(
            "seen_ratio",
            "0-1",
            "share of time in the field of view (fov, with fov_occlusion) of at least one other object",
        ),
        either("goal_visible_ratio", "0-1", "share of time with a straight line to its goal free of static objects"),
        less("left_world", "0/1", "its position was outside the world", "max"),
        more("arrived_share", "0-1", "share of the robots that arrived before the horizon, collisions or not"),
        less("driving_time", "s", "time until it arrived, or until the end of the episode"),
    )


METRICS: tuple[Metric, ...] = _canonical() + _extras()
"""All metrics of a robot, in the order in which they are shown."""

EPISODE_METRICS: tuple[Metric, ...] = (
    Metric("collision", "0/1", "a robot was stopped by a collision, or arrived after one", "max", better="less"),
    Metric(
        "pedestrian_delay",
        "s",
        "time of the humans to their goals, minus the time without robots (same seed); of those who arrive in both",
        canonical=False,
        better="less",
    ),
    Metric(
        "aggregated_time",
        "s",
        "when the last robot arrived, the greatest time_to_goal (makespan); undefined if one never did",
        "max",
        better="less",
    ),
    Metric(
        "restricted_time",
        "s",
        "mean over all robots of the time of arrival, or of the horizon without arrival (restricted mean)",
        canonical=False,
        better="less",
    ),
    Metric(
        "contacts_per_hour",
        "1/h",
        "contacts of a robot that began before it arrived, for each hour that it drove; of a row the mean of its "
        "contacts over the mean of its driving_time",
        canonical=False,
        better="less",
    ),
    Metric(
        "explored",
        "0-1",
        "share of the area of the world, insides of obstacles included, that the robots had seen at the end; undefined "
        "without world.fog_map",
        canonical=False,
        better="more",
    ),
)
"""Metrics that only a whole episode has."""
