"""The facts of a recorded run that an audit uses, as models that refuse anything of another kind."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

__all__ = ["Drawn", "EventFacts", "Meta", "ObjectFacts", "Options", "PartFacts", "ResultFacts", "RobotFacts",
           "WorldFacts"]  # fmt: skip

Name = Annotated[str, Field(max_length=4096)]
Finite = Annotated[float, Field(allow_inf_nan=False, ge=-1e12, le=1e12)]
Limit = Annotated[float, Field(ge=float("-inf"))]
"""A number that may be infinite, but is one."""
Step = Annotated[int, Field(ge=0, lt=2**62)]


class Meta(BaseModel):
    """Facts of ``run.json``."""

    names: list[Name]
    step_time: Annotated[float, Field(gt=0, le=1e9, allow_inf_nan=False)]
    seed: Annotated[int, Field(ge=0, lt=2**128)]
    horizon: Step = 0
    options: dict[str, Any] = {}
    gauges: list[tuple[Name, list[Name], Annotated[int, Field(ge=0, le=1_000_000)]]] = []
    scenario: Name | None = None
    irsim: Name = ""
    resolved: Name | None = None
    cells: Name | None = None
    cancelled: bool = False
    trace_until: Step | None = None


class DiscFacts(BaseModel):
    """A disc of the world [m]."""

    center: tuple[Finite, Finite]
    radius: Annotated[float, Field(gt=0, le=1e12)]


class GroundFacts(BaseModel):
    """A zone, and the effect of its ground on wheels."""

    line: list[tuple[Finite, Finite]] | None = None
    polygon: Annotated[list[tuple[Finite, Finite]], Field(max_length=100_000)] | None = None
    rectangle: tuple[Finite, Finite, Finite, Finite] | None = None
    circle: DiscFacts | None = None
    slip: Finite = 0.0
    slip_std: Finite = 0.0
    slip_time: Annotated[Finite, Field(ge=0)] = 1.0
    grip: Finite = 1.0
    surface: Name | None = None

    @property
    def has_effect(self) -> bool:
        """Whether wheels on it move otherwise than elsewhere."""
        return bool(self.slip or self.slip_std or self.grip != 1.0 or self.surface)


class WorldFacts(BaseModel):
    """Keys of the world that decide what counts."""

    integration: Literal["euler", "exact"] = "euler"
    collision_mode: Name = "stop"
    contacts: Literal["step_end", "swept"] = "step_end"
    after_arrival: Name | None = None
    zones: Annotated[list[GroundFacts], Field(max_length=100_000)] = []


PerControl = Finite | Annotated[list[Finite], Field(max_length=64)]


class ActuationFacts(BaseModel):
    """Reasons why executed controls differ from controls within the limits."""

    dead_band: PerControl = 0.0
    noise: PerControl = 0.0

    def of(self, key: Literal["dead_band", "noise"]) -> list[float]:
        """(3,) the value for each control."""
        value: float | list[float] = getattr(self, key)
        return ([*value, 0.0, 0.0, 0.0] if isinstance(value, list) else [value] * 3)[:3]


class Options(BaseModel):
    """Facts that objects may share."""

    role: Literal["robot", "obstacle"]
    static: bool
    unobstructed: bool
    kinematics: dict[str, Any] | None = None
    behavior: dict[str, Any] | None = None
    group_behavior: dict[str, Any] | None = None
    goal_threshold: Annotated[float, Field(ge=0)] = 0.0
    arrive_mode: Literal["position", "state"] = "position"
    wander: bool = False
    loop: bool = False
    wheelbase: float | None = None
    actuation: ActuationFacts | None = None
    perceives: Literal["truth", "estimate", "tracks", "both"] = "truth"
    vel_dim: Annotated[int, Field(ge=0, le=3)] = 2
    start_time: float = 0.0
    appear_time: float = 0.0
    vanish_time: float | None = None


class ObjectFacts(BaseModel):
    """Facts of one object."""

    id: Annotated[int, Field(ge=0, lt=2**31)] = 0
    name: Name
    form: Annotated[dict[str, Any] | None, Field(validation_alias="shape")] = None
    state: Annotated[list[float | None], Field(max_length=16)]
    goals: list[Annotated[list[float | None], Field(max_length=16)]] = []
    options: Annotated[int, Field(ge=0)]


class PartFacts(BaseModel):
    """A part of an outline, in the frame of its object [m]."""

    kind: Literal["circle", "polygon", "line", "room", "cells"]
    center: tuple[Finite, Finite] = (0.0, 0.0)
    radius: Annotated[float, Field(ge=0, le=1e12, allow_inf_nan=False)] = 0.0
    vertices: list[tuple[Finite, Finite]] = []


class Drawn(BaseModel):
    """Facts that the seed may have decided."""

    outlines: list[PartFacts]
    vel_min: Annotated[list[Limit], Field(min_length=3, max_length=3)]
    vel_max: Annotated[list[Limit], Field(min_length=3, max_length=3)]
    acce: Annotated[list[Limit], Field(min_length=3, max_length=3)]


class EventFacts(BaseModel):
    """An event."""

    kind: Name
    time: Finite
    step: Step
    object: Name
    partner: Name | None = None


class RobotFacts(BaseModel):
    """The result of one robot."""

    name: Name
    outcome: Literal["success", "collision", "timeout"]
    time_to_goal: float | None = None
    collision_count: Step = 0
    contacts_between_steps: Step = 0
    path_length: float | None = None
    distance_to_goal: float | None = None
    min_clearance: float | None = None
    nearest: Name | None = None
    pose: tuple[float | None, float | None, float | None]


class ResultFacts(BaseModel):
    """Facts of ``result.json``."""

    outcome: Literal["success", "collision", "timeout"]
    steps: Step
    sim_time: Finite
    until: Literal["done", "time_limit", "first_collision"] = "done"
    lost: Name | None = None
    robots: list[RobotFacts]
