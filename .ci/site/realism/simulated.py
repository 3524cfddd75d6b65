"""Runs of the scenarios on the pages: worlds with controls of their own, and what their sensors report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import yaml

import irsim
from irsim.common.arrays import Floats
from irsim.scenario.open import read_scenario

__all__ = ["circle_through", "driven", "opened", "path_of", "readings"]


def opened(scenario: str | Mapping[str, Any], worlds: int = 1) -> irsim.Batch:
    """Worlds of a scenario with the seeds 0, 1, …, each of which draws its own errors.

    Args:
        scenario: The text of a page, or what YAML reads from it, changed.
        worlds: Their number.
    """
    text = scenario if isinstance(scenario, str) else yaml.safe_dump(dict(scenario))
    resolved, _ = read_scenario(text=text, strict=True)
    return irsim.batch(resolved, worlds, seeds=range(worlds), threads=1)


def driven(batch: irsim.Batch, control: Sequence[float] | Floats, steps: int) -> Iterator[int]:
    """Step all worlds, and say after each step how many there were; the first robots get these controls.

    Args:
        batch: The worlds.
        control: (c,) the same control in every world, or (n, c) one for each world.
        steps: Number of steps.
    """
    given = np.broadcast_to(np.asarray(control, dtype=float), (batch.n, np.shape(control)[-1]))
    for step in range(1, steps + 1):
        batch.step(given[:, None, :])
        yield step


def readings(batch: irsim.Batch) -> Floats:
    """(n, K) a copy of what the sensors without beams report in each world."""
    return batch.simulation.state.readings.reshape(batch.n, -1).copy()


def path_of(batch: irsim.Batch, control: Sequence[float], steps: int) -> Floats:
    """(steps + 1, 3) poses of the first robot of the first world under one control."""
    start = batch.pose[0, 0].copy()
    return np.array([start, *(batch.pose[0, 0].copy() for _ in driven(batch, control, steps))])


def circle_through(path: Floats) -> tuple[float, float, float]:
    """Centre x, y and radius [m] of the circle that fits (K, 2) points best, by least squares."""
    x, y = path[:, 0], path[:, 1]
    solved, *_ = np.linalg.lstsq(np.column_stack([2 * x, 2 * y, np.ones_like(x)]), x**2 + y**2, rcond=None)
    return float(solved[0]), float(solved[1]), float(np.sqrt(solved[2] + solved[0] ** 2 + solved[1] ** 2))
