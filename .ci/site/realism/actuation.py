"""Dead time and lag of actuators against the closed form of a step response."""

from __future__ import annotations

import numpy as np
import yaml

from realism.simulated import driven, opened
from realism.validation import Curve, Validation

__all__ = ["validation"]


def validation(text: str) -> Validation:
    """A robot at rest is commanded 1 m/s."""
    scene, batch = yaml.safe_load(text), opened(text)
    dt, given = scene["world"]["step_time"], scene["robot"]["actuation"]
    delay, lag = given["delay"], given["lag"]
    speed = np.array([batch.velocity[0, 0, 0] for _ in driven(batch, [1.0, 0.0], round(2.5 / dt))])
    time = dt * np.arange(1, len(speed) + 1)
    fine = np.linspace(0, 2.5, 401)
    law = np.where(fine > delay, 1 - np.exp(-(fine - delay) / lag), 0.0)
    reached = float(np.interp(1 - np.exp(-1), speed, time))
    return Validation(
        x="time after the command [s]",
        y="executed speed [m/s]",
        points=(Curve("simulated", time, speed),),
        lines=(Curve("1 − exp(−(t − delay) / lag)", fine, law),),
        quantity="Time at which 63.2 % are executed",
        measured=reached,
        expected=delay + lag,
        tolerance=dt / 1000,
        unit="s",
        setup=f"A robot at rest is commanded 1 m/s, with {delay:g} s of dead time and a lag of {lag:g} s.",
    )
