"""Circles of a tricycle against the radius that its steering angle and wheelbase give."""

from __future__ import annotations

import math

import numpy as np
import yaml

from realism.simulated import circle_through, opened, path_of
from realism.validation import Curve, Validation

__all__ = ["validation"]

ANGLES = (math.pi / 6, math.pi / 4, math.pi / 2)
"""Steering angles [rad]; the first one is measured."""


def validation(text: str) -> Validation:
    """One run for each steering angle, at a wheel speed of 1 m/s."""
    scene = yaml.safe_load(text)
    base, dt = scene["robot"]["kinematics"]["wheelbase"], scene["world"]["step_time"]
    points, lines, radii = [], [], []
    around = np.linspace(0, 2 * math.pi, 181)
    for tone, angle in enumerate(ANGLES):
        # The first step turns the wheel; the rest is a circle.
        path = path_of(opened(text), [1.0, angle], round(2 * math.pi * base / math.sin(angle) / dt))[1:]
        at, radius = path[0], base / math.tan(angle)
        x, y = at[0] - radius * math.sin(at[2]), at[1] + radius * math.cos(at[2])
        radii.append(circle_through(path[:, :2])[2] if radius > 1e-6 else 0.0)
        points.append(Curve(f"{math.degrees(angle):.0f}°", path[::10, 0], path[::10, 1], tone))
        lines.append(Curve("", x + radius * np.cos(around), y + radius * np.sin(around), tone))
    return Validation(
        x="x [m]",
        y="y [m]",
        points=tuple(points),
        lines=tuple(lines),
        quantity=f"Radius at {math.degrees(ANGLES[0]):.0f}°",
        measured=radii[0],
        expected=base / math.tan(ANGLES[0]),
        tolerance=1e-6,
        unit="m",
        setup="Points are the middle of the rear axle at three steering angles, lines the circles of radius L / tan δ.",
        paths=True,
    )
