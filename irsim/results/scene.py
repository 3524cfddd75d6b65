"""The typed result of ``irsim.validation.scene_table``: what a scenario file becomes, one row for each entry."""

from __future__ import annotations

from typing import Literal

from irsim.results.base import Result

__all__ = ["LidarHits", "ScenePassage", "SceneRow", "SceneTable"]


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
    """What decides for the objects; None if nothing does."""
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
    """What the seed decides; empty if every seed gives the same run."""
    seeds: int
    """Number of seeds, from 0 on, that were tried; 1 if places are not random."""
    crowded: list[int]
    """Those that leave no room for an object."""
    overlapping_goals: int
    """Number of those seeds in which the goals of two robots overlap, while those of some other seed do not."""
    lidars: list[LidarHits]
    """Whom the beams of the first lidars hit; empty if the scenario has very many beams."""
    passages: list[ScenePassage] = []
    """Narrowest passages on the ways of robots, the tightest first, without those much wider than the robots."""
