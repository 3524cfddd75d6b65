"""Recomputes where robots that decide from an estimate go on to their next goal, and where they rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.runs.audit.artifact import Artifact, Body
from irsim.runs.audit.report import Report

__all__ = ["compare_beliefs", "distances_to", "on_last_goal"]

_STANDING = 1e-3
"""Slower objects stand [m/s]."""
_ROUNDING = 1e-9
_OWN_SHARE = 0.5
"""Share of its threshold within which a robot that moves believes to be at its goal."""


def distances_to(body: Body, pose: Floats, goal: Floats) -> Floats:
    """(T,) distances of poses (T, 3) from goals (T, 3) of a body, with the heading where it counts; NaN without one."""
    turn = np.zeros(len(pose))
    if body.options.arrive_mode == "state":
        turn = np.nan_to_num(wrap(pose[:, 2] - goal[:, 2]))
    distances: Floats = np.sqrt(((pose[:, :2] - goal[:, :2]) ** 2).sum(axis=1) + turn**2)
    return distances


def _events(artifact: Artifact, body: Body, kind: str) -> NDArray[np.bool_]:
    """(T,) whether a body has an event of a kind in each step."""
    steps = [event.step for event in artifact.events if event.kind == kind and event.object == body.name]
    return np.isin(np.arange(artifact.first, artifact.last + 1), steps)


def on_last_goal(artifact: Artifact, body: Body) -> NDArray[np.bool_]:
    """(T,) whether a body that goes by an estimate is judged by its last goal; never without goals."""
    if body.endless:
        return np.zeros(len(artifact.pose), dtype=bool)
    passed = np.cumsum(_events(artifact, body, "waypoint"))
    before = np.concatenate([[0], passed[:-1]])
    last: NDArray[np.bool_] = before >= len(body.facts.goals) - 1
    return last


def compare_beliefs(artifact: Artifact, report: Report) -> str:
    """Compare events and flags of belief with the distances of the reported poses to the recorded goals.

    Returns:
        The part that is not checked, in words.
    """
    left_out, believers = dict[str, int](), 0
    for row, body in enumerate(artifact.bodies):
        if body.replays or body.options.perceives == "truth":
            continue
        believers += 1
        why = ""
        if body.estimates and body.endless:
            why = "decides from an estimate and goes on to further goals for ever"
        elif body.estimates and row not in artifact.estimate:
            why = "decides from an estimate that is not in the record"
        if why:
            left_out[why] = left_out.get(why, 0) + 1
        elif body.estimates and len(artifact.pose) > 1:
            _compare(artifact, body, row, report)
    notes = [f"{count} left out: {why}" for why, count in left_out.items()]
    if believers > sum(left_out.values()):
        notes.append("estimates and tracks are taken as their sensors reported them")
    return "; ".join(notes)


def _compare(artifact: Artifact, body: Body, row: int, report: Report) -> None:
    """An object judges in each step by the estimate and the goal of the end of the step before."""
    pose, goal = artifact.pose[:, row], artifact.goal[:, row]
    estimate = artifact.estimate[row]
    estimate = np.where(np.isfinite(estimate[:-1, :1]), estimate[:-1], pose[1:])
    there = ~np.isnan(pose[1:, 0]) & ~np.isnan(goal[:-1, 0])
    distance, threshold = distances_to(body, estimate, goal[:-1]), body.options.goal_threshold
    speed = np.nan_to_num(np.hypot(*(pose[1:, :2] - pose[:-1, :2]).T)) / artifact.step_time
    # An arc is longer than its chord, so a speed near the limit leaves open whether the object stands.
    least = np.where(speed < 0.5 * _STANDING, threshold, _OWN_SHARE * threshold)
    most = np.where(speed < 2 * _STANDING, threshold, _OWN_SHARE * threshold)
    surely, maybe = distance < least - _ROUNDING, distance < most + _ROUNDING
    last, passes = on_last_goal(artifact, body)[1:], _events(artifact, body, "waypoint")[1:]
    flags = artifact.believes[1:, row]
    stays = artifact.believes[:-1, row] & artifact.settles(body)
    begins = flags & ~artifact.believes[:-1, row]
    tells = _events(artifact, body, "believed_arrival")[1:]
    for wrong, what in (
        (there & ~last & passes & ~maybe, "passes a waypoint where it does not believe to be"),
        (there & ~last & ~passes & surely, "does not pass the waypoint where it believes to be"),
        (there & last & passes, "passes a waypoint after its last one"),
        (there & last & flags & ~stays & ~maybe, "does not believe to be at its goal"),
        (there & last & ~flags & surely, "believes to be at its goal"),
        (there & ~last & flags, "still has waypoints before its goal"),
        (there & (begins != tells), "has other events of believed arrivals than flags"),
    ):
        for place in np.flatnonzero(wrong).tolist():
            step = artifact.first + place + 1
            report.differ(
                "audit-arrival",
                f"'{body.name}' {what}, in step {step}: its estimate is {distance[place]:.9g} m from its goal",
                object=body.name,
                step=step,
                recorded=float(distance[place]),
                recomputed=float(least[place]),
                tolerance=_ROUNDING,
            )
    report.compared(2 * int(there.sum()))
