"""Yaw rates of skid steering on several grounds against the equation of the centres of rotation."""

from __future__ import annotations

import numpy as np
import yaml

from irsim.components.kinematics.skid_steer import SkidSteer
from realism.simulated import driven, opened
from realism.validation import Curve, Validation

__all__ = ["validation"]

GROUNDS = ("floor", "gravel", "sand")
SPEED = 0.3
"""Commanded forward speed [m/s]."""


def _law(drive: SkidSteer, turn: np.ndarray) -> np.ndarray:
    """(K,) yaw rates [rad/s] for commanded ones; the sides turn as the controller's distance of both says."""
    assert drive.believed_track is not None
    assert drive.icr_left is not None
    assert drive.icr_right is not None
    left, right = SPEED - drive.believed_track / 2 * turn, SPEED + drive.believed_track / 2 * turn
    rate: np.ndarray = (drive.traction_right * right - drive.traction_left * left) / (drive.icr_left - drive.icr_right)
    return rate


def validation(text: str) -> Validation:
    """One world for each commanded yaw rate, on each ground."""
    scene = yaml.safe_load(text)
    wanted = np.linspace(0.0, 1.5, 11)
    points, lines, last = [], [], (0.0, 0.0)
    for tone, ground in enumerate(GROUNDS):
        drive = {**scene["robot"]["kinematics"], "surface": ground}
        batch = opened({**scene, "robot": {**scene["robot"], "kinematics": drive}}, len(wanted))
        for _ in driven(batch, np.column_stack([np.full_like(wanted, SPEED), wanted]), 1):
            turned = batch.twist[:, 0, 2].copy()
        law = _law(SkidSteer(**drive), wanted)
        points.append(Curve(ground, wanted, turned, tone))
        lines.append(Curve("", wanted, law, tone))
        last = float(turned[-1]), float(law[-1])
    lines.append(Curve("what the controller believes", wanted, wanted, 3, faint=True))
    return Validation(
        x="commanded yaw rate [rad/s]",
        y="yaw rate [rad/s]",
        points=tuple(points),
        lines=tuple(lines),
        quantity=f"Yaw rate on {GROUNDS[-1]} at a command of {wanted[-1]:g} rad/s",
        measured=last[0],
        expected=last[1],
        tolerance=1e-9,
        unit="rad/s",
        setup=f"Points are yaw rates at {SPEED:g} m/s on three grounds, lines the equation.",
    )
