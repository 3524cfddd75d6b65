"""Rows of a recording as tracks: one person in metres and seconds, within a window of time and space."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.rows import Recording
from irsim.common.arrays import Floats

__all__ = ["PERIOD", "VSP_RATE", "Track", "Window", "frame_rate", "make_tracks", "pixels_to_metres"]

PERIOD = 0.4
"""Time between two annotated pictures of ETH and TrajNet, if no frame rate is given [s]."""
VSP_RATE = 25.0
"""Frames per second of UCY's videos."""
_MAX_DURATION = 1e6
"""Longest recording [s]."""


@dataclass(frozen=True)
class Window:
    """The part of a recording that is kept.

    Attributes:
        start: Time from which on, since its first frame [s].
        end: Time until which, since its first frame [s].
        box: x0, y0, x1, y1 of the area [m]; None keeps all.
    """

    start: float = 0.0
    end: float = float("inf")
    box: tuple[float, float, float, float] | None = None


@dataclass(frozen=True)
class Track:
    """A part of a person's recording without interruption.

    Attributes:
        name: ``ped_<id>``; another track of the same person has ``_2``, ``_3``, ... behind it.
        times: (K,) increasing, from the start of the window [s]; K >= 2.
        places: (K, 2) x, y [m].
    """

    name: str
    times: Floats
    places: Floats


def frame_rate(recording: Recording) -> float:
    """Frames per second, from what data sets agree on: see :data:`PERIOD` and :data:`VSP_RATE`."""
    if recording.format == "vsp":
        return VSP_RATE
    frames = np.unique(recording.frame)
    if len(frames) < 2:
        return 1.0 / PERIOD
    steps, counts = np.unique(np.diff(frames), return_counts=True)
    return float(steps[counts.argmax()]) / PERIOD


def pixels_to_metres(
    places: Floats, homography: Floats | None, scale: float | None, size: tuple[float, float] | None
) -> Floats:
    """Places on the ground of places in a picture.

    Args:
        places: (N, 2) pixels from the middle of the picture, y upwards.
        homography: (3, 3) from pixels to metres; None to scale.
        scale: Metres of a pixel; None with a homography.
        size: Width and height of the picture [pixels], if the homography counts pixels from its upper left corner, y
            downwards.

    Raises:
        BridgeError: A place has no image on the ground.
    """
    if homography is None:
        assert scale is not None
        return places * scale
    if size is not None:
        places = np.stack([places[:, 0] + size[0] / 2, size[1] / 2 - places[:, 1]], axis=1)
    result = np.concatenate([places, np.ones((len(places), 1))], axis=1) @ homography.T
    with np.errstate(divide="ignore", invalid="ignore"):
        ground: Floats = result[:, :2] / result[:, 2:]
    if not np.isfinite(ground).all() or np.abs(ground).max(initial=0.0) > 1e6:
        what = "the homography maps a place to infinity"
        raise BridgeError("bridge-file", what, "is it one of this video, or its inverse?")
    return ground


def make_tracks(recording: Recording, places: Floats, rate: float, window: Window) -> tuple[list[Track], int]:
    """The tracks of a recording, in the order of the ids.

    Args:
        recording: The rows.
        places: (N, 2) x, y [m] of the rows.
        rate: Frames per second.
        window: Part of the recording that is kept.

    Returns:
        The tracks, and how many persons were left out because a single row of them is in the window.

    Raises:
        BridgeError: A pedestrian is at two places in one frame, or the recording is longer than 11 days.
    """
    if not len(recording.frame):
        return [], 0
    times = (recording.frame - recording.frame.min()) / rate
    if times.max() > _MAX_DURATION:
        what = f"the recording lasts {times.max():g} s"
        raise BridgeError("bridge-file", what, "a number of a frame is wrong, or the frame rate is")
    order = np.lexsort((times, recording.person))
    times, person, places = times[order], recording.person[order], places[order]
    same = (np.diff(person) == 0) & (np.diff(times) == 0)
    if same.any():
        at = int(np.flatnonzero(same)[0])
        if not np.array_equal(places[:-1][same], places[1:][same]):
            what = f"person {person[at]:.0f} is at two places in frame {recording.frame[order][at]:g}"
            raise BridgeError("bridge-file", what, "remove one of the two lines")
        kept = np.concatenate([[True], ~same])
        times, person, places = times[kept], person[kept], places[kept]
    inside = (times >= window.start - 1e-9) & (times <= window.end + 1e-9)
    if window.box is not None:
        x0, y0, x1, y1 = window.box
        inside &= (places[:, 0] >= x0) & (places[:, 0] <= x1) & (places[:, 1] >= y0) & (places[:, 1] <= y1)
    tracks: list[Track] = []
    left_out = 0
    for who in np.unique(person).tolist():
        rows = np.flatnonzero(person == who) if len(person) < 2 else _range(person, who)
        number = 0
        for run in _runs(inside[rows]):
            part = rows[run]
            if len(part) < 2:
                left_out += 1
                continue
            number += 1
            name = f"ped_{who:.0f}" if number == 1 else f"ped_{who:.0f}_{number}"
            tracks.append(Track(name.replace("-", "m"), times[part] - window.start, places[part]))
    return tracks, left_out


def _range(person: Floats, who: float) -> NDArray[np.int64]:
    return np.arange(np.searchsorted(person, who), np.searchsorted(person, who, side="right"))


def _runs(inside: NDArray[np.bool_]) -> Iterator[slice]:
    """Slices of consecutive rows that are inside."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(np.int8)))
    for begin, end in edges.reshape(-1, 2).tolist():
        yield slice(begin, end)
