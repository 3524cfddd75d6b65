"""A suite of recorded pedestrians: windows of a recording that a robot crosses, as scenarios of a benchmark."""

from __future__ import annotations

import json
import math
import random
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.scenario import (
    ROBOT_RADIUS,
    Layout,
    bounds,
    check_size,
    checked,
    crossing_time,
    number,
    people_lines,
    robot_lines,
    world_lines,
)
from irsim.bridges.pedestrians.tracks import Recording, Track, Window, make_tracks
from irsim.common.arrays import Floats

__all__ = ["POLICIES", "Episodes", "SuiteText", "Windows", "suite_text", "windows_of"]

_WAY = 0.6
"""Shortest way of the robot, as a share of the longer side of the recorded area."""
_ROOM = 0.5
"""Room between the robot and people who are there in the first second, at its start and goal [m]."""
_FIRST = 1.0
"""Time after the start of a window in which people count as being there [s]."""
_NAME = 64
"""Longest name of a suite [characters]."""
POLICIES = """\
policies:
  orca: {name: orca, timeHorizon: 3, safe_radius: 0.15, responsibility: 1}  # people do not give way
  sfm: sfm
  dash: dash
"""


@dataclass(frozen=True)
class Episodes:
    """How a suite divides a recording.

    Attributes:
        windows: Largest number of windows.
        length: Length of a window, and horizon of an episode [s]; None: what the robot needs with room for giving way.
        seed: Chooses the windows, if there are more.
    """

    windows: int = 10
    length: float | None = None
    seed: int = 0


@dataclass(frozen=True)
class SuiteText:
    """A suite.

    Attributes:
        text: The suite file.
        starts: When its windows start [s].
        length: How long they are [s].
        whole: Whether the recording is as long as a window.
    """

    text: str
    starts: list[float]
    length: float
    whole: bool


def suite_text(
    recording: Recording, places: Floats, rate: float, window: Window, layout: Layout, episodes: Episodes, name: str
) -> SuiteText:
    """The suite file.

    Args:
        recording: The rows.
        places: (N, 2) x, y [m] of the rows.
        rate: Frames per second.
        window: The part of the recording that is divided.
        layout: Sizes, step time, name of the file.
        episodes: How it is divided.
        name: Name of the suite; characters that suites do not have in their names are left out.

    Raises:
        BridgeError: No pedestrian is in the window of time and space, or the suite would be too large.
    """
    tracks, _ = make_tracks(recording, places, rate, window)
    made = windows_of(tracks, layout, episodes, offset=window.start)
    word = re.sub(r"[^A-Za-z0-9_.-]+", "_", name).strip("_")
    title = f"A robot crosses recorded pedestrians of {layout.source}"
    head = [
        f"# {len(made.starts)} windows of {made.length:g} s of {json.dumps(layout.source)}, written by `irsim bridge",
        "# import-pedestrians --write-suite`. Names of scenarios say when they start. Each seed draws another start",
        "# and goal of the robot; no pedestrian makes way for it.",
        "",
        f"suite: {(word if word[:1].isalpha() else f'recorded_{word}')[:_NAME]}",
        "version: 1",
        f"title: {json.dumps(title[:100])}",
        "scenarios:",
        *made.lines,
        "seeds: {first: 0, count: 10, full: 100}",
        f"steps: {made.steps}",
        "until: first_collision",
    ]
    return SuiteText(checked("\n".join(head) + "\n" + POLICIES), made.starts, made.length, made.whole)


@dataclass(frozen=True)
class Windows:
    """The windows of a recording, as scenarios of a suite.

    Attributes:
        lines: Entries of ``scenarios``.
        starts: When the windows start [s].
        length: How long they are [s].
        steps: The same in steps.
        whole: Whether the recording is as long as a window.
    """

    lines: list[str]
    starts: list[float]
    length: float
    steps: int
    whole: bool


def windows_of(
    tracks: Sequence[Track],
    layout: Layout,
    episodes: Episodes,
    *,
    word: str = "from",
    offset: float = 0.0,
    own: bool = False,
) -> Windows:
    """Windows of a recording, each with a robot that crosses the recorded area.

    Args:
        tracks: Its people.
        layout: Sizes, step time, name of the file.
        episodes: How it is divided.
        word: Start of the names of the scenarios.
        offset: When the tracks start in the recording [s].
        own: Give the scenarios a horizon and the tag ``word`` of their own.

    Raises:
        BridgeError: There is no pedestrian, or the windows would be too large.
    """
    if not tracks:
        what = "no pedestrian is in this window of time and space"
        raise BridgeError("bridge-file", what, "widen --start, --end and --crop")
    low, high = bounds(tracks, layout)
    inset = np.minimum(max(layout.margin / 2, ROBOT_RADIUS), (high - low) / 4)
    inner_low, inner_high = low + inset, high - inset
    length = episodes.length or float(crossing_time(inner_low.tolist(), inner_high.tolist()))
    steps = max(1, round(length / layout.step_time))
    length = round(steps * layout.step_time, 9)
    starts, whole = _starts(tracks, length)
    if len(starts) > episodes.windows:
        starts = sorted(random.Random(episodes.seed).sample(starts, episodes.windows))
    lines: list[str] = []
    kept: list[Track] = []
    for start in starts:
        part = _cut(tracks, start, length)
        kept += part
        check_size(kept)
        ways = [_crossing(part, inner_low, inner_high, layout.radius)]
        scene = [*world_lines(low, high, layout), *robot_lines(ways, "orca"), *people_lines(part, layout)]
        at = number(round(start + offset, 3)).replace("-", "m")
        lines += [f"  - name: {word}-{at}s", *([f"    steps: {steps}", f"    tags: [{word}]"] if own else [])]
        lines += ["    scenario:", *(f"      {line}" for line in scene)]
    return Windows(lines, starts, length, steps, whole)


def _starts(tracks: Sequence[Track], length: float) -> tuple[list[float], bool]:
    """Recorded times at which windows with a pedestrian start, one window after the other; at least one.

    Returns:
        The times [s], and whether the recording is as long as a window.
    """
    times = np.unique(np.concatenate([track.times for track in tracks]))
    first, last = float(times[0]), float(times[-1])
    count = math.floor((last - first) / length + 1e-9)
    if count == 0:
        return [first], False
    snapped = times[np.searchsorted(times, first + length * np.arange(count) - 1e-9)]
    result = [start for start in dict.fromkeys(snapped.tolist()) if _cut(tracks, start, length)]
    return result or [first], True


def _cut(tracks: Sequence[Track], start: float, length: float) -> list[Track]:
    """The parts of tracks in a window of time; times then count from its start."""
    result = []
    for track in tracks:
        inside = (track.times >= start - 1e-9) & (track.times <= start + length + 1e-9)
        if inside.sum() > 1:
            result.append(Track(track.name, np.maximum(track.times[inside] - start, 0.0), track.places[inside]))
    return result


def _crossing(tracks: Sequence[Track], low: Floats, high: Floats, radius: float) -> str:
    """Start and goal of the robot: another place of the recorded area with each seed, far apart, and free at first."""
    area = [[number(x), number(y), number(heading)] for (x, y), heading in ((low, -math.pi), (high, math.pi))]
    way = _WAY * float((high - low).max())
    near = [place for track in tracks for place in track.places[track.times <= _FIRST].tolist()]
    clear = ", ".join(f"{{point: [{number(x)}, {number(y)}], radius: {number(radius + _ROOM)}}}" for x, y in near)
    ends = ", ".join(f"range_{word}: [{', '.join(point)}]" for word, point in zip(("low", "high"), area, strict=True))
    return f"distribution: {{name: random, {ends}, goal_distance: {number(way)}, keep_clear: [{clear}]}}"
