"""Observations for tests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from irsim.policies import Neighbors, Observations, Scan
from irsim.policies.networks.lookahead import take_rows

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
    limit = np.tile([1.0, 3.0, 0.0], (count, 1))

    def seen(low: float, high: float, *more: int) -> Any:
        there = mask[:, :, None] if more else mask
        return np.where(there, rng.uniform(low, high, (count, neighbors, *more)), 0.0)

    places, headings = seen(-5, 5, 2), seen(-3, 3)
    others = Neighbors(
        pose=np.concatenate([places, headings[..., None]], axis=2),
        velocity=seen(-1, 1, 2),
        radius=seen(0.1, 0.5),
        arrived=mask & (rng.uniform(size=mask.shape) < 0.3),
        mask=mask,
        index=np.where(mask, np.arange(neighbors), -1),
        robot=mask & (rng.uniform(size=mask.shape) < 0.7),
        extent=seen(0.1, 0.5),
        own_extent=seen(0.1, 0.5),
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


def people(*rows: tuple[float, ...], count: int | None = None, radius: float = 0.3, **given: Any) -> Neighbors:
    """Neighbors of one robot that stand at x, y or move with x, y, vx, vy; padded to ``count`` rows."""
    size = len(rows) if count is None else count
    table = np.zeros((1, size, 4))
    for k, row in enumerate(rows):
        table[0, k, : len(row)] = row
    mask = (np.arange(size) < len(rows))[None]
    pose = np.concatenate([table[:, :, :2], np.zeros((1, size, 1))], axis=2)
    flags = np.zeros((1, size), bool)
    index, radii = np.where(mask, np.arange(size), -1), np.where(mask, radius, 0.0)
    made = Neighbors(pose, table[:, :, 2:].copy(), radii, flags, mask, index, flags)
    return replace(made, **{key: np.array(value) for key, value in given.items()})


def rows(whole: Observations, wanted: Any) -> Observations:
    """Some of the robots, in this order."""
    wanted = np.asarray(wanted)
    scan = None if whole.scan is None else replace(whole.scan, ranges=whole.scan.ranges[wanted])
    maps = None if whole.maps is None else tuple(whole.maps[k] for k in wanted)
    return replace(take_rows(whole, wanted), scan=scan, maps=maps)


def moved(whole: Observations, turn: float, shift: tuple[float, float]) -> Observations:
    """The same robots and goals in a world that is turned and shifted; without scan and maps."""
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([[c, s], [-s, c]])

    def placed(poses: Any) -> Any:
        return np.concatenate([poses[..., :2] @ turned + shift, poses[..., 2:] + turn], axis=-1)

    seen = whole.neighbors
    others = replace(seen, pose=placed(seen.pose), velocity=seen.velocity @ turned)
    there = {"pose": placed(whole.pose), "goal": placed(whole.goal), "velocity": whole.velocity @ turned}
    return replace(whole, **there, neighbors=others, scan=None, maps=None)


def same_bits(a: Any, b: Any) -> bool:
    """Whether two arrays are equal, bit for bit."""
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def assert_same_in_any_company(decide: Callable[[Observations], Any], whole: Observations) -> Any:
    """A robot gets the same bits alone, in a batch, and in another order; returns the decisions of the batch."""
    together, count = decide(whole), len(whole)
    order = np.random.default_rng(count).permutation(count)
    assert same_bits(decide(rows(whole, order)), together[order])
    for k in range(count):
        assert same_bits(decide(rows(whole, [k])), together[k : k + 1])
    return together
