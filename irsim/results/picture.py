"""The typed results of ``irsim.render`` and ``irsim.api.snapshot``: pictures, poses in them, the table of a scene."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irsim.results.base import Result
from irsim.results.findings import Finding

__all__ = [
    "MAX_MOMENTS",
    "MIN_MOMENTS",
    "LidarHits",
    "MovingPose",
    "RenderResult",
    "RobotPlan",
    "RobotPose",
    "ScenePassage",
    "SceneRow",
    "SceneTable",
    "SnapshotResult",
    "view_message",
]

MIN_MOMENTS = 2
"""Least number of moments of a film strip."""
MAX_MOMENTS = 12
"""Greatest number of moments of a film strip."""


class RenderResult(Result):
    """The result of ``irsim render``."""

    scenario: str
    """The file."""
    seed: int
    """Seed that was used."""
    steps: int
    """Number of executed steps."""
    frames: int
    """Number of pictures drawn."""
    size: tuple[int, int]
    """Width and height [px]."""
    files: list[str]
    """Files written."""
    warnings: list[Finding]
    """Warnings about the scenario."""
    ended: int | None = None
    """Step in which the episode had ended, if a picture shows a later one."""
    view: tuple[float, float, float, float] | None = None
    """Part that the last picture shows [m]: x_min, x_max, y_min, y_max, if ``world.plot.viewpoint`` moves it away from
    the world; None if it shows the world or a region that was asked for."""
    extent: tuple[float, float, float, float]
    """Bounds of the world [m]: x_min, x_max, y_min, y_max."""
    table: SceneTable
    """The objects that the scenario makes, one row for each entry."""
    labels: dict[str, str] = {}
    """Label in the picture of each robot whose name is not drawn."""
    reproduce: str
    """Command that reproduces this result."""


class RobotPose(Result):
    """Where a robot is in a snapshot."""

    name: str
    label: str
    """Its label in the picture; its goal's label is the same with the prefix ``G-``."""
    pose: tuple[float, float, float]
    """x, y [m] and heading [rad]."""
    goal: tuple[float, float] | None
    """Present goal [m]; None without one."""
    status: Literal["under way", "arrived", "collided", "not there yet"]
    """Its state at that moment."""


class MovingPose(Result):
    """Where a moving obstacle is in a snapshot."""

    name: str
    pose: tuple[float, float, float]
    """x, y [m] and heading [rad]."""
    velocity: tuple[float, float]
    """Velocity along x and y of the world [m/s]; an omni drive need not move in the direction of its heading."""


class RobotPlan(Result):
    """The path that a robot would take through its goals."""

    name: str
    label: str
    """Its label in the picture."""
    own: bool
    """Whether the robot's own behavior plans it, leg by leg; otherwise it is a shortest path round everything static,
    which touches corners and which the robot itself may not know."""
    length: float
    """Length of the path, as far as one was found [m]."""
    margin: float | None
    """Smallest distance between the footprint, placed along the path, and anything that stands, people included [m];
    negative where they overlap, None if nothing stands."""
    nearest: str | None
    """Name of what is that near; None if nothing stands."""
    nearest_called: str | None
    """That in a sentence: its name in quotes, `the map` or `the walls round the world`."""
    tightest: tuple[float, float]
    """Position of that smallest distance [m]."""
    lost: tuple[float, float] | None
    """First goal that it cannot reach [m]; None if it reaches all of them."""


class SnapshotResult(Result):
    """The result of ``irsim.api.snapshot``."""

    scenario: str
    """The file, or ``(text)``."""
    seed: int
    """Seed that was used."""
    random: list[str]
    """Parts that the seed decides; empty if every seed gives the same run."""
    steps: int
    """Number of executed steps."""
    sim_time: float
    """Simulated time [s]."""
    extent: tuple[float, float, float, float]
    """Bounds of the world [m]: x_min, x_max, y_min, y_max."""
    obstacles: int
    """Number of obstacles from entries, without the boundary and the map."""
    contents: str
    """The obstacles in words, with the boundary and the map."""
    view: tuple[float, float, float, float] | None = None
    """Part that the picture shows [m]: x_min, x_max, y_min, y_max, if ``world.plot.viewpoint`` moves it away from the
    world; None if it shows the world or a region that was asked for."""
    ended: int | None = None
    """Step in which the episode had ended, if the picture shows a later one."""
    explored: float | None = None
    """Share of the area of the world that the robots have seen, from 0 to 1; the rest is under fog. None without
    ``world.fog_map``."""
    robots: list[RobotPose]
    """One entry per robot."""
    moving: list[MovingPose]
    """One entry per obstacle that can move."""
    moments: list[int] = []
    """Steps in the picture, from left to right and top to bottom, if it shows several."""
    plans: list[RobotPlan] = []
    """Planned paths of the robots, if requested."""
    left_out: list[str] = []
    """Things that the picture leaves out because there is too much to show."""
    size: tuple[int, int]
    """Width and height [px]."""
    warnings: list[Finding]
    """Warnings about the scenario."""
    reproduce: str
    """Command that draws the same picture."""
    png: bytes = Field(default=b"", exclude=True, repr=False)
    """The picture."""


class SceneRow(Result):
    """The objects of one entry of a scenario."""

    names: list[str]
    """Names of its first objects."""
    count: int
    """Number of its objects."""
    role: Literal["robot", "obstacle"]
    drive: str | None
    """Name of the drive; None if the objects never move."""
    behavior: str | None
    """The behavior or policy that decides for the objects; None if nothing does."""
    footprint: str
    """Shape and size in words."""
    poses: list[tuple[float, float, float]]
    """x, y [m] and heading [rad] at the start of the first objects."""
    goals: list[tuple[float, float] | tuple[float, float, float] | None]
    """First goals of the first objects: x, y [m], and a heading [rad] where it counts for the arrival; None without
    one that is written or drawn."""
    waypoints: list[int]
    """Number of goals of the first objects."""
    ends_at: list[tuple[float, float] | tuple[float, float, float] | None]
    """Last goals of the first objects, as in `goals`."""
    sensors: list[str]
    """Its sensors in words."""
    appear_time: float
    """Time at which its first object comes into the world [s]; 0 at the start."""
    start_time: float
    """Time at which its first object sets off [s]."""
    vel_max: list[float]
    """Upper limits of the controls; empty for objects that never move."""
    starts: tuple[float, float, float, float] | None = None
    """x_min, x_max, y_min, y_max [m] of the starts of all its objects over all seeds; None if they are not random."""
    ends: tuple[float, float, float, float] | None = None
    """The same of their first goals."""


class LidarHits(Result):
    """Whom the beams of a lidar hit at the start."""

    name: str
    """Name of the object that carries the lidar."""
    sensor: int | None = None
    """Its number among the sensors of the object, if these are several."""
    beams: int
    """Number of its beams."""
    hit: int
    """Number of beams that hit something."""
    hits: dict[str, int]
    """Number of beams that hit each object, the most first."""


class ScenePassage(Result):
    """The narrowest place on the shortest way of robots to one of their goals."""

    names: list[str]
    """Names of the robots."""
    width: float
    """Their width [m]: the diameter of the largest disc inside one of them."""
    gap: float
    """Free distance between what stands left and what stands right of the way [m]."""
    places: list[tuple[float, float]]
    """Middle of each gap of this width on their ways: x, y [m]."""


class SceneTable(Result):
    """The objects of a scenario, and what changes from seed to seed."""

    rows: list[SceneRow]
    """One row for each entry, without the map and the walls around the world."""
    random: list[str]
    """Parts that the seed decides; empty if every seed gives the same run."""
    seeds: int
    """Number of seeds, from 0 on, that were tried; 1 if places are not random."""
    crowded: list[int]
    """Seeds that leave no room for an object."""
    overlapping_goals: int
    """Number of those seeds in which the goals of two robots overlap, while with some other seed they do not."""
    lidars: list[LidarHits]
    """Whom the beams of the first lidars hit; empty if the scenario has very many beams."""
    passages: list[ScenePassage] = []
    """Narrowest passages on the ways of robots, the tightest first, without those much wider than the robots."""


def view_message(view: tuple[float, float, float, float]) -> str:
    """Say which part of the world a picture shows.

    Args:
        view: x_min, x_max, y_min, y_max [m], the part of the world that it shows.
    """
    x0, x1, y0, y1 = view
    return f"shows only x {x0:g}..{x1:g} m, y {y0:g}..{y1:g} m, as plot.viewpoint centres the view"
