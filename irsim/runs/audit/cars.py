"""Where the single track of a car takes it, step by step: CommonRoad's equations, written out in Python."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.runs.audit.ground import Under

__all__ = ["single_track"]

_SUB_STEP = 0.01
"""Longest part of a step [s]."""
_ROLLING, _SLIPPING = 0.5, 1.0
"""Speeds up to which wheels roll, and from which on tyres slip [m/s]."""
_SPIN = 0.5
"""From this slip angle on, angles are no longer small [rad]."""
_GRAVITY = 9.81
_Pair = tuple[float, float]
"""Yaw rate [rad/s] and slip angle [rad]."""


def _within(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


def _exponential(rates: Floats, time: float) -> tuple[Floats, Floats]:
    """Exponential of a 2x2 matrix times a time, and the mean of the exponential over that time."""
    halvings = max(0, math.ceil(math.log2(max(np.abs(rates).sum(axis=1).max() * time, 1e-300) / 0.25)))
    part = rates * (time / 2**halvings)
    one = np.eye(2)
    power, exponential, mean, factorial = one, one, one, 1.0
    for k in range(1, 11):
        power, factorial = power @ part, factorial * k
        exponential = exponential + power / factorial
        mean = mean + power / (factorial * (k + 1))
    for _ in range(halvings):
        mean = (exponential + one) @ mean / 2
        exponential = exponential @ exponential
    return exponential, mean


def single_track(
    options: Mapping[str, Any], wheelbase: float
) -> Callable[[list[float], list[float], float, Under], None]:
    """The motion of a car: advances x, y, heading, steering angle, speed, yaw rate and slip angle in place.

    The speed is the one of its wheels, which is more than the one over ground where the rear ones slip.

    Args:
        options: Keys of its drive.
        wheelbase: Distance of the axles [m].
    """
    keys = ("psi_max", "steer_rate", "acce_max", "speed_switch", "speed_min", "speed_max", "mass", "inertia", "front",
            "rear", "height", "friction", "stiffness_front", "stiffness_rear")  # fmt: skip
    (psi_max, steer_rate, acce_max, switch, slowest, fastest, mass, inertia, front, rear, height, friction, stiff_front,
     stiff_rear) = (float(options[key]) for key in keys)  # fmt: skip
    dynamic, mode = options.get("model") != "kinematic", options.get("mode")
    saturates = options.get("tyres") != "linear"
    length, back = front + rear, rear if dynamic else 0.0

    def possible(speed: float, wanted: float, pull: float) -> float:
        if (speed <= slowest and wanted <= 0) or (speed >= fastest and wanted >= 0):
            return 0.0
        most = acce_max * pull
        return _within(wanted, -most, min(most, acce_max * switch / speed if speed > switch else acce_max))

    def rolling(speed: float, psi: float) -> _Pair:
        slope = math.tan(psi) / length
        slip = math.atan(slope * rear)
        return speed * math.cos(slip) * slope, slip

    def blended(speed: float, psi: float, tyres: _Pair) -> _Pair:
        share = _within((speed - _ROLLING) / (_SLIPPING - _ROLLING), 0.0, 1.0)
        share *= share * (3 - 2 * share)
        wheels = rolling(speed, psi)
        return share * tyres[0] + (1 - share) * wheels[0], share * tyres[1] + (1 - share) * wheels[1]

    def equations(
        speed: float, psi: float, acceleration: float, now: _Pair, hold: list[float]
    ) -> tuple[Floats, Floats]:
        rates, constant = np.array([[0.0, 0.0], [-1.0, 0.0]]), np.zeros(2)
        ahead, aside = abs(speed * math.cos(now[1])), speed * math.sin(now[1])
        for load, stiffness, place, angle, held in (
            (_GRAVITY * rear - acceleration * height, stiff_front, front, psi, hold[0]),
            (_GRAVITY * front + acceleration * height, stiff_rear, -rear, 0.0, hold[1]),
        ):
            grip = friction * held * max(0.0, load) / length
            give, arm = grip * stiffness, mass / inertia * place
            slide = angle - now[1] - place * now[0] / speed
            if not saturates or (abs(now[1]) <= _SPIN and abs(slide) * stiffness <= 1):
                constant += [arm * give * angle, give * angle / speed]
                rates -= [[arm * place * give / speed, arm * give], [place * give / speed**2, give / speed]]
            else:
                slide = angle - math.atan2(aside + place * now[0], ahead)
                force = _within(give * slide, -grip, grip)
                constant += [arm * force, force * math.cos(now[1]) / speed]
        return rates, constant

    def advanced(speed: float, psi: float, acceleration: float, now: _Pair, dt: float, hold: list[float]) -> _Pair:
        rates, constant = equations(speed, psi, acceleration, now, hold)
        exponential, mean = _exponential(rates, dt)
        yaw, slip = (exponential @ now + dt * (mean @ constant)).tolist()
        return yaw, slip

    def part(inner: list[float], control: list[float], dt: float, under: Under) -> tuple[float, float, float, float]:
        """Advance the inner states; speed in the middle, turn, slip angle in the middle, change of the slip angle."""
        psi0, rolled0, tyres0 = inner[0], inner[1], (inner[2], inner[3])
        kept, hold = 1 - under[0][1], under[1]
        pull = min(1.0, 0.5 * (hold[0] + hold[1]))
        if mode in (None, "steer"):
            way = _within(_within(control[1], -psi_max, psi_max) - psi0, -steer_rate * dt, steer_rate * dt)
        else:
            way = _within(control[1], -steer_rate, steer_rate) * dt
        psi = _within(psi0 + way, -psi_max, psi_max)
        wanted = control[0] if mode == "acceleration" else (control[0] - rolled0) / dt
        gain = possible(rolled0 + 0.5 * dt * possible(rolled0, wanted, pull), wanted, pull)
        rolled = rolled0 + gain * dt
        if mode == "acceleration":
            rolled = _within(rolled, min(rolled0, slowest), max(rolled0, fastest))
        inner[:2] = psi, rolled
        speed0, speed = rolled0 * kept, rolled * kept
        v, angle = 0.5 * (speed0 + speed), 0.5 * (psi0 + psi)
        if not dynamic:
            inner[2:] = speed * math.tan(psi) / wheelbase, 0.0
            return v, v * math.tan(angle) / wheelbase * dt, 0.0, 0.0
        first, after = blended(speed0, psi0, tyres0), rolling(speed, psi)
        if v <= _ROLLING:
            turn, slip = rolling(v, angle)[0] * dt, rolling(v, angle)[1]
        else:
            change = (speed - speed0) / dt
            middle = advanced(v, angle, change, tyres0, 0.5 * dt, hold)
            after = advanced(v, angle, change, middle, 0.5 * dt, hold)
            between, last = blended(v, angle, middle), blended(speed, psi, after)
            turn = dt / 6 * (first[0] + 4 * between[0] + last[0])
            slip = (first[1] + 4 * between[1] + last[1]) / 6
            if speed <= _ROLLING:
                after = rolling(speed, psi)
        inner[2:] = after
        return v, turn, slip, blended(speed, psi, after)[1] - first[1]

    def step(state: list[float], control: list[float], dt: float, under: Under) -> None:
        parts = max(1, math.ceil(dt / _SUB_STEP - 1e-9))
        x, y, heading = state[0] + back * math.cos(state[2]), state[1] + back * math.sin(state[2]), state[2]
        inner = state[3:]
        for _ in range(parts):
            speed, turn, slip, bend = part(inner, control, dt / parts, under)
            chord = speed * dt / parts * float(np.sinc(0.5 * (turn + bend) / math.pi))
            x += chord * math.cos(heading + 0.5 * turn + slip)
            y += chord * math.sin(heading + 0.5 * turn + slip)
            heading += turn
        state[:] = [x - back * math.cos(heading), y - back * math.sin(heading), heading, *inner]

    return step
