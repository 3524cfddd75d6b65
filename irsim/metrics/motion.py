"""Metrics of motion: Francis et al. (arXiv 2306.16740), ST, PL, V, A, J; HuNavSim; Arena; SocNavBench."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irsim.metrics.trajectory import Track, thin_path

__all__ = ["curvatures", "motion_metrics", "runs_of"]

_STALL_SPEED = 0.05
"""Speed [m/s] below which a robot is stalled, if it also turns slowly."""
_STALL_TURN_RATE = 0.05
"""Turn rate [rad/s] below which a robot is stalled, if it also moves slowly."""
_FREEZE_S = 2.0
"""Duration [s] from which on a stall counts as freezing."""


def motion_metrics(track: Track) -> dict[str, float]:
    """Speed, its derivatives and the shape of the path of a robot, until it arrived.

    - ``stalled_time`` [s]: speed < 0.05 m/s and yaw rate < 0.05 rad/s. ``freezing_count``, ``freezing_time``: stalls of
      at least 2 s.
    - ``velocity_avg`` [m/s]: distance travelled / time; reversing counts as positive.
    - ``acceleration_*``, ``jerk_*``: magnitudes of the second and third differences of position over dt^2 and dt^3,
      that is vector derivatives by central differences of the executed velocity, unfiltered. NaN for less than 3 and 4
      positions.
    - ``cumulative_heading_change`` [rad], and divided by the path ``angle_over_length`` [rad/m]: of the body, but of
      the direction of motion for drives that need not turn to move (see ``Track.bends``).
    - ``curvature``, ``roughness`` [1/m]: see :func:`curvatures`.
    - ``motion_energy`` [m^2/s]: sum of squared speed times dt (unit mass).
    - ``control_effort`` [s]: sum over steps and controls of (executed control / its greatest magnitude)^2 times dt, of
      the controls that have a finite limit above 0; NaN without any.
    - ``left_world``: whether its position ever was outside the world, 0 or 1.
    """
    dt, speed = track.step_time, track.speed
    stalled = (speed < _STALL_SPEED) & (np.abs(track.turning) < _STALL_TURN_RATE * dt)
    long = [run for run in runs_of(stalled) if (run[1] - run[0]) * dt >= _FREEZE_S - 1e-9]
    turned = float(np.abs(track.bends).sum())
    length = track.path_length
    bends = curvatures(track.position)
    metrics = {
        "stalled_time": float(stalled.sum() * dt),
        "path_length": length,
        "velocity_min": _or_nan(speed, np.min),
        "velocity_avg": length / (len(speed) * dt) if len(speed) else float("nan"),
        "velocity_max": _or_nan(speed, np.max),
    }
    for name, order in (("acceleration", 2), ("jerk", 3)):
        change = np.linalg.norm(np.diff(track.position, n=order, axis=0), axis=1) / dt**order
        metrics |= {
            f"{name}_min": _or_nan(change, np.min),
            f"{name}_avg": _or_nan(change, np.mean),
            f"{name}_max": _or_nan(change, np.max),
        }
    return metrics | {
        "cumulative_heading_change": turned,
        "curvature": _or_nan(bends, np.mean),
        "roughness": _or_nan(np.abs(np.diff(bends)), np.mean),
        "angle_over_length": turned / length if length > 0 else float("nan"),
        "motion_energy": float((speed**2).sum() * dt),
        "control_effort": _effort(track),
        "left_world": float(track.outside.any()),
        "freezing_count": float(len(long)),
        "freezing_time": float(sum(end - begin for begin, end in long) * dt),
    }


def _effort(track: Track) -> float:
    limits = track.limits[: track.control.shape[1]]  # `vel_dim` may name more controls than the drive has
    bounded = np.isfinite(limits) & (limits > 0)
    if not bounded.any():
        return float("nan")
    shares = track.control[:, bounded] / limits[bounded]
    return float((shares**2).sum() * track.step_time)


def curvatures(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(K - 2,) Menger curvature [1/m] of three successive points of a path, thinned to K points 0.05 m apart.

    The curvature of three points is 4 x area of their triangle / product of its sides.
    """
    kept = thin_path(points)
    if len(kept) < 3:
        return np.zeros(0)
    a, b, c = kept[:-2], kept[1:-1], kept[2:]
    ab, bc, ca = b - a, c - b, a - c
    area2 = np.abs(ab[:, 0] * bc[:, 1] - ab[:, 1] * bc[:, 0])
    sides = np.linalg.norm(ab, axis=1) * np.linalg.norm(bc, axis=1) * np.linalg.norm(ca, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(sides > 0, 2 * area2 / sides, 0.0))


def runs_of(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(first, one past the last) row of each run of set flags."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _or_nan(values: NDArray[np.float64], take: object) -> float:
    return float(take(values)) if len(values) else float("nan")  # type: ignore[operator]
