"""The typed result of ``irsim map import``."""

from __future__ import annotations

from irsim.results.base import Result

__all__ = ["MapImportResult", "MapLevel", "MapTrip"]


class MapLevel(Result):
    """A level of a scene."""

    level: int
    """Its number, the lowest is 0."""
    height: float
    """Height of its floor along the upward axis [m]."""
    area: float
    """Area of its largest connected part [m²]."""
    roof: bool
    """Whether it lies above another level and under the sky: a roof, or the top floor of a file without ceilings."""


class MapTrip(Result):
    """A start and a goal on the map."""

    start: tuple[float, float, float]
    """x, y [m], heading [rad]."""
    goal: tuple[float, float, float]
    """x, y [m], heading [rad]."""
    clearance: float
    """Distance from everything that is not free, which a way between them keeps [m]."""


class MapImportResult(Result):
    """The map that ``irsim map import`` made."""

    kind: str
    """Kind of the file."""
    files: list[str]
    """Files written; empty if only levels were listed."""
    columns: int
    """Cells along x."""
    rows: int
    """Cells along y."""
    resolution: float
    """Side of a cell [m]."""
    origin: tuple[float, float]
    """Lower left corner [m]."""
    free_area: float
    """Area that is free in the scenario [m²]."""
    occupied: int
    """Cells that are occupied in the scenario."""
    unknown: int
    """Cells of which nothing is known."""
    unknown_as: str
    """Their meaning in the scenario: free or occupied."""
    level: int
    """Level of the map."""
    height: float
    """Height of its floor along the upward axis of the file [m]."""
    levels: list[MapLevel]
    """All levels of the file, from the lowest; empty if it has none of its own."""
    components: list[float]
    """Areas of the connected parts of the level [m²], the largest first; at most 20."""
    kept: int | None
    """Number of the part that is free in the map; None if all are."""
    trip: MapTrip | None
    """A start and a goal for a robot; None if there is no room."""
    notes: list[str]
    """Remarks on the file and what was made of it."""
