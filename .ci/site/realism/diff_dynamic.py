"""The start of a heavy robot against the closed form of a motor with a largest torque and a largest voltage."""

from __future__ import annotations

import math

import numpy as np
import yaml

from irsim.components.kinematics.diff_dynamic import DiffDynamic
from realism.simulated import driven, opened
from realism.validation import Curve, Validation

__all__ = ["validation"]

DURATION = 6.0
"""Length of the run [s]."""


def _law(base: DiffDynamic, time: np.ndarray) -> np.ndarray:
    """(K,) speed [m/s] of a start from rest: at the largest torque first, then at the largest voltage."""
    assert base.torque_max is not None
    assert base.voltage is not None
    motor = base.torque_constant * base.gear / base.wheel_radius  # force of a wheel per current, voltage per speed
    force = 2 * base.torque_max / base.wheel_radius
    switch = (base.voltage - base.resistance * base.torque_max / base.wheel_radius / motor) / motor  # speed there
    first = base.mass / base.drag
    until = -first * math.log(1 - switch * base.drag / force)
    damping = 2 * motor**2 / base.resistance + base.drag
    top, second = 2 * motor / base.resistance * base.voltage / damping, base.mass / damping
    early = force / base.drag * (1 - np.exp(-time / first))
    late = top + (switch - top) * np.exp(-(time - until) / second)
    return np.where(time < until, early, late)


def validation(text: str) -> Validation:
    """The robot is commanded more than it can drive."""
    scene, batch = yaml.safe_load(text), opened(text)
    dt, base = scene["world"]["step_time"], DiffDynamic(**scene["robot"]["kinematics"])
    radius = base.wheel_radius
    speed = np.array([radius * batch.extra[0, 0, :2].mean() for _ in driven(batch, [5.0, 0.0], round(DURATION / dt))])
    time, fine = dt * np.arange(1, len(speed) + 1), np.linspace(0, DURATION, 301)
    at = round(2.0 / dt) - 1
    law = float(_law(base, np.array([2.0]))[0])
    return Validation(
        x="time after the command [s]",
        y="speed [m/s]",
        points=(Curve("simulated", time[::2], speed[::2]),),
        lines=(Curve("closed form", fine, _law(base, fine)),),
        quantity="Speed after 2 s",
        measured=float(speed[at]),
        expected=law,
        tolerance=1e-5,
        unit="m/s",
        setup=f"A robot of {base.mass:g} kg starts; its largest torque limits it first, then its voltage.",
    )
