"""``sfm``: social forces."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.behaviors._options import BehaviorOptions
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Degrees, Integer, Meters, MetersPerSecond, Number, Seconds


class Sfm(BehaviorOptions):
    """Walk like a pedestrian: pulled to the goal, pushed away by others and by walls (social force model).

    Starts from rest and does not brake at its goal: it runs past and swings back, so give it a `goal_threshold` of
    about 0.3 m, and goals of several a metre apart. Who touches somebody stands for ever, unless
    `world.collision_mode` is `unobstructed_obstacles`. It stays caught in dead ends.
    """

    in_group: ClassVar[bool] = True

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "sfm", "vmax": 1.3}]}

    name: Literal["sfm"] = "sfm"
    vmax: Annotated[MetersPerSecond, Field(gt=0)] = 1.5
    """Largest speed."""
    neighbor_threshold: Annotated[Meters, Field(gt=0)] = 10.0
    """Others farther away than this are ignored."""
    relaxation_time: Annotated[Seconds, Field(gt=0)] = 0.5
    """Time to reach the desired velocity."""
    force_factor_desired: Number = 1.0
    """Weight of the pull to the goal."""
    force_factor_social: Number = 2.1
    """Weight of the push away from others."""
    force_factor_obstacle: Number = 10.0
    """Weight of the push away from walls."""
    sigma_obstacle: Annotated[Meters, Field(gt=0)] = 0.8
    """Reach of the push away from walls: in corridors about a twentieth of their width (0.15 m for 3 m), or everybody
    is pushed into the middle and people who come from both sides meet there."""
    lambda_importance: Number = 2.0
    """Weight of relative velocity against relative position in the interaction."""
    gamma: Annotated[Number, Field(gt=0)] = 0.35
    """Reach of the interaction per length of the interaction vector."""
    n_angular: Number = 2.0
    """Sharpness of the sideways part of the interaction."""
    n_velocity: Number = 3.0
    """Sharpness of the braking part of the interaction."""
    safety_radius: Annotated[Meters, Field(ge=0)] = 0.0
    """Distance kept around each of two, in the interaction."""
    social_groups: list[list[Annotated[Integer, Field(ge=0)]]] | None = None
    """As group behavior: who walks together, lists of member indices; each index at most once."""
    force_factor_coherence: Number = 2.0
    """As group behavior: weight of the pull to the middle of one's social group."""
    force_factor_group_repulsion: Number = 1.0
    """As group behavior: weight of the push away from too close members of one's social group."""
    group_repulsion_threshold: Annotated[Meters, Field(ge=0)] | None = None
    """As group behavior: distance below which members push; null is the sum of their radii."""
    force_factor_gaze: Number = 3.0
    """As group behavior: weight of turning to see one's social group."""
    gaze_vision_angle: Annotated[Degrees, Field(gt=0, le=180)] = 90.0
    """As group behavior: half the angle one sees without turning."""


BEHAVIORS.register(Sfm, kernel=core.SfmOptions)
