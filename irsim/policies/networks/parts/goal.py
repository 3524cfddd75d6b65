"""``goal``: where the goal is."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field

import irsim._core as core
from irsim.options.units import Bool, Meters
from irsim.policies.networks.frames import Frame
from irsim.policies.networks.parts._options import PARTS, PartOptions, unique
from irsim.policies.networks.values import Channel

Feature = Literal["distance", "nearness", "cos", "sin", "x", "y", "heading_cos", "heading_sin", "threshold", "present"]


class Goal(PartOptions):
    """Where the goal is, as seen from the robot. Without a goal all numbers are 0.

    - `distance`: distance / `distance_max`
    - `nearness`: exp(-distance / `decay`)
    - `cos`, `sin`: direction of the goal; (1, 0) at the goal itself
    - `x`, `y`: position / `distance_max`
    - `heading_cos`, `heading_sin`: direction of the heading that the goal asks for; 0 if it leaves the heading free
    - `threshold`: distance below which the robot has arrived / `distance_max`
    - `present`: 1 with a goal
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "goal", "features": ["nearness", "cos", "sin"]}]}

    name: Literal["goal"] = "goal"
    features: Annotated[list[Feature], Field(min_length=1), AfterValidator(unique)] = ["distance", "cos", "sin"]
    """The numbers, in this order."""
    frame: Frame = "own"
    """Frame of directions and positions."""
    distance_max: Annotated[Meters, Field(gt=0)] = 4.0
    """Distance that becomes 1."""
    decay: Annotated[Meters, Field(gt=0)] = 1.0
    """Distance at which `nearness` is 1/e."""
    clip: Bool = True
    """Whether distances and positions are clipped to `distance_max`."""

    def channels(self) -> tuple[Channel, ...]:
        """One for each feature."""
        most = 1.0 if self.clip else math.inf
        scaled = {"distance": (0.0, most), "x": (-most, most), "y": (-most, most), "threshold": (0.0, most)}
        shares = {"nearness": (0.0, 1.0), "present": (0.0, 1.0)}
        return tuple(Channel(name, *(scaled | shares).get(name, (-1.0, 1.0))) for name in self.features)


PARTS.register(Goal, kernel=core.GoalOptions)
