"""``replay``: be where a recording says, at its times."""

from __future__ import annotations

import itertools
import math
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

import irsim._core as core
from irsim.components.options import BehaviorOptions
from irsim.options.base import problem
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Bool
from irsim.options.vectors import Component, Pose

__all__ = ["Replay"]

_MARGIN = 1 + 1e-6
"""Factor on the highest recorded speed, so that rounding does not make a limit cut it."""
_SHORTEST = 1e-9
"""Least time between two poses [s]."""
_SLOWEST = 0.01
"""Least limit, for an object that stands [m/s]."""


class Replay(BehaviorOptions):
    """Be at recorded places at recorded times: people of a data set, a robot from a bag.

    `omni` and `omni_angular` are exactly there, other drives follow as they can. An obstacle is in the world from its
    first to its last time. It waits for no room; collisions neither stop nor push it. `state`, `goal` and limits of
    speed follow from the recording, at whose end it arrives. `irsim bridge import-pedestrians` writes some.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "replay", "times": [0, 0.4, 0.8], "poses": [[1, 2], [1.5, 2], [2, 2.1]]}]
    }
    also_called: ClassVar[dict[str, str]] = {
        "t": "times",
        "stamps": "times",
        "positions": "poses",
        "points": "poses",
        "trajectory": "poses",
    }

    needs_goal: ClassVar[bool] = False
    follows_paths: ClassVar[bool] = False

    name: Literal["replay"] = "replay"
    times: Annotated[
        list[Annotated[Component, Field(ge=0)]], Field(max_length=1_000_000, json_schema_extra={"x-unit": "s"})
    ] = []
    """Recorded times, increasing."""
    poses: Annotated[list[Pose], Field(max_length=1_000_000)] = []
    """Places [x, y] or [x, y, heading]; without headings it looks where it goes."""
    interpolation: Literal["linear", "cubic"] = "linear"
    """Between two times: straight at constant speed, or along a curve without jumps of speed."""
    vanish: Bool = True
    """False, and robots always: it stands at its first pose before and at its last after."""

    @model_validator(mode="after")
    def _check_times(self) -> Replay:
        if len(self.times) != len(self.poses):
            what = f"{len(self.times)} times and {len(self.poses)} poses do not belong together"
            raise problem("wrong-length", what, fix="give one pose for each time")
        for number, (before, after) in enumerate(itertools.pairwise(self.times), 1):
            if not after - before >= _SHORTEST:
                what = f"times must increase, but times[{number}] = {after:g} follows {before:g}"
                raise problem("invalid-value", what, fix="sort the rows by time, and leave out repeated times")
        return self

    @property
    def start(self) -> list[float]:
        """First pose; without a recorded heading it looks where it goes first."""
        first = self.poses[0]
        if len(first) > 2:
            return list(first)
        moved = next((pose for pose in self.poses if pose[:2] != first[:2]), first)
        return [*first, math.atan2(moved[1] - first[1], moved[0] - first[0])]

    @cached_property
    def top_speed(self) -> float:
        """Speed that it never exceeds [m/s], positive."""
        if len(self.times) < 2:
            return _SLOWEST
        times, places = np.array(self.times), np.array([pose[:2] for pose in self.poses])
        legs = np.diff(places, axis=0) / np.diff(times)[:, None]
        fastest = np.hypot(*legs.T).max()
        if self.interpolation == "cubic":  # on a leg, the velocity is a quadratic curve between these three
            ahead = (places[2:] - places[:-2]) / (times[2:] - times[:-2])[:, None]
            slopes = np.concatenate([legs[:1], ahead, legs[-1:]])
            middle = 3 * legs - slopes[:-1] - slopes[1:]
            fastest = max(fastest, *(np.hypot(*part.T).max() for part in (slopes, middle)))
        return max(_SLOWEST, float(fastest) * _MARGIN)

    def top_speed_of_its_own(self) -> float:
        """Limit of speed among its own keys [m/s]."""
        return self.top_speed if self.times else 0.0

    def limits(self, step_time: float) -> list[float]:
        """Upper limits of the controls that it needs: two speeds [m/s] and a turn rate [rad/s]."""
        return [self.top_speed, self.top_speed, _MARGIN * math.pi / step_time]


BEHAVIORS.register(Replay, kernel=core.ReplayOptions)
