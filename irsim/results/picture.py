"""The typed results of ``irsim.render`` and ``irsim.api.snapshot``: pictures, and the poses in them."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irsim.results.base import Result
from irsim.results.findings import Finding

__all__ = ["MovingPose", "RenderResult", "RobotPlan", "RobotPose", "SnapshotResult"]


class RenderResult(Result):
    """What ``irsim render`` drew."""

    scenario: str
    """The file."""
    seed: int
    """Seed that was used."""
    steps: int
    """Executed steps."""
    frames: int
    """Pictures drawn."""
    size: tuple[int, int]
    """Width and height [px]."""
    files: list[str]
    """Files written."""
    warnings: list[Finding]
    """What is odd about the scenario."""
    reproduce: str
    """Command that gives the same again."""


class RobotPose(Result):
    """Where a robot is in a snapshot."""

    name: str
    label: str
    """What stands beside it in the picture; beside its goal that with ``G-`` before it."""
    pose: tuple[float, float, float]
    """x, y [m] and heading [rad]."""
    goal: tuple[float, float] | None
    """Present goal [m]; None without one."""
    status: Literal["under way", "arrived", "collided"]
    """What became of it so far."""


class MovingPose(Result):
    """Where a moving obstacle is in a snapshot."""

    name: str
    pose: tuple[float, float, float]
    """x, y [m] and heading [rad]."""
    velocity: tuple[float, float]
    """Along x and y of the world [m/s]; an omni drive need not move where it heads."""


class RobotPlan(Result):
    """The way that a robot would take over its goals."""

    name: str
    label: str
    """What stands beside it in the picture."""
    own: bool
    """Its own behavior has planned it; else it is a shortest way round what stands still, which it may not know."""
    length: float
    """Of the way, as far as there is one [m]."""
    margin: float | None
    """About the least distance between what stands still and a disc inside of the robot's body [m]; None where nothing
    stands."""
    tightest: tuple[float, float]
    """Where that is [m]."""
    lost: tuple[float, float] | None
    """A goal that it cannot get to [m]; None if it gets to all of them."""


class SnapshotResult(Result):
    """What ``irsim.api.snapshot`` drew."""

    scenario: str
    """The file, or ``(text)``."""
    seed: int
    """Seed that was used."""
    random: list[str]
    """What the seed decides; empty if every seed gives the same run."""
    steps: int
    """Executed steps."""
    sim_time: float
    """Simulated time [s]."""
    extent: tuple[float, float, float, float]
    """The world: least and greatest x, least and greatest y [m]."""
    obstacles: int
    """How many obstacles there are: those of entries."""
    contents: str
    """The obstacles in words: with the boundary and the map."""
    robots: list[RobotPose]
    """One entry per robot."""
    moving: list[MovingPose]
    """One entry per obstacle that can move."""
    moments: list[int] = []
    """Steps in the picture, from left to right and top to bottom, if it shows several."""
    plans: list[RobotPlan] = []
    """The ways of robots, if they were asked for."""
    size: tuple[int, int]
    """Width and height [px]."""
    warnings: list[Finding]
    """What is odd about the scenario."""
    reproduce: str
    """Command that draws the same moment."""
    png: bytes = Field(default=b"", exclude=True, repr=False)
    """The picture."""
