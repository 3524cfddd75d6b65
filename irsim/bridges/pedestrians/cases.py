"""People of a recording whose next seconds are to be foretold: 8 rows are seen, 12 follow, 0.4 s apart.

The cut is the one with which predictors of pedestrians are compared: every person with 20 rows without interruption,
from each of its rows on, if at least one other such person is there (the loader of Gupta et al.: "Social GAN", 2018).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.tracks import PERIOD, frame_rate, read_recording
from irsim.common.arrays import Floats

__all__ = ["FORETOLD", "SEEN", "Cases", "cases_of", "read_cases"]

SEEN = 8
"""Rows that are known of a person."""
FORETOLD = 12
"""Rows that follow them."""
_NEAR = 1e-6
"""Largest error of the time between two rows [s]."""
_PART = 50_000
"""Number of people, those around included, that are looked at together."""

Whole = NDArray[np.int64]


@dataclass(frozen=True)
class Cases:
    """W people, each at another time, and those around them.

    Attributes:
        name: Name of the recording.
        seen: (W, 8, 2) x, y [m] of the person in the rows that are known.
        truth: (W, 12, 2) x, y in the rows that follow.
        goal: (W, 2) where its recording ends.
        scenes: (13, P, 2) x, y of all people from a last known row on, NaN while one is not there; one for each time.
        scene: (W,) index of the scene of a case.
        column: (W,) which of the people of the scene it is about.
    """

    name: str
    seen: Floats
    truth: Floats
    goal: Floats
    scenes: list[Floats]
    scene: Whole
    column: Whole

    def __len__(self) -> int:
        return len(self.seen)

    @property
    def start(self) -> Floats:
        """(W, 2) the last known place."""
        return self.seen[:, -1]

    @property
    def velocity(self) -> Floats:
        """(W, 2) the last known velocity [m/s]."""
        result: Floats = (self.seen[:, -1] - self.seen[:, -2]) / PERIOD
        return result

    @property
    def mean_velocity(self) -> Floats:
        """(W, 2) velocity from the first known place to the last [m/s]."""
        result: Floats = (self.seen[:, -1] - self.seen[:, 0]) / (PERIOD * (SEEN - 1))
        return result

    @property
    def mean_speed(self) -> Floats:
        """(W,) mean of the speeds between known places [m/s]."""
        result: Floats = np.linalg.norm(np.diff(self.seen, axis=1), axis=2).mean(axis=1) / PERIOD
        return result

    def parts(self) -> Iterator[tuple[slice, Floats]]:
        """Cases that are looked at together, with (w, M, 13, 2) places of the others; NaN while one is not there."""
        most = max((scene.shape[1] for scene in self.scenes), default=1)
        size = max(1, _PART // most)
        for first in range(0, len(self), size):
            part = slice(first, min(first + size, len(self)))
            around = [
                np.delete(self.scenes[scene], column, axis=1).transpose(1, 0, 2)
                for scene, column in zip(self.scene[part].tolist(), self.column[part].tolist(), strict=True)
            ]
            others = np.full((len(around), max(map(len, around)), FORETOLD + 1, 2), np.nan)
            for case, one in enumerate(around):
                others[case, : len(one)] = one
            yield part, others


def read_cases(path: Path) -> Cases:
    """The people of a file of rows in metres, such as ETH's ``obsmat.txt``.

    Raises:
        BridgeError: The file cannot be used, or no person in it can be foretold.
    """
    recording = read_recording(path)
    if recording.format == "vsp":
        what = f"{path.name} has splines in pixels instead of rows of places in metres"
        raise BridgeError("bridge-file", what, "give ETH's obsmat.txt, or lines 'frame id x y'")
    times = recording.frame / frame_rate(recording)
    cases = cases_of(path.stem, times, recording.person, recording.place)
    if not len(cases):
        what = f"no two people in {path.name} have {SEEN + FORETOLD} rows, {PERIOD:g} s apart, at the same times"
        raise BridgeError("bridge-file", what, "give a longer recording")
    return cases


def cases_of(name: str, times: Floats, person: Floats, places: Floats) -> Cases:
    """The people of rows.

    Args:
        name: Name of the recording.
        times: (N,) when a row was recorded [s].
        person: (N,) who it is about.
        places: (N, 2) x, y [m].
    """
    order = np.lexsort((times, person))
    times, person, places = times[order], person[order], places[order]
    clock, when = np.unique(times, return_inverse=True)
    rows, total = np.arange(len(times)), SEEN + FORETOLD
    breaks = np.ones(len(times), dtype=bool)
    breaks[:-1] = (np.diff(person) != 0) | (np.abs(np.diff(times) - PERIOD) > _NEAR)
    end = rows[breaks][np.searchsorted(rows[breaks], rows)] if len(rows) else rows
    first = rows[end - rows >= total - 1]
    first = first[when[first + total - 1] - when[first] == total - 1]  # no row between these of another person
    _, scene, together = np.unique(when[first], return_inverse=True, return_counts=True)
    first = first[together[scene] > 1]
    starts, scene = np.unique(when[first], return_inverse=True)
    frames = np.argsort(when, kind="stable")
    begin = np.searchsorted(when[frames], np.arange(len(clock) + 1))
    scenes: list[Floats] = []
    column = np.zeros(len(first), dtype=np.int64)
    for number, start in enumerate(starts.tolist()):
        some = frames[begin[start + SEEN - 1] : begin[start + total]]
        who, at = np.unique(person[some], return_inverse=True)
        block = np.full((FORETOLD + 1, len(who), 2), np.nan)
        block[when[some] - (start + SEEN - 1), at] = places[some]
        scenes.append(block)
        own = scene == number
        column[own] = np.searchsorted(who, person[first[own]])
    tracks = places[first[:, None] + np.arange(total)]
    return Cases(name, tracks[:, :SEEN], tracks[:, SEEN:], places[end[first]], scenes, scene, column)
