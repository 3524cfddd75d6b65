"""Metrics of the effect on humans: causes of contacts, spaces of groups, social forces (HuNavSim, TAGA, SEAN)."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.arrays import Floats
from irsim.components.behaviors.sfm import Sfm
from irsim.metrics.trajectory import Track
from irsim.simulation.events import partner_of
from irsim.simulation.roles import HUMAN, STATIC

if TYPE_CHECKING:
    from irsim.simulation.events import Event

__all__ = ["group_gaps", "obstacle_force", "social_forces", "social_metrics"]

_GROUP_MARGIN_M = 0.45
"""Distance [m] by which the space of a group extends beyond its members."""
_EQUAL_SHARE = 0.1
"""Speeds that differ by at most this share count as equal."""
_MIN_ANGLE = 1e-12
"""Angle [rad] below which a difference is a rounding error."""
_MIN_DISTANCE_M = 1e-6
"""Distance [m] below which there is no direction, so no force."""
_WALL_REACH = 5.0
"""Number of sigmas within which walls push."""


def social_metrics(track: Track) -> dict[str, float]:
    """Social metrics of a robot until it arrived; NaN without humans, or without social groups.

    - ``human_collisions_by_robot``, ``human_collisions_by_human``: contacts caused by the one whose velocity in the
      step before pointed more toward the contact; by both if these speeds differ by at most 10 %.
    - ``group_space_intrusion_ratio``: share of rows in which its bounding disc is in the space of a social group: the
      convex hull of the members' centres, grown by 0.45 m. ``group_collision_rate``: whether it ever was, 0 or 1.
    - ``social_force_robot`` [m/s]: norm of the sum of the social forces of all humans on it, summed times dt;
      ``social_force_agents``: norms of its forces on each human, summed times dt; ``social_work``: both together.
      Forces follow Moussaid et al. (2009) with the parameters and the weight that ``sfm`` has by default.
    - ``obstacle_force_robot`` [m/s]: magnitude of :func:`obstacle_force` on it, summed times dt;
      ``obstacle_force_agents``: the same for each human. NaN without static objects.
    - ``pedestrian_velocity_avg`` [m/s]: path length of all humans / (their number x time).
    """
    nan = math.nan
    causes = [_causes(track, event) for event, kind in track.collisions if kind == HUMAN]
    metrics = {
        "human_collisions_by_robot": float(sum(mine for mine, _ in causes)),
        "human_collisions_by_human": float(sum(theirs for _, theirs in causes)),
        "group_space_intrusion_ratio": nan,
        "group_collision_rate": nan,
        "social_force_robot": nan,
        "social_force_agents": nan,
        "social_work": nan,
        "obstacle_force_robot": _impulse(track.distance[1:, STATIC], track.step_time),
        "obstacle_force_agents": _impulse(track.others_static[1:], track.step_time),
        "pedestrian_velocity_avg": nan,
    }
    if track.groups:
        gaps = [group_gaps(track.position, track.others[:, list(group), :2]) for group in track.groups]
        within = (np.array(gaps) <= _GROUP_MARGIN_M + track.reach).any(axis=0)
        metrics |= {"group_space_intrusion_ratio": float(within.mean()), "group_collision_rate": float(within.any())}
    if track.people and len(track.pose) > 1:
        steps = np.diff(track.others[:, :, :2], axis=0)
        on_it, by_it = social_forces(
            track.position[1:], track.velocity, track.others[1:, :, :2], steps / track.step_time
        )
        absent = np.isnan(steps).any(axis=2)
        on_it[absent] = by_it[absent] = 0.0
        robot = float(np.linalg.norm(on_it.sum(axis=1), axis=1).sum() * track.step_time)
        agents = float(np.linalg.norm(by_it, axis=2).sum() * track.step_time)
        metrics |= {"social_force_robot": robot, "social_force_agents": agents, "social_work": robot + agents}
        if not absent.all():
            metrics["pedestrian_velocity_avg"] = float(np.linalg.norm(steps[~absent], axis=1).mean() / track.step_time)
    return metrics


def social_forces(position: Floats, velocity: Floats, others: Floats, velocities: Floats) -> tuple[Floats, Floats]:
    """Social forces [m/s^2] between a robot and M humans, with the default parameters of ``sfm``.

    Args:
        position: (T, 2) position of the robot [m].
        velocity: (T, 2) velocity of the robot [m/s].
        others: (T, M, 2) positions of the humans [m].
        velocities: (T, M, 2) velocities of the humans [m/s].

    Returns:
        (T, M, 2) force of each human on the robot, and (T, M, 2) force of the robot on each human.
    """
    way, closing = others - position[:, None], velocity[:, None] - velocities
    return _force(way, closing), _force(-way, -closing)


def _force(way: Floats, closing: Floats) -> Floats:
    """Social force on one agent from another at relative position ``way``, approached with velocity ``closing``."""
    options = Sfm()
    distance = np.linalg.norm(way, axis=-1)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        towards = way / distance[..., None]
        interaction = closing * options.lambda_importance + towards
        length = np.linalg.norm(interaction, axis=-1)
        along = interaction / length[..., None]
        cross = along[..., 0] * towards[..., 1] - along[..., 1] * towards[..., 0]
        angle = np.arctan2(cross, (along * towards).sum(axis=-1))
        angle = np.where(np.abs(angle) > _MIN_ANGLE, angle, 0.0)
        reach = options.gamma * length
        gap = np.maximum(distance - 2 * options.safety_radius, 0.0)
        braking = -np.exp(-gap / reach - (options.n_velocity * reach * angle) ** 2)
        aside = -np.sign(angle) * np.exp(-gap / reach - (options.n_angular * reach * angle) ** 2)
        normal = np.stack([-along[..., 1], along[..., 0]], axis=-1)
        force = along * braking[..., None] + normal * aside[..., None]
    acts = (distance >= _MIN_DISTANCE_M) & (length > 0) & (distance <= options.neighbor_threshold)
    return np.asarray(np.where(acts[..., None], options.force_factor_social * force, 0.0))


def obstacle_force(distance: Floats) -> Floats:
    """Magnitude of the push of the nearest static object [m/s^2], with the default parameters and weight of ``sfm``.

    ``sfm`` adds the pushes of all walls, which cancel in the middle of a corridor. Here only the nearest object counts,
    whatever its shape, so the metric is the same for every behavior.

    Args:
        distance: Distance between footprints [m]; NaN without static objects.
    """
    options = Sfm()
    push = options.force_factor_obstacle * np.exp(-np.maximum(distance, 0.0) / options.sigma_obstacle)
    return np.asarray(np.where(distance > _WALL_REACH * options.sigma_obstacle, 0.0, push))


def _impulse(distance: Floats, step_time: float) -> float:
    known = distance[~np.isnan(distance)]
    return float(obstacle_force(known).sum() * step_time) if len(known) else math.nan


def group_gaps(point: Floats, members: Floats) -> Floats:
    """(T,) distance [m] of a point to the convex hull of the members of a group; 0 inside the hull.

    The point is inside if the members surround it; otherwise the nearest point of the hull lies between two members.

    Args:
        point: (T, 2) positions of the point [m].
        members: (T, M, 2) positions of at least two members [m].
    """
    count = members.shape[1]
    best = np.full(len(point), np.inf)
    for a, b in itertools.combinations(range(count), 2):
        start, along = members[:, a], members[:, b] - members[:, a]
        length2 = np.maximum((along**2).sum(axis=1), 1e-300)
        share = np.clip(((point - start) * along).sum(axis=1) / length2, 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(start + along * share[:, None] - point, axis=1))
    to = members - point[:, None]
    angles = np.sort(np.arctan2(to[:, :, 1], to[:, :, 0]), axis=1)
    turns = np.diff(angles, axis=1, append=angles[:, :1] + 2 * np.pi)
    best[turns.max(axis=1) < np.pi] = 0.0
    return best


def _causes(track: Track, event: Event) -> tuple[bool, bool]:
    """Whether the robot, and whether the human, caused a contact."""
    human = track.others[:, track.people.index(str(partner_of(event, track.name))), :2]
    row = min(event.step - track.first, len(track.pose) - 1)
    if row < 1:
        return True, True  # they touch at the start
    contact = np.array([event.x, event.y])
    mine, theirs = (_speed_to(contact, way[row - 1], way[row]) for way in (track.position, human))
    if abs(mine - theirs) <= _EQUAL_SHARE * max(abs(mine), abs(theirs)):
        return True, True
    return mine > theirs, theirs > mine


def _speed_to(point: Floats, before: Floats, after: Floats) -> float:
    """Length [m] by which a step leads towards a point."""
    apart = point - before
    distance = float(np.linalg.norm(apart))
    return float((after - before) @ apart) / distance if distance > 0 else 0.0
