"""Drives in tests: their motion under given controls, step by step, and the same motion integrated finely."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import irsim._core as core

EULER, EXACT = 0, 1


def driven(drive: Any, state: Sequence[float], controls: Sequence[Sequence[float]], dt: float = 0.1) -> np.ndarray:
    """(K + 1, S) states under K controls, by the drive of the core with exact integration."""
    states = [list(map(float, state))]
    for control in controls:
        after, _ = core.drive_step(drive, states[-1], list(control), dt, EXACT)
        states.append(list(after))
    return np.array(states)


def fine(
    rates: Callable[[np.ndarray, Sequence[float]], np.ndarray],
    state: Sequence[float],
    controls: Sequence[Sequence[float]],
    dt: float = 0.1,
    parts: int = 1000,
) -> np.ndarray:
    """(K + 1, S) states under K controls, by fourth-order Runge-Kutta in small parts of each step."""
    states, h = [np.array(state, dtype=float)], dt / parts
    for u in controls:
        y = states[-1]
        for _ in range(parts):
            a = rates(y, u)
            b = rates(y + h / 2 * a, u)
            c = rates(y + h / 2 * b, u)
            y = y + h / 6 * (a + 2 * b + 2 * c + rates(y + h * c, u))
        states.append(y)
    return np.array(states)
