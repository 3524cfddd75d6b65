"""``isaac_people``: the ways of pedestrians as text of commands for people of Isaac Sim (``omni.anim.people``, IRA).

Each object is spawned at its first place, goes along its recorded path (`walker GoTo 1 2 0 3 2 0 _`) and stands
(`walker Idle 4`) where and as long as it stood. Commands have no times: people of Isaac Sim walk at their own speed, so
this gives their ways, and the format `usd` their exact motion. Coordinates are in irsim's frame [m], z up. Options are
`tolerance`, `pause` and `z`.
`--objects` names other objects than the pedestrians, which are the obstacles that can move.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import shapely
from pydantic import Field

from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.bridges.usd.solids import prim_names
from irsim.common.arrays import Floats
from irsim.common.text import decimal
from irsim.options.base import Options
from irsim.options.units import Meters, Seconds

__all__ = ["FORMAT"]


class PeopleOptions(Options):
    """How closely commands follow the recorded ways."""

    tolerance: Annotated[Meters, Field(ge=0)] = 0.1
    """Greatest distance of the recorded path from the straight lines between the points of a command."""
    pause: Annotated[Seconds, Field(gt=0)] = 1.0
    """A person who moves less than `tolerance` for this long stands, which is a command of its own."""
    z: Meters = 0.0
    """Height of the ground."""


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write the commands of one run: who is there, then what each of them does."""
    [episode] = episodes
    options = episode.options
    assert isinstance(options, PeopleOptions)
    blocks = [(block.trace.time, block.trace.pose) for block in episode.blocks(scans=False)]
    times, poses = np.concatenate([time for time, _ in blocks]), np.concatenate([pose for _, pose in blocks])
    names = prim_names(actor.name for actor in episode.actors)
    spawned, commands, late, absent = [], [], [], []
    for column, word in enumerate(names):
        there = np.isfinite(poses[:, column]).all(axis=1)
        if not there.any():
            absent.append(word)
            continue
        time, pose = times[there], poses[there, column]
        x, y, heading = pose[0].tolist()
        degrees = decimal(math.degrees(math.remainder(heading, math.tau)), 3)
        spawned.append(f"Spawn {word} {_point((x, y), options.z)} {degrees}")
        if time[0] > times[0]:
            late.append(word)
            commands.append(f"{word} Idle {decimal(float(time[0] - times[0]), 3)}")
        commands += [f"{word} {text}" for text in _commands(time, pose[:, :2], options)]
    target.write_text("\n".join([*spawned, *commands]) + "\n", encoding="utf-8", newline="\n")
    renamed = [actor.name for actor, word in zip(episode.actors, names, strict=True) if actor.name != word]
    return [
        f"{what}: {', '.join(who[:5])}{f' and {len(who) - 5} more' if len(who) > 5 else ''}"
        for what, who in (
            ("never in the world, so left out", absent),
            ("not in the world at the start, so standing where they appear before", late),
            ("named with letters, digits and underscores only", renamed),
        )
        if who
    ]


def _commands(times: Floats, places: Floats, options: PeopleOptions) -> Iterator[str]:
    """The commands of a person, one after the other.

    Args:
        times: (K,) [s].
        places: (K, 2) [m].
        options: How closely to follow.
    """
    since = 0  # first row of the way that has no command yet
    row = 0
    while row < len(times):
        last = _stands_until(places, row, options.tolerance)
        stood = float(times[last] - times[row])
        if stood < options.pause:
            row += 1
            continue
        yield from _way(np.vstack([places[since:row], np.median(places[row : last + 1], axis=0)]), options)
        yield f"Idle {decimal(stood, 3)}"
        since = row = last
        if last == len(times) - 1:
            return
        row += 1
    yield from _way(places[since:], options)


def _stands_until(places: Floats, row: int, tolerance: float) -> int:
    """Last row up to which a person stays within ``tolerance`` of the place of a row."""
    for later in range(row + 1, len(places)):
        if math.dist(places[row], places[later]) > tolerance:
            return later - 1
    return len(places) - 1


def _way(places: Floats, options: PeopleOptions) -> Iterator[str]:
    """The command that goes along a path; none for one that stays where it starts."""
    if len(places) < 2 or np.ptp(places, axis=0).max() == 0:
        return
    points = shapely.get_coordinates(shapely.LineString(places).simplify(options.tolerance))[1:]
    yield f"GoTo {' '.join(_point(point, options.z) for point in points.tolist())} _"


def _point(place: Sequence[float], z: float) -> str:
    return f"{decimal(place[0], 3)} {decimal(place[1], 3)} {decimal(z, 3)}"


FORMAT = Format("isaac_people", ".txt", _write, ranges=False, objects="people", options=PeopleOptions, named=True)
