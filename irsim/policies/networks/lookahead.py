"""Looking ahead: the moves that a robot can choose from, and what the world will be after each of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from irsim.common.arrays import Floats
from irsim.options.base import Options
from irsim.options.units import Fraction, Integer, Meters, Number, Seconds
from irsim.policies.networks.values import Frame, turn_back, x_axis
from irsim.policies.observations import Neighbors, Observations

__all__ = [
    "Futures",
    "Lookahead",
    "MoveSet",
    "PredictedReward",
    "best_moves",
    "look_ahead",
    "moves_of",
    "straight",
    "take_rows",
]

_LARGEST_TURN = math.pi / 4
"""Largest change of the heading in one decision of a unicycle [rad]."""


class MoveSet(Options):
    """The moves that are compared: standing still, and speeds times headings.

    The speeds are (exp(k / speeds) - 1) / (e - 1) of the largest speed of the robot, for k from 1.
    """

    kind: Literal["holonomic", "unicycle"] = "holonomic"
    """Velocities in all directions, or speeds with changes of the heading up to 45 degrees to each side."""
    speeds: Annotated[Integer, Field(ge=1, le=50)] = 5
    """Number of speeds."""
    headings: Annotated[Integer, Field(ge=1, le=360)] = 16
    """Number of directions, or of changes of the heading."""
    frame: Frame = "world"
    """Frame in which the first direction of a holonomic robot is along x; `goal` makes decisions independent of how
    the world is turned."""

    @property
    def count(self) -> int:
        """Number of moves."""
        return 1 + self.speeds * self.headings


class PredictedReward(Options):
    """The reward of a move, of which only the first that applies counts."""

    collision: Number = -0.25
    """For coming so close to a neighbor that the bounding circles overlap."""
    goal: Number = 1.0
    """For coming closer to the goal than its threshold."""
    discomfort: Annotated[Number, Field(ge=0)] = 0.5
    """Cost for each second and each metre that is missing to `distance`."""
    distance: Annotated[Meters, Field(ge=0)] = 0.2
    """Gap between the bounding circles from which on a neighbor is not disturbed."""
    gap: Literal["end", "smallest"] = "end"
    """Which gap counts: that at the end of the move, or the smallest one while all go straight on."""


class Lookahead(Options):
    """Choose the move with the largest reward + gamma^(dt v) V, the first of equal ones.

    V is the value of the state after the move, which the network returns: the robot has moved for `dt`, and neighbors
    have kept their velocities. v is the largest speed of the robot. A robot that is within the threshold of its goal
    stands still, and one that sees no neighbor goes straight to its goal.

    Source: Chen, Liu, Kreiss, Alahi: Crowd-Robot Interaction (2019).
    """

    moves: MoveSet = MoveSet()
    """The moves."""
    dt: Annotated[Seconds, Field(gt=0)] = 0.25
    """How far it looks ahead."""
    gamma: Fraction = 0.9
    """Discount for each metre at the largest speed."""
    reward: PredictedReward = PredictedReward()
    """The reward of a move."""


@dataclass(frozen=True)
class Futures:
    """Possible moves of B robots, and their consequences.

    Attributes:
        move: (B, A, 2) velocities in the world frame [m/s]; of a unicycle speed [m/s] and change of the heading [rad].
        observations: Predicted observations, B * A rows, first all rows of the first robot.
        reward: (B, A) predicted reward.
        discount: (B,) factor of the value of the state that follows.
    """

    move: Floats
    observations: Observations
    reward: Floats
    discount: Floats


def take_rows(observations: Observations, rows: NDArray[np.intp] | slice) -> Observations:
    """Observations of some of the robots, in this order, without scans and maps."""

    def taken(whole: Observations | Neighbors) -> dict[str, NDArray[np.generic]]:
        result = ((field.name, getattr(whole, field.name)) for field in fields(whole))
        return {name: value[rows] for name, value in result if isinstance(value, np.ndarray)}

    seen = observations.neighbors
    others = None if seen is None else replace(seen, **taken(seen))  # type: ignore[arg-type]
    changed = taken(observations)
    return replace(observations, **changed, neighbors=others, scan=None, maps=None)  # type: ignore[arg-type]


def moves_of(options: MoveSet) -> tuple[Floats, Floats]:
    """The moves, standing still first, then all speeds of each heading.

    Returns:
        (A,) speeds as shares of the largest speed, and (A,) headings or changes of the heading [rad].
    """
    count = options.speeds
    shares = [(math.exp((k + 1) / count) - 1.0) / (math.e - 1.0) for k in range(count)]
    if options.kind == "holonomic":
        angles = [2.0 * math.pi * k / options.headings for k in range(options.headings)]
    else:
        steps = max(options.headings - 1, 1)
        angles = [_LARGEST_TURN * (2.0 * k / steps - 1.0) for k in range(options.headings)]
        angles = [0.0] if options.headings == 1 else angles
    pairs = [(0.0, 0.0), *((share, angle) for angle in angles for share in shares)]
    return np.array([share for share, _ in pairs]), np.array([angle for _, angle in pairs])


def look_ahead(options: Lookahead, observations: Observations) -> Futures:
    """Predict what follows from each move of B robots.

    Args:
        options: The moves, the time and the reward.
        observations: Present observations of the robots, with neighbors.
    """
    o, dt = observations, options.dt
    shares, angles = moves_of(options.moves)
    size, count = len(o), len(shares)
    speed = o.high[:, :1] * shares
    move, heading = _moves(options.moves, o, speed, angles)
    if options.moves.kind == "unicycle":
        sides = [(math.cos(angle), math.sin(angle)) for angle in heading.reshape(-1).tolist()]
        velocity = np.array(sides).reshape(size, count, 2) * speed[:, :, None]
    else:
        velocity = move
    flat, rows = velocity.reshape(-1, 2), np.repeat(np.arange(size), count)
    later = take_rows(o, rows)
    pose = np.concatenate([later.pose[:, :2] + flat * dt, heading.reshape(-1, 1)], axis=1)
    seen = later.neighbors
    reward = _reward(options, later, pose, flat).reshape(size, count)
    if seen is not None:
        moved = np.concatenate([seen.position + seen.velocity * dt, seen.heading[..., None]], axis=-1)
        seen = replace(seen, pose=moved)
    turned = (pose[:, 2] - later.pose[:, 2]) / dt if options.moves.kind == "unicycle" else np.zeros(len(flat))
    later = replace(later, pose=pose, velocity=flat, yaw_rate=turned, time=later.time + dt, neighbors=seen)
    discount = np.array([options.gamma ** (dt * v) for v in o.high[:, 0].tolist()])
    return Futures(move, later, reward, discount)


def _moves(options: MoveSet, o: Observations, speed: Floats, angles: Floats) -> tuple[Floats, Floats]:
    """(B, A, 2) moves as in :class:`Futures`, and (B, A) headings after them [rad]."""
    if options.kind == "unicycle":
        heading = np.mod(o.pose[:, 2:], 2.0 * math.pi) + angles
        turn = np.broadcast_to(angles, speed.shape)
        return np.stack([speed, turn], axis=-1), heading
    directions = np.array([(math.cos(angle), math.sin(angle)) for angle in angles.tolist()])
    back = x_axis(options.frame, o.pose, o.goal) * np.array([1.0, -1.0])
    turned = turn_back(directions[None], back[:, None])
    return speed[:, :, None] * turned, np.repeat(o.pose[:, 2:], len(angles), axis=1)


def _reward(options: Lookahead, before: Observations, pose: Floats, velocity: Floats) -> Floats:
    """(N,) rewards of N moves.

    Args:
        options: The time and the reward.
        before: Observations before the moves, one row for each.
        pose: (N, 3) poses after them, world frame.
        velocity: (N, 2) velocities during them [m/s], world frame.
    """
    reward, dt = options.reward, options.dt
    away = before.goal[:, :2] - pose[:, :2]
    near = np.sqrt(away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1]) < before.goal_threshold  # False without a goal
    result = np.where(near, reward.goal, 0.0)
    seen = before.neighbors
    if seen is None or seen.mask.shape[1] == 0:
        return result
    relative = seen.position - before.pose[:, None, :2]
    drift = (seen.velocity - velocity[:, None]) * dt
    share = np.ones(seen.mask.shape)
    if reward.gap == "smallest":
        length = drift[..., 0] * drift[..., 0] + drift[..., 1] * drift[..., 1]
        along = -(relative[..., 0] * drift[..., 0] + relative[..., 1] * drift[..., 1])
        share = np.clip(along / np.where(length > 0, length, 1.0), 0.0, 1.0)
    closest = relative + share[:, :, None] * drift
    distance = np.sqrt(closest[..., 0] * closest[..., 0] + closest[..., 1] * closest[..., 1])
    gaps = np.where(seen.mask, distance - before.radius[:, None] - seen.radius, np.inf)
    gap = gaps.min(axis=1)
    missing = np.minimum(gap - reward.distance, 0.0) * reward.discomfort * dt
    result = np.where(near, reward.goal, np.where(np.isfinite(missing), missing, 0.0))
    return np.where(gap < 0.0, reward.collision, result)


def best_moves(values: Floats, futures: Futures) -> Floats:
    """(B, 2) moves with the largest return, the first of equal ones.

    Args:
        values: (B, A) values of the states after the moves.
        futures: The moves.
    """
    returns = futures.reward + futures.discount[:, None] * values
    best = np.argmax(np.where(np.isnan(returns), -np.inf, returns), axis=1)
    chosen: Floats = futures.move[np.arange(len(best)), best]
    return chosen


def straight(options: Lookahead, observations: Observations) -> Floats:
    """(B, 2) moves straight to the goal, no farther than it, in the form of :class:`Futures`; zero without a goal."""
    o = observations
    there = np.isfinite(o.goal[:, 0]) & np.isfinite(o.goal[:, 1])
    away = np.where(there[:, None], o.goal[:, :2] - o.pose[:, :2], 0.0)
    distance = np.sqrt(away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1])
    speed = np.minimum(o.high[:, 0], distance / options.dt)
    if options.moves.kind == "holonomic":
        result: Floats = speed[:, None] * away / np.where(distance > 0, distance, 1.0)[:, None]
        return result
    ahead = turn_back(away, x_axis("own", o.pose, o.goal))
    bearing = np.array([math.atan2(y, x) for x, y in ahead.tolist()]).reshape(-1)
    turn = np.clip(bearing, -_LARGEST_TURN, _LARGEST_TURN)
    facing = np.array([max(0.0, math.cos(angle)) for angle in (bearing - turn).tolist()]).reshape(-1)
    return np.stack([speed * facing, turn], axis=1)
