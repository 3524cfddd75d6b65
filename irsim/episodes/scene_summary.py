"""What a scenario holds, counted and in words: ``2 robots, 6 obstacles and the boundary``."""

from __future__ import annotations

from irsim.components.maps._grid import MapCells, Walls
from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["MAP_OR_WALLS", "counts_of", "in_words"]

MAP_OR_WALLS = (MapCells, Walls)
"""Shapes of objects that no entry made."""


def counts_of(scenario: ResolvedScenario) -> dict[str, int]:
    """How many ``robots``, ``obstacles`` (those of entries) and ``sensors`` there are.

    Where there is one also ``boundary`` (1) for walls round the world, and of a map ``map_columns``, ``map_rows`` and
    ``map_occupied``, cells that are occupied; the latter only if they are the same with every seed.
    """
    robots = len(scenario.robots())
    scenery = [record for record in scenario.objects if isinstance(record.shape, MAP_OR_WALLS)]
    counts = {
        "robots": robots,
        "obstacles": len(scenario.objects) - robots - len(scenery),
        "sensors": sum(len(record.sensors) for record in scenario.objects),
    }
    if any(isinstance(record.shape, Walls) for record in scenery):
        counts["boundary"] = 1
    if scenario.grid is not None:
        counts["map_columns"], counts["map_rows"] = scenario.grid.size
        if scenario.grid.occupied >= 0:
            counts["map_occupied"] = scenario.grid.occupied
    return counts


def in_words(counts: dict[str, int], *, robots: bool = True, sensors: bool = True) -> str:
    """The counts as one would say them: ``1 robot, no obstacles, a map of 125 x 125 cells (25 % occupied)``.

    Args:
        counts: From :func:`counts_of`.
        robots: Name the robots.
        sensors: Name the sensors.
    """
    walls = " and the boundary" if "boundary" in counts else ""
    parts = [_some(counts["robots"], "robot")] if robots else []
    parts.append(_some(counts["obstacles"], "obstacle") + walls)
    if "map_columns" in counts:
        columns, rows = counts["map_columns"], counts["map_rows"]
        occupied = counts.get("map_occupied")
        share = "" if occupied is None else f" ({_percent(occupied, columns * rows)} occupied)"
        parts.append(f"a map of {columns} x {rows} cells{share}")
    if sensors and counts["sensors"]:
        parts.append(_some(counts["sensors"], "sensor"))
    return ", ".join(parts)


def _some(count: int, noun: str) -> str:
    return f"{count or 'no'} {noun}{'s' * (count != 1)}"


def _percent(part: int, whole: int) -> str:
    share = 100 * part / whole
    if 0 < share < 1:
        return "less than 1 %"
    if 99 < share < 100:
        return "more than 99 %"
    return f"{share:.0f} %"
