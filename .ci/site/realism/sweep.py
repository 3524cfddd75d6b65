"""A scan that takes time against its beams cast one by one from where the lidar was."""

from __future__ import annotations

import math

import numpy as np
import yaml

from irsim.common.arrays import Floats
from realism.simulated import driven, opened
from realism.validation import Curve, Validation

__all__ = ["validation"]

SPEED, TURN = 2.0, 2.0
"""Speed [m/s] and yaw rate [rad/s] during the scan."""


def _poses(start: Floats, time: Floats) -> Floats:
    """(K, 3) poses on the arc after some times [s]."""
    heading = start[2] + TURN * time
    radius = SPEED / TURN
    x = start[0] + radius * (np.sin(heading) - math.sin(start[2]))
    y = start[1] - radius * (np.cos(heading) - math.cos(start[2]))
    return np.column_stack([x, y, heading])


def _cast(poses: Floats, angles: Floats, room: Floats) -> Floats:
    """(K,) ranges of one beam from each pose inside a room with the corners (x0, y0), (x1, y1) [m]."""
    towards = np.column_stack([np.cos(poses[:, 2] + angles), np.sin(poses[:, 2] + angles)])
    walls = np.where(towards > 0, room[1], room[0])
    ranges: Floats = np.min((walls - poses[:, :2]) / towards, axis=1)
    return ranges


def _seen(pose: Floats, angles: Floats, ranges: Floats) -> Floats:
    """(K, 2) places of hits for one who takes all beams to start at one pose."""
    return pose[:2] + ranges[:, None] * np.column_stack([np.cos(pose[2] + angles), np.sin(pose[2] + angles)])


def validation(text: str) -> Validation:
    """One step in a room, while the robot drives and turns."""
    scene = yaml.safe_load(text)
    [sensor], [wall] = scene["robot"]["sensors"], scene["obstacle"]
    corners, count, dt = np.array(wall["shape"]["vertices"], float), sensor["number"], scene["world"]["step_time"]
    room = np.array([corners.min(axis=0), corners.max(axis=0)])
    batch = opened(text)
    start = batch.pose[0, 0].copy()
    for _ in driven(batch, [SPEED, TURN], 1):
        end, ranges = batch.pose[0, 0].copy(), batch.ranges[0].copy()
    angles = 2 * math.pi * np.arange(count) / count - math.pi
    alone = _cast(_poses(start, dt - (count - 1 - np.arange(count)) * dt / count), angles, room)
    at_once = _cast(np.tile(end, (count, 1)), angles, room)
    line, plain, points = (_seen(end, angles, one) for one in (alone, at_once, ranges))
    return Validation(
        x="x [m]",
        y="y [m]",
        points=(Curve("simulated scan", points[::4, 0], points[::4, 1]),),
        lines=(
            Curve("beams cast one by one", line[:, 0], line[:, 1]),
            Curve("a scan that takes no time", plain[:, 0], plain[:, 1], 3, faint=True),
        ),
        quantity="Largest difference from a beam that is cast alone",
        measured=1000 * float(np.abs(ranges - alone).max()),
        expected=0.0,
        tolerance=1.0,
        unit="mm",
        setup=(
            f"A scan of {1000 * sensor['scan_time']:g} ms at {SPEED:g} m/s and {TURN:g} rad/s, drawn as if all its "
            f"beams started at its end: the room is bent by up to {np.abs(alone - at_once).max():.2f} m."
        ),
        paths=True,
    )
