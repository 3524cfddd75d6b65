"""Observations for tests."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from irsim.policies import Neighbors, Observations, Scan

BEAMS = 24


@dataclass(frozen=True)
class Grid:
    """A map."""

    occupied: Any
    origin: tuple[float, float]
    resolution: float


def observations(count: int = 7, seed: int = 0, neighbors: int = 5) -> Observations:
    """Observations of some robots of two worlds; the last has no goal, and the first no neighbor."""
    rng = np.random.default_rng(seed)
    goal = rng.uniform(-5, 5, (count, 3))
    goal[-1] = np.nan
    mask = np.arange(neighbors) < rng.integers(0, neighbors + 1, count)[:, None]
    mask[0] = False
    there = mask[:, :, None]
    limit = np.tile([1.0, 3.0, 0.0], (count, 1))
    others = Neighbors(
        mask=mask,
        index=np.where(mask, np.arange(neighbors), -1),
        position=np.where(there, rng.uniform(-5, 5, (count, neighbors, 2)), 0.0),
        heading=np.where(mask, rng.uniform(-3, 3, (count, neighbors)), 0.0),
        velocity=np.where(there, rng.uniform(-1, 1, (count, neighbors, 2)), 0.0),
        radius=np.where(mask, rng.uniform(0.1, 0.5, (count, neighbors)), 0.0),
        arrived=mask & (rng.uniform(size=mask.shape) < 0.3),
        robot=mask & (rng.uniform(size=mask.shape) < 0.7),
        extent=np.where(mask, rng.uniform(0.1, 0.5, mask.shape), 0.0),
        own_extent=np.where(mask, rng.uniform(0.1, 0.5, mask.shape), 0.0),
    )
    maps = [Grid(rng.uniform(size=(60, 50)) < 0.1, (-3.0, -2.5), 0.1) for _ in range(2)]
    world = np.arange(count) % 2
    return Observations(
        world=world,
        robot=np.arange(count) // 2,
        first=np.zeros(count, dtype=bool),
        time=np.full(count, 1.5),
        step_time=0.1,
        pose=rng.uniform(-3, 3, (count, 3)),
        steering=rng.uniform(-0.5, 0.5, count),
        velocity=rng.uniform(-1, 1, (count, 2)),
        yaw_rate=rng.uniform(-1, 1, count),
        control=rng.uniform(-1, 1, (count, 3)) * [1, 1, 0],
        goal=goal,
        goal_threshold=np.full(count, 0.3),
        radius=rng.uniform(0.1, 0.5, count),
        low=-limit,
        high=limit,
        arrived=rng.uniform(size=count) < 0.3,
        neighbors=others,
        scan=Scan(rng.uniform(0.1, 8, (count, BEAMS)), np.linspace(-1.5, 1.5, BEAMS), 8.0),
        maps=tuple(maps[w] for w in world),
        commanded=rng.uniform(-1, 1, (count, 2)),
    )


def rows(whole: Observations, wanted: Any) -> Observations:
    """Some of the robots, in this order."""
    wanted = np.asarray(wanted)
    changed: dict[str, Any] = {
        field.name: value[wanted]
        for field in fields(whole)
        if isinstance(value := getattr(whole, field.name), np.ndarray)
    }
    if whole.neighbors is not None:
        seen = whole.neighbors
        changed["neighbors"] = Neighbors(**{field.name: getattr(seen, field.name)[wanted] for field in fields(seen)})
    if whole.scan is not None:
        changed["scan"] = replace(whole.scan, ranges=whole.scan.ranges[wanted])
    if whole.maps is not None:
        changed["maps"] = tuple(whole.maps[k] for k in wanted)
    return replace(whole, **changed)


def moved(whole: Observations, turn: float, shift: tuple[float, float]) -> Observations:
    """The same robots and goals in a world that is turned and shifted; without scan and maps."""
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([[c, s], [-s, c]])

    def placed(poses: Any) -> Any:
        return np.concatenate([poses[:, :2] @ turned + shift, poses[:, 2:] + turn], axis=1)

    seen = whole.neighbors
    assert seen is not None
    others = replace(
        seen, position=seen.position @ turned + shift, heading=seen.heading + turn, velocity=seen.velocity @ turned
    )
    return replace(
        whole,
        pose=placed(whole.pose),
        goal=placed(whole.goal),
        velocity=whole.velocity @ turned,
        neighbors=others,
        scan=None,
        maps=None,
    )


def same_bits(a: Any, b: Any) -> bool:
    """Whether two arrays are equal, bit for bit."""
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
