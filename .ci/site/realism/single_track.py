"""Steady yaw rates of a car with tyres against the closed form of understeer."""

from __future__ import annotations

import numpy as np
import yaml

from irsim.components.kinematics.single_track import SingleTrack
from realism.simulated import driven, opened
from realism.validation import Curve, Validation

__all__ = ["validation"]

ANGLE = 0.004
"""Steering angle, small enough for tyres that answer in proportion [rad]."""
GRAVITY = 9.81
"""[m/s²]."""
MEASURED = 5.0
"""Speed of the number in the caption [m/s]."""


def validation(text: str) -> Validation:
    """One world for each speed, until the yaw rate is steady."""
    scene = yaml.safe_load(text)
    car = SingleTrack(**scene["robot"]["kinematics"])
    assert car.stiffness_front is not None
    assert car.stiffness_rear is not None
    assert car.friction is not None
    assert car.wheelbase is not None
    speeds = np.array([1.5, 2.0, 3.0, 4.0, MEASURED, 6.0, 7.0, 8.0])
    batch = opened(scene, len(speeds))
    for _ in driven(batch, np.column_stack([speeds, np.full_like(speeds, ANGLE)]), 200):
        pass
    gains = batch.twist[:, 0, 2] / ANGLE
    gradient = (1 / car.stiffness_front - 1 / car.stiffness_rear) / (car.friction * GRAVITY)
    fine = np.linspace(0.0, 8.5, 200)
    at = int(np.flatnonzero(speeds == MEASURED)[0])
    law = MEASURED / (car.wheelbase + gradient * MEASURED**2)
    return Validation(
        x="speed [m/s]",
        y="yaw rate per steering angle [1/s]",
        points=(Curve("simulated", speeds, gains),),
        lines=(
            Curve("v / (L + K v²)", fine, fine / (car.wheelbase + gradient * fine**2)),
            Curve("v / L, without slip", fine[fine < 6], fine[fine < 6] / car.wheelbase, 3, faint=True),
        ),
        quantity=f"Yaw rate per steering angle at {MEASURED:g} m/s",
        measured=float(gains[at]),
        expected=law,
        tolerance=1e-4 * law,
        unit="1/s",
        setup=f"An F1TENTH car drives with a steering angle of {ANGLE:g} rad until its yaw rate is steady.",
    )
