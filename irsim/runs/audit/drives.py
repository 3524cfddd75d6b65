"""Where drives with inner states take a body, step by step: written out in Python, without the engine."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.runs.audit.artifact import Artifact, Body
from irsim.runs.audit.cars import single_track
from irsim.runs.audit.ground import FIRM, Footing, Under

__all__ = ["INNER", "ends_of"]

_SUB_STEP = 0.01
"""Longest part of a step [s]."""
_GRAVITY = 9.81
Step = Callable[[list[float], list[float], float, Under], None]
"""Advances x, y, heading and inner state under a control by a step, in place; the heading is not wrapped."""


def _arc(state: list[float], forward: float, lateral: float, rate: float, dt: float) -> None:
    half = 0.5 * rate * dt
    chord = dt * float(np.sinc(half / math.pi))
    c, s = math.cos(state[2] + half), math.sin(state[2] + half)
    state[0] += (forward * c - lateral * s) * chord
    state[1] += (forward * s + lateral * c) * chord
    state[2] += rate * dt


def _tricycle(body: Body, exact: bool) -> Step:
    options = body.options.kinematics or {}
    wheelbase = body.options.wheelbase or 1.0
    most, lag = _number(options, "psi_max", math.pi / 2), _number(options, "steer_lag", 0.0)
    rate, acce = _number(options, "steer_rate", math.inf), _number(options, "steer_acce", math.inf)
    by_rate, ideal = options.get("mode") == "angular", lag == 0 and math.isinf(rate) and math.isinf(acce)

    def turn_wheel(state: list[float], wanted: float, dt: float) -> None:
        """Turn the wheel for a time; without a limit of the acceleration in one go."""
        psi, before, change = state[3], state[4], acce * dt
        kept = math.exp(-dt / lag) if lag else 0.0
        if by_rate:
            target = min(max(wanted, -rate), rate)
            free = target + (before - target) * kept
            state[4] = min(max(free, before - change), before + change)
            way = 0.5 * (before + state[4]) * dt
            if state[4] == free:
                way = target * dt + (before - target) * lag * (1 - kept)
        else:
            error = min(max(wanted, -most), most) - psi
            left = abs(error)
            fast = max(0.0, left / rate - lag)
            way = rate * min(fast, dt) if fast > 0 else 0.0
            if dt > fast:
                way += (left - way) * (1 - math.exp((fast - dt) / lag) if lag else 1.0)
            if math.isfinite(acce):
                count = math.floor(-0.5 + math.sqrt(0.25 + 2 * left / (change * dt)))
                way = min(way, dt * (left / (dt * (count + 1)) + 0.5 * count * change))
            way = dt * min(max(math.copysign(way, error) / dt, before - change), before + change)
            state[4] = way / dt
        state[3] = min(max(psi + way, -most), most)
        if state[3] != psi + way:
            state[4] = 0.0

    def step(state: list[float], control: list[float], dt: float, under: Under) -> None:
        parts = max(1, math.ceil(dt / _SUB_STEP - 1e-9))
        speed, psi = control[0] * (1 - under[0][0]), state[3]
        if ideal or not exact:
            forward, turn = speed * math.cos(psi), speed * math.sin(psi) / wheelbase
            if exact:
                _arc(state, forward, 0.0, turn, dt)
            else:
                state[0] += forward * math.cos(state[2]) * dt
                state[1] += forward * math.sin(state[2]) * dt
                state[2] += turn * dt
        for _ in range(parts):
            psi = state[3]
            turn_wheel(state, control[1], dt / parts)
            if exact and not ideal:
                middle = 0.5 * (psi + state[3])
                _arc(state, speed * math.cos(middle), 0.0, speed * math.sin(middle) / wheelbase, dt / parts)

    return step


def _skid_steer(body: Body, exact: bool) -> Step:
    options = body.options.kinematics or {}
    believed, fastest = _number(options, "believed_track", 1.0), _number(options, "speed_max", math.inf)
    left_at, right_at = _number(options, "icr_left", 0.5), _number(options, "icr_right", -0.5)
    ahead = _number(options, "icr_ahead", 0.0)
    grip = _number(options, "traction_left", 1.0), _number(options, "traction_right", 1.0)

    track = _number(options, "track", 1.0)

    def step(state: list[float], control: list[float], dt: float, under: Under) -> None:
        sides = [control[0] - 0.5 * believed * control[1], control[0] + 0.5 * believed * control[1]]
        scale = max(1.0, *(abs(speed) / fastest for speed in sides))
        slip, _, spread, traction = under
        share = [t if s > 0 else g for g, s, t in zip(grip, spread, traction, strict=True)]
        icr_left = 0.5 * spread[0] * track if spread[0] > 0 else left_at
        icr_right = -0.5 * spread[1] * track if spread[1] > 0 else right_at
        left, right = (share[k] * (1 - slip[k]) * sides[k] / scale for k in range(2))
        rate = (right - left) / (icr_left - icr_right)
        forward = (right * icr_left - left * icr_right) / (icr_left - icr_right)
        if exact:
            return _arc(state, forward, -ahead * rate, rate, dt)
        c, s = math.cos(state[2]), math.sin(state[2])
        state[0] += (forward * c + ahead * rate * s) * dt
        state[1] += (forward * s - ahead * rate * c) * dt
        state[2] += rate * dt
        return None

    return step


def _single_track(body: Body, exact: bool) -> Step:
    return single_track(body.options.kinematics or {}, body.options.wheelbase or 1.0)


def _diff_dynamic(body: Body, exact: bool) -> Step:
    options = body.options.kinematics or {}
    keys = "mass inertia wheel_radius track drag turn_drag resistance torque_constant gear response"
    mass, inertia, radius, track, drag, turn_drag, resistance, constant, gear, response = (
        float(options[key]) for key in keys.split()
    )
    strongest, voltage = _number(options, "torque_max", math.inf), _number(options, "voltage", math.inf)
    friction = _number(options, "friction", math.inf)
    half, scale = track / 2, constant * gear / resistance

    def most(grip: float) -> float:
        """The largest torque of a wheel, which the motor gives and the ground bears."""
        coefficient = grip if math.isinf(friction) and grip != 1 else friction * grip
        return min(strongest, 0.5 * coefficient * mass * _GRAVITY * radius)

    def possible(wanted: float, rate: float, most: float) -> float:
        own = constant * gear * rate
        return min(max(min(max(wanted, scale * (-voltage - own)), scale * (voltage - own)), -most), most)

    def gain(v: float, w: float, control: list[float], bounds: tuple[float, float]) -> tuple[float, float]:
        both = 0.5 * (mass * (control[0] - v) / response + drag * v) * radius
        apart = 0.5 * (inertia * (control[1] - w) / response + turn_drag * w) * radius / half
        left = possible(both - apart, (v - half * w) / radius, bounds[0])
        right = possible(both + apart, (v + half * w) / radius, bounds[1])
        return ((left + right) / radius - drag * v) / mass, ((right - left) * half / radius - turn_drag * w) / inertia

    def over_ground(v: float, w: float, slip: list[float]) -> tuple[float, float]:
        left, right = (v - half * w) * (1 - slip[0]), (v + half * w) * (1 - slip[1])
        return 0.5 * (left + right), 0.5 * (right - left) / half

    def step(state: list[float], control: list[float], dt: float, under: Under) -> None:
        slip, bounds = under[0], (most(under[1][0]), most(under[1][1]))
        motor = constant * gear / radius
        braking = 2 * motor**2 / resistance
        fast = max(1 / response, (braking + drag) / mass, (braking * half**2 + turn_drag) / inertia)
        parts = int(min(max(math.ceil(dt * max(1 / _SUB_STEP, fast) - 1e-9), 1), 10_000))
        h = dt / parts
        left, right = state[3:]
        v, w = 0.5 * radius * (left + right), 0.5 * radius * (right - left) / half
        for _ in range(parts):
            a = gain(v, w, control, bounds)
            b = gain(v + a[0] * h / 2, w + a[1] * h / 2, control, bounds)
            c = gain(v + b[0] * h / 2, w + b[1] * h / 2, control, bounds)
            d = gain(v + c[0] * h, w + c[1] * h, control, bounds)
            v1, w1 = (y + h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]) for i, y in enumerate((v, w)))
            vm, wm = 0.5 * (v + v1) + (a[0] - d[0]) * h / 8, 0.5 * (w + w1) + (a[1] - d[1]) * h / 8
            (v_0, w_0), (v_m, w_m), (v_1, w_1) = (over_ground(*one, slip) for one in ((v, w), (vm, wm), (v1, w1)))
            middle, turn = h / 24 * (5 * w_0 + 8 * w_m - w_1), h / 6 * (w_0 + 4 * w_m + w_1)
            for share, angle in ((v_0, 0.0), (4 * v_m, middle), (v_1, turn)):
                state[0] += h / 6 * share * math.cos(state[2] + angle)
                state[1] += h / 6 * share * math.sin(state[2] + angle)
            state[2] += turn
            v, w = v1, w1
        state[3:] = (v - half * w) / radius, (v + half * w) / radius

    return step


def _number(options: dict[str, Any], key: str, default: float) -> float:
    value = options.get(key)
    return float(value) if isinstance(value, (int, float)) and not math.isnan(value) else default


INNER: dict[str, tuple[int, Callable[[Body, bool], Step]]] = {
    "tricycle": (2, _tricycle),
    "skid_steer": (0, _skid_steer),
    "single_track": (4, _single_track),
    "diff_dynamic": (2, _diff_dynamic),
}
"""Number of inner states and the motion of each drive."""
_SPEEDS = {"single_track": slice(1, 4), "diff_dynamic": slice(0, 2)}
"""Inner states of each drive that are 0 once something has stopped its body."""


def ends_of(artifact: Artifact, body: Body, row: int, stop: Floats, footing: Footing | None) -> Floats:
    """(T - 1, 3) poses that a drive with inner states reaches from each recorded pose; they are as at the start.

    They are NaN from the first step on in which it is not known which ground is under its wheels.

    Args:
        artifact: The run.
        body: The object.
        row: Its row.
        stop: (T - 1,) share of each step that it moved before it was stopped.
        footing: The ground under its wheels; None if it slips nowhere.
    """
    count, make = INNER[str(body.drive)]
    exact = artifact.world.integration == "exact"
    step = make(body, exact)
    inner = [float(value or 0.0) for value in [*body.facts.state[3:], *[0.0] * count][:count]]
    pose, control, still = artifact.pose[:, row], artifact.control[:, row], artifact.stopped[:, row]
    ends = np.full((len(pose) - 1, 3), np.nan)
    known = np.ones(len(ends), dtype=bool) if footing is None else footing.known
    for k in range(len(ends)):
        if still[k] and body.drive in _SPEEDS:
            inner[_SPEEDS[body.drive]] = [0.0] * len(inner[_SPEEDS[body.drive]])
        if math.isnan(pose[k, 0]) or still[k]:
            continue
        if not known[k]:
            break
        state = [*pose[k].tolist(), *inner]
        step(state, control[k + 1].tolist(), artifact.step_time, FIRM if footing is None else footing.at(k))
        inner = state[3:]
        ends[k] = state[:3]
    return _stopped_early(pose[:-1], ends, stop, exact)


def _stopped_early(pose: Floats, ends: Floats, share: Floats, exact: bool) -> Floats:
    """Places after a share of each step, on the arc or the line that leads to its end."""
    way, turn = ends[:, :2] - pose[:, :2], ends[:, 2] - pose[:, 2]
    half = 0.5 * turn
    if not exact:
        return np.column_stack([pose[:, :2] + way * share[:, None], pose[:, 2] + turn * share])
    scale = share * np.sinc(half * share / np.pi) / np.sinc(half / np.pi)
    back = -half * (1 - share)
    c, s = np.cos(back) * scale, np.sin(back) * scale
    moved = np.column_stack([way[:, 0] * c - way[:, 1] * s, way[:, 0] * s + way[:, 1] * c])
    return np.column_stack([pose[:, :2] + moved, wrap(pose[:, 2] + turn * share)])
