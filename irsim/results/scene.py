"""The typed result of ``irsim.validation.scene_table``: what a scenario file becomes, one row for each entry."""

from __future__ import annotations

from typing import Literal

from irsim.results.base import Result

__all__ = ["SceneRow", "SceneTable"]


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
    goals: list[tuple[float, float] | None]
    """First goals [m] of the first objects; None without one that is written or drawn."""
    vel_max: list[float]
    """Upper limits of the controls; empty for objects that never move."""
    starts: tuple[float, float, float, float] | None = None
    """x_min, x_max, y_min, y_max [m] of the starts of all its objects over all seeds; None if they are not random."""
    ends: tuple[float, float, float, float] | None = None
    """The same of their first goals."""


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
