"""``goal``: where the goal is."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, Field

from irsim.options.units import Bool, Meters
from irsim.policies.networks.features import PARTS
from irsim.policies.networks.frames import Frame, direction, goal_offset, length, turn_back, x_axis
from irsim.policies.networks.parts._options import PartOptions, clip_to, select, unique
from irsim.policies.networks.values import Channel, Value, apply
from irsim.policies.observations import Observations

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


@PARTS.register(Goal)
def goal(observations: Observations, options: Goal) -> Value:
    """Observe the goal.

    Args:
        observations: Of B robots.
        options: The options of the part.

    Returns:
        (B, F) features.
    """
    axis = x_axis(options.frame, observations)
    offset, there = goal_offset(observations)
    distance = length(offset)
    position = turn_back(offset, axis)
    far = (distance > 0)[:, None]
    bearing = np.where(far, position / np.where(far, distance[:, None], 1.0), [1.0, 0.0]) * there[:, None]
    heading = observations.goal[:, 2]
    wanted = np.isfinite(heading)
    facing = turn_back(direction(np.where(wanted, heading, 0.0)), axis) * (there * wanted)[:, None]
    scaled = clip_to(position, options.distance_max, options.clip)
    columns = {
        "distance": clip_to(distance, options.distance_max, options.clip),
        "nearness": apply("exp", -distance / options.decay) * there,
        "cos": np.clip(bearing[:, 0], -1.0, 1.0),
        "sin": np.clip(bearing[:, 1], -1.0, 1.0),
        "x": scaled[:, 0],
        "y": scaled[:, 1],
        "heading_cos": np.clip(facing[:, 0], -1.0, 1.0),
        "heading_sin": np.clip(facing[:, 1], -1.0, 1.0),
        "threshold": clip_to(observations.goal_threshold, options.distance_max, options.clip) * there,
        "present": there,
    }
    return Value(select(columns, options.features))
