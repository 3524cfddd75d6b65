"""A scenario as it is built, as lines of text: one for each entry, and what is random."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from irsim.common.text import clean, listed, metres, seconds

__all__ = ["scene_lines"]

_MAX_ROWS = 30
"""Number of entries that are shown."""
_MAX_HITS = 5
"""Number of objects that the line of a lidar names."""
_MAX_PASSAGES = 4
"""Number of narrow passages that are shown."""
_MAX_NAMED = 6
"""Number of robots, and of places, that the line of a passage names."""
_MAX_SEEDS = 10
"""Number of seeds that a line names."""


def scene_lines(table: Mapping[str, Any], labels: Mapping[str, str], seed: int) -> list[str]:
    """Describe the objects of a scenario at its start.

    Args:
        table: A scene table (:class:`irsim.results.picture.SceneTable`) as data.
        labels: Name of each robot -> its label in the picture.
        seed: Seed of the places.
    """
    rows = table["rows"]
    lines = ["Objects:" if not table["random"] else f"Objects with seed {seed} (random: {', '.join(table['random'])}):"]
    lines += [f"- {_row_text(row, labels, table['seeds'])}" for row in rows[:_MAX_ROWS]]
    if len(rows) > _MAX_ROWS:
        lines.append(f"- {len(rows) - _MAX_ROWS} more entries")
    lines += [_hits_text(lidar) for lidar in table["lidars"]]
    lines += [_passage_text(passage) for passage in table["passages"][:_MAX_PASSAGES]]
    if table["overlapping_goals"]:
        lines.append(f"Goals of robots overlap in {table['overlapping_goals']} of {table['seeds']} seeds")
    if table["crowded"]:
        count, named = len(table["crowded"]), listed([str(seed) for seed in table["crowded"]], _MAX_SEEDS)
        lines.append(
            f"No room for an object in {count} of {table['seeds']} seeds ({named}): "
            "use fewer or smaller objects, or larger ranges"
        )
    return lines


def _row_text(row: Mapping[str, Any], labels: Mapping[str, str], seeds: int) -> str:
    """Properties that the objects of an entry have in common, then each of the first ones with its place."""
    count, drive = row["count"], row["drive"] or "static"
    facts = [f"{'' if count == 1 else f'{count} x '}{drive}{'' if row['role'] == 'robot' else ' obstacle'}"]
    facts.append(row["footprint"])
    if row["drive"]:
        facts.append(row["behavior"] or "no behavior")
        facts.append("vel_max [{}]".format(", ".join(f"{value:g}" for value in row["vel_max"])))
    several = len(row["sensors"]) > 1
    facts += [f"sensor {k}: {sensor}" if several else sensor for k, sensor in enumerate(row["sensors"])]
    if row["appear_time"]:
        facts.append(f"appears at {seconds(row['appear_time'])}")
    if row["start_time"] > row["appear_time"]:
        facts.append(f"sets off at {seconds(row['start_time'])}")
    if row["starts"]:
        ends = f", goals {_box(row['ends'])}" if row["ends"] else ""
        facts.append(f"over {seeds} seeds starts {_box(row['starts'])}{ends}")
    places = [
        f"{_name(name, labels)} {_place(*at)}"
        for name, *at in zip(row["names"], row["poses"], row["goals"], row["waypoints"], row["ends_at"], strict=True)
    ]
    more = count - len(places)
    return f"{', '.join(facts)}: {'; '.join(places)}{f'; {more} more' if more > 0 else ''}"


def _name(name: str, labels: Mapping[str, str]) -> str:
    """The name of an object, and its label in the picture if that is another: ``'robot_0' (r0)``."""
    label = labels.get(name, name)
    return repr(clean(name)) if label == name else f"{clean(name)!r} ({clean(label)})"


def _place(pose: Sequence[float], goal: Sequence[float] | None, waypoints: int, end: Sequence[float] | None) -> str:
    x, y, heading = pose
    way = "" if goal is None else f" goal {_goal(goal)}"
    if end is not None and goal is not None and waypoints > 1:
        way = f" {waypoints} waypoints, first {_goal(goal)}, last {_goal(end)}"
    return f"at ({x:.2f}, {y:.2f}) heading {heading:.2f}{way}"


def _goal(goal: Sequence[float]) -> str:
    place = ", ".join(f"{value:.2f}" for value in goal)
    return f"({place}), heading counts" if len(goal) > 2 else f"({place})"


def _hits_text(lidar: Mapping[str, Any]) -> str:
    """How many beams of a lidar hit something at the start, and whom."""
    hits = [f"{clean(name)!r} {beams}" for name, beams in lidar["hits"].items()]
    whom = f": {', '.join(hits[:_MAX_HITS])}{', ...' if len(hits) > _MAX_HITS else ''}" if hits else ""
    which = "Lidar" if lidar["sensor"] is None else f"Sensor {lidar['sensor']}"
    return f"{which} of {clean(lidar['name'])!r}: {lidar['hit']} of {lidar['beams']} beams hit{whom}"


def _passage_text(passage: Mapping[str, Any]) -> str:
    """How wide the narrowest passage on the way of some robots is, and how wide these are."""
    names = [repr(clean(name)) for name in passage["names"]]
    who = "the robot is" if len(names) == 1 else "the robots are"
    places = [f"({x:.2f}, {y:.2f})" for x, y in passage["places"]]
    return (
        f"Narrowest passage on the way of {listed(names, _MAX_NAMED)}: {metres(passage['gap'])} at "
        f"{listed(places, _MAX_NAMED)}; {who} {metres(passage['width'])} wide"
    )


def _box(box: Sequence[float]) -> str:
    return "x {:.2f}..{:.2f} y {:.2f}..{:.2f}".format(*box)
