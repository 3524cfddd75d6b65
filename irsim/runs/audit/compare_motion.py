"""Checks that each object moved as its drive moves under the recorded controls, and that these kept its limits."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.runs.audit.artifact import Artifact, Body
from irsim.runs.audit.drives import INNER, ends_of
from irsim.runs.audit.ground import Footing, footing_of, track_of
from irsim.runs.audit.report import Report
from irsim.runs.audit.strides import Strides

__all__ = ["compare_limits", "compare_motion"]

_SHARE = 3e-7
"""Rounding of the recorded controls, which have single precision, as a share of them."""
_INNER_SHARE = 3e-6
"""The same where controls act through inner states, in which their rounding gathers."""
_ROUNDING = 1e-8
"""Rounding of poses: [m] and [rad]."""
_YAW = {"diff": 1, "omni_angular": 2}
_DRIVES = ("diff", "omni", "omni_angular", "acker", *INNER)


def _is_known(artifact: Artifact, body: Body) -> str | None:
    """Why the motion of a body is not checked; None if it is."""
    if body.drive not in _DRIVES:
        return "has no drive of irsim"
    if (body.options.kinematics or {}).get("noise"):
        return "has noise in its drive"
    if artifact.world.collision_mode == "contact":
        return "can be pushed"
    return "is moved by another program" if artifact.meta.options.get("bridges") else None


def compare_motion(artifact: Artifact, strides: Strides, report: Report) -> None:
    """Compare each pose with the one that the drive reaches from the pose before under the recorded control.

    Objects that are static or stopped must not move at all. Where wheels slip, the slip is recomputed, too, with the
    numbers that the seed gives. Objects without a drive of irsim, with noise, or that can be pushed are left out, and
    so are steps that a wheel begins on the very edge of such ground.
    """
    report.begin("motion")
    left_out = dict[str, int]()
    unknown = 0
    for row, body in enumerate(artifact.bodies):
        pose = artifact.pose[:, row]
        there = ~np.isnan(pose[:-1, 0]) & ~np.isnan(pose[1:, 0])
        still = np.full(len(there), True) if body.options.static else artifact.stopped[:-1, row]
        moved = (np.abs(pose[1:, :2] - pose[:-1, :2]).max(axis=1) > _ROUNDING) & there & still
        if artifact.world.collision_mode != "contact":
            report.compared(int((there & still).sum()))
            _tell(report, artifact, body, moved, pose[1:], pose[:-1], "moved although it stands still", _ROUNDING)
        if body.options.static:
            continue
        if (why := _is_known(artifact, body)) is not None:
            left_out[why] = left_out.get(why, 0) + 1
            continue
        footing = footing_of(artifact, body, row)
        wanted, tolerance = _driven(artifact, body, row, strides, footing)
        wanted[still] = pose[:-1][still]
        known = ~np.isnan(wanted[:, 0])
        unknown += int((there & ~known).sum())
        there &= known
        away = np.hypot(*(pose[1:, :2] - wanted[:, :2]).T)
        turned = np.abs(wrap(pose[1:, 2] - wanted[:, 2]))
        wrong = there & ((away > tolerance) | (turned > tolerance))
        report.compared(int(there.sum()))
        what = "is not where its drive and its control take it"
        _tell(report, artifact, body, wrong & ~moved, pose[1:], wanted, what, float(tolerance.max(initial=_ROUNDING)))
    notes = [f"{count} left out: {why}" for why, count in left_out.items()]
    if unknown:
        notes.append(f"{unknown} steps left out: a wheel is, or was, on the edge of ground on which it slips")
    report.end("; ".join(notes))


def _tell(
    report: Report,
    artifact: Artifact,
    body: Body,
    wrong: NDArray[np.bool_],
    recorded: Floats,
    recomputed: Floats,
    what: str,
    tolerance: float,
) -> None:
    for place in np.flatnonzero(wrong).tolist():
        step = artifact.first + place + 1
        report.differ(
            "audit-motion",
            f"'{body.name}' {what} in step {step}",
            object=body.name,
            step=step,
            recorded=recorded[place].tolist(),
            recomputed=recomputed[place].tolist(),
            tolerance=tolerance,
        )


def _driven(
    artifact: Artifact, body: Body, row: int, strides: Strides, footing: Footing | None
) -> tuple[Floats, Floats]:
    """(T - 1, 3) poses that the drive reaches from each pose, and (T - 1,) how far they may be off."""
    control, pose = artifact.control[1:, row], artifact.pose[:-1, row]
    if body.drive in INNER:
        wanted = ends_of(artifact, body, row, strides.stop[:, row], footing)
        size = np.abs(control).sum(axis=1) * (1 + artifact.step_time)
        slack = _ROUNDING * (1.0 + 1e-2 * np.abs(np.nan_to_num(pose[:, :2])).max(axis=1))
        return wanted, slack + _INNER_SHARE * size * artifact.step_time
    time = artifact.step_time * strides.stop[:, row]
    forward, lateral, rate = control[:, 0], np.zeros(len(control)), np.zeros(len(control))
    slope = np.ones(len(control))
    if body.drive in ("omni", "omni_angular"):
        lateral = control[:, 1]
    if body.drive == "acker":
        steering = steering_angles(artifact, body, row)[:-1]
        slope = 1.0 + np.tan(steering) ** 2
        rate = forward * np.tan(steering) / (body.options.wheelbase or 1.0)
    elif body.drive in _YAW:
        rate = control[:, _YAW[str(body.drive)]]
    size = np.abs(forward) + np.abs(lateral) + np.abs(rate) + np.abs(forward) * slope
    size = size + (np.abs(forward) + np.abs(lateral)) * np.abs(rate * time)
    if footing is not None:
        kept = 1 - footing.slip[:, 0]
        if body.drive == "diff":
            track = track_of(body)
            size = size + np.abs(forward) / track + np.abs(rate) * track
            forward, rate = footing.over_ground(forward, rate, track)
        else:
            forward, lateral, rate = forward * kept, lateral * kept, rate * kept
    heading, turn = pose[:, 2], rate * time
    if artifact.world.integration == "exact":
        half = 0.5 * turn
        scale = np.sinc(half / np.pi) * time
        heading = heading + half
    else:
        scale = time
    cosine, sine = np.cos(heading), np.sin(heading)
    wanted = np.stack(
        [
            pose[:, 0] + (forward * cosine - lateral * sine) * scale,
            pose[:, 1] + (forward * sine + lateral * cosine) * scale,
            pose[:, 2] + turn,
        ],
        axis=1,
    )
    tolerance = _ROUNDING * (1.0 + 1e-2 * np.abs(np.nan_to_num(pose[:, :2])).max(axis=1)) + _SHARE * size * time
    return wanted, tolerance


def steering_angles(artifact: Artifact, body: Body, row: int) -> Floats:
    """(T,) steering angle of a car after each step [rad]."""
    state, options = body.facts.state, body.options.kinematics or {}
    first = float(state[3] or 0.0) if len(state) > 3 else 0.0
    most = options.get("psi_max")
    most = float(most) if isinstance(most, (int, float)) and not math.isnan(most) else math.inf
    turns = artifact.control[1:, row, 1]
    if options.get("mode") != "angular":
        angles = np.concatenate([[first], turns])
    else:
        angles = np.empty(len(turns) + 1)
        angles[0] = first
        for step, rate in enumerate(turns.tolist()):
            angles[step + 1] = min(max(angles[step] + rate * artifact.step_time, -most), most)
        return angles
    moved = ~(artifact.stopped[:-1, row] | np.isnan(artifact.pose[:-1, row, 0]))
    last = np.concatenate([[0], np.where(moved, np.arange(1, len(angles)), 0)])
    steered: Floats = np.clip(angles[np.maximum.accumulate(last)], -most, most)
    return steered


def compare_limits(artifact: Artifact, report: Report) -> None:
    """Compare the controls with the limits of speed and acceleration that each object had in this run."""
    report.begin("limits")
    if artifact.world.collision_mode == "contact":
        report.end("contacts change the controls of bodies that push each other")
        return
    unknown, noisy = 0, 0
    for row, body in enumerate(artifact.bodies):
        if body.drive is None or body.options.static:
            continue
        if body.drive not in _DRIVES:
            unknown += 1
            continue
        actuation = body.options.actuation
        if actuation is not None and any(actuation.of("noise")):
            noisy += 1
            continue
        control = artifact.control[:, row]
        low, high, acce = (np.array(getattr(body.drawn, key)) for key in ("vel_min", "vel_max", "acce"))
        slack = _ROUNDING + _SHARE * np.abs(control).max(initial=0.0)
        count = min(body.options.vel_dim, 3)
        with np.errstate(invalid="ignore"):
            change = np.abs(np.diff(control, axis=0))
            most = acce * artifact.step_time * (1 + _SHARE) + slack
            if actuation is not None:  # a control that overcomes static friction begins with this
                most = most + np.array(actuation.of("dead_band"))
        fast = ((control < low - slack) | (control > high + slack))[1:, :count]
        sudden = (change > most)[:, :count] & ~artifact.stopped[:-1, row, None]
        report.compared(2 * fast.size)
        for wrong, what, bounds in ((fast, "speed", None), (sudden, "acceleration", acce)):
            for place, column in np.argwhere(wrong).tolist():
                value = float(control[place + 1, column])
                limit = float(np.clip(value, low[column], high[column]))
                if bounds is not None:
                    value, limit = float(change[place, column] / artifact.step_time), float(bounds[column])
                step = artifact.first + place + 1
                report.differ(
                    "audit-limit",
                    f"control {column} of '{body.name}' exceeds its limit of {what} in step {step}",
                    object=body.name,
                    step=step,
                    recorded=value,
                    recomputed=limit,
                    tolerance=float(slack),
                )
    left_out = {"has a drive of its own": unknown, "has noise in its actuation": noisy}
    report.end("; ".join(f"{count} left out: {why}" for why, count in left_out.items() if count))
