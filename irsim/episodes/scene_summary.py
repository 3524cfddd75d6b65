"""Summary of a scene in numbers and words: ``2 robots, 6 obstacles, walls round the world``."""

from __future__ import annotations

from irsim.common.text import plural, quoted
from irsim.components.maps._grid import Walls
from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["called", "counts_of", "in_words"]


def called(scenario: ResolvedScenario, name: str | None) -> str:
    """How a sentence calls an object: its name in quotes, or ``the map``, ``the walls round the world``."""
    record = next((item for item in scenario.objects if item.name == name), None)
    return quoted(name) if record is None else record.called


def counts_of(scenario: ResolvedScenario) -> dict[str, int]:
    """Numbers of ``robots``, ``obstacles`` (without map and boundary walls) and ``sensors``.

    With boundary walls there is also ``boundary`` (1), and with a map ``map_columns``, ``map_rows`` and
    ``map_occupied``, the number of occupied cells; the last only if it is the same for every seed. ``map_unknown`` is
    the number of unknown cells if there are any.
    """
    robots = len(scenario.robots())
    scenery = [record for record in scenario.objects if record.is_terrain]
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
        if scenario.grid.unknown:
            counts["map_unknown"] = scenario.grid.unknown
    return counts


def in_words(counts: dict[str, int], *, robots: bool = True, sensors: bool = True) -> str:
    """The counts in words: ``1 robot, no obstacles, a map of 125 x 125 cells (25 % occupied)``.

    Args:
        counts: From :func:`counts_of`.
        robots: Name the robots.
        sensors: Name the sensors.
    """
    walls = ", walls round the world" if "boundary" in counts else ""
    parts = [_count_of(counts["robots"], "robot")] if robots else []
    parts.append(_count_of(counts["obstacles"], "obstacle") + walls)
    if "map_columns" in counts:
        columns, rows = counts["map_columns"], counts["map_rows"]
        occupied = counts.get("map_occupied")
        unknown = f", {_percent(counts['map_unknown'], columns * rows)} unknown" if "map_unknown" in counts else ""
        share = "" if occupied is None else f" ({_percent(occupied, columns * rows)} occupied{unknown})"
        parts.append(f"a map of {columns} x {rows} cells{share}")
    if sensors and counts["sensors"]:
        parts.append(_count_of(counts["sensors"], "sensor"))
    return ", ".join(parts)


def _count_of(count: int, noun: str) -> str:
    return plural(count, noun) if count else f"no {noun}s"


def _percent(part: int, whole: int) -> str:
    share = 100 * part / whole
    if 0 < share < 1:
        return "less than 1 %"
    if 99 < share < 100:
        return "more than 99 %"
    return f"{share:.0f} %"
