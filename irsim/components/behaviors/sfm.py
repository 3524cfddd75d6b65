"""``sfm``: social forces."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.behaviors._people import FittedOptions
from irsim.options.knowledge import Fact
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Degrees, Integer, Meters, MetersPerSecond, Number, Seconds


class Sfm(FittedOptions):
    """Walk like a pedestrian: pulled to the goal, pushed away by objects and walls (social force model).

    It starts from rest and does not brake at its goal: it swings back, so use a `goal_threshold` of
    about 0.3 m, and keep goals a metre apart. One that touches another stops for good, unless
    `world.collision_mode` is `unobstructed_obstacles`. Free-standing walls are passed on the nearer
    side; touching boxes count singly, a `compound` as one. It stays in dead ends.
    """

    in_group: ClassVar[bool] = True
    avoids: ClassVar[bool] = True
    knows: ClassVar[frozenset[Fact]] = frozenset({"circles", "static"})
    touches: ClassVar[bool] = True

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "sfm", "vmax": 1.3}]}

    name: Literal["sfm"] = "sfm"
    vmax: Annotated[MetersPerSecond, Field(gt=0)] = 1.5
    """Largest speed."""
    neighbor_threshold: Annotated[Meters, Field(gt=0)] = 10.0
    """Objects farther away are ignored."""
    relaxation_time: Annotated[Seconds, Field(gt=0)] = 0.5
    """Time in which the desired velocity is reached."""
    force_factor_desired: Number = 1.0
    """Weight of the pull to the goal."""
    force_factor_social: Number = 2.1
    """Weight of the push away from other objects."""
    force_factor_obstacle: Number = 10.0
    """Weight of the push away from walls."""
    sigma_obstacle: Annotated[Meters, Field(gt=0)] = 0.8
    """Reach of the push away from walls. In a corridor use about a twentieth of its width (0.15 m for 3 m): more pushes
    both directions into the middle, where they block each other."""
    lambda_importance: Number = 2.0
    """Weight of the relative velocity in an interaction, compared with the relative position."""
    gamma: Annotated[Number, Field(gt=0)] = 0.35
    """Reach of the interaction, per length of the interaction vector."""
    n_angular: Number = 2.0
    """Sharpness of the sideways part of the interaction."""
    n_velocity: Number = 3.0
    """Sharpness of the braking part of the interaction."""
    safety_radius: Annotated[Meters, Field(ge=0)] = 0.0
    """Margin added to each radius in the interaction."""
    sidestep: Annotated[Degrees, Field(ge=-45, le=45)] | None = None
    """As in `orca`: null breaks ties only, also with an object straight ahead; 0 leaves them."""
    keep_gap: bool | None = None
    """As in `rvo`."""
    social_groups: list[list[Annotated[Integer, Field(ge=0)]]] | None = None
    """As `group_behavior`: lists of indices of members that walk together, each at most once."""
    force_factor_coherence: Number = 2.0
    """In a group: weight of the pull to its middle."""
    force_factor_group_repulsion: Number = 1.0
    """In a group: weight of the push from members that are too close."""
    group_repulsion_threshold: Annotated[Meters, Field(ge=0)] | None = None
    """In a group: distance below which members push each other; null is the sum of their radii."""
    force_factor_gaze: Number = 3.0
    """In a group: weight of turning to see the others."""
    gaze_vision_angle: Annotated[Degrees, Field(gt=0, le=180)] = 90.0
    """In a group: half the angle that a member sees without turning."""

    def top_speed_of_its_own(self) -> float:
        """Limit of speed among its own keys [m/s]."""
        return float(self.vmax)


BEHAVIORS.register(Sfm, kernel=core.SfmOptions)
