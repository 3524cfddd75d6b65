"""``irsim bridge import-pedestrians``: recorded pedestrians become a scenario, a benchmark suite, or both."""

from __future__ import annotations

import json
import math
import random
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from irsim.benchmarks.suite import MAX_SCENARIOS
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
    scenario_text,
    world_lines,
)
from irsim.bridges.pedestrians.tracks import (
    FormatName,
    Recording,
    Track,
    Window,
    frame_rate,
    make_tracks,
    pixels_to_metres,
    read_homography,
    read_recording,
)
from irsim.common.arrays import Floats
from irsim.common.files import check_new, write_new
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim.options.registry import BEHAVIORS

__all__ = ["Episodes", "ImportedPedestrians", "SuiteText", "import_pedestrians", "suite_text"]

_WAY = 0.6
"""Shortest way of the robot, as a share of the longer side of the recorded area."""
_ROOM = 0.5
"""Room between the robot and people who are there in the first second, at its start and goal [m]."""
_FIRST = 1.0
"""Time after the start of a window in which people count as being there [s]."""
_NAME = 64
"""Longest name of a suite [characters]."""
_POLICIES = """\
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
    if not tracks:
        what = "no pedestrian is in this window of time and space"
        raise BridgeError("bridge-file", what, "widen --from, --to and --crop")
    low, high = bounds(tracks, layout)
    inset = np.minimum(max(layout.margin / 2, ROBOT_RADIUS), (high - low) / 4)
    inner_low, inner_high = low + inset, high - inset
    length = episodes.length or float(crossing_time(inner_low.tolist(), inner_high.tolist()))
    steps = max(1, round(length / layout.step_time))
    length = round(steps * layout.step_time, 9)
    starts, whole = _starts(tracks, length)
    if len(starts) > episodes.windows:
        starts = sorted(random.Random(episodes.seed).sample(starts, episodes.windows))
    scenarios: list[str] = []
    kept: list[Track] = []
    for start in starts:
        part = _cut(tracks, start, length)
        kept += part
        check_size(kept)
        ways = [_crossing(part, inner_low, inner_high, layout.radius)]
        lines = [*world_lines(low, high, layout), *robot_lines(ways, "orca"), *people_lines(part, layout)]
        at = number(round(start + window.start, 3)).replace("-", "m")
        scenarios += [f"  - name: from-{at}s", "    scenario:", *(f"      {line}" for line in lines)]
    word = re.sub(r"[^A-Za-z0-9_.-]+", "_", name).strip("_")
    title = f"A robot crosses recorded pedestrians of {layout.source}"
    head = [
        f"# {len(starts)} windows of {length:g} s of {json.dumps(layout.source)}, written by `irsim bridge",
        "# import-pedestrians --suite`. Names of scenarios say when they start. Each seed draws another start and goal",
        "# of the robot; no pedestrian makes way for it.",
        "",
        f"suite: {(word if word[:1].isalpha() else f'recorded_{word}')[:_NAME]}",
        "version: 1",
        f"title: {json.dumps(title[:100])}",
        "scenarios:",
        *scenarios,
        "seeds: {first: 0, count: 10, full: 100}",
        f"steps: {steps}",
        "until: first_collision",
    ]
    return SuiteText(checked("\n".join(head) + "\n" + _POLICIES), starts, length, whole)


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


_GAP = 2.0
"""Time without a row that is worth a note [s]; splines have long ones."""
_ON_STEP = 1e-6
"""Steps by which a recorded time may miss the end of a step."""


@dataclass(frozen=True)
class ImportedPedestrians:
    """Result of an import.

    Attributes:
        file: The scenario; None if only a suite was written.
        format: Format of the recording.
        pedestrians: Number of obstacles that are replayed.
        rows: Number of recorded places.
        duration: Time of the last one [s].
        fps: Frames per second that times were computed with.
        notes: Remarks for the user.
        suite: The suite; None without a suite.
        windows: Times at which the windows of the suite start [s].
        length: Length of a window [s]; 0 without a suite.
    """

    file: str | None
    format: str
    pedestrians: int
    rows: int
    duration: float
    fps: float
    notes: list[str] = field(default_factory=list)
    suite: str | None = None
    windows: list[float] = field(default_factory=list)
    length: float = 0.0


def import_pedestrians(
    path: str | Path,
    out: str | Path | None = None,
    *,
    suite: str | Path | None = None,
    form: FormatName | None = None,
    fps: float | None = None,
    window: Window | None = None,
    homography: str | Path | None = None,
    scale: float | None = None,
    image_size: tuple[float, float] | None = None,
    layout: Layout | None = None,
    episodes: Episodes | None = None,
    overwrite: bool = False,
) -> ImportedPedestrians:
    """Write a scenario in which recorded pedestrians walk as they did, a suite whose scenarios are windows, or both.

    Args:
        path: ETH's ``obsmat.txt``, UCY's ``.vsp``, or lines ``frame id x y``.
        out: The scenario to write.
        suite: The suite to write.
        form: Format of the file; default: as suffix and columns say.
        fps: Frames per second; default: 25 for ``vsp``, else such that the usual step between frames takes 0.4 s.
        window: Part of the recording that is kept.
        homography: File with a 3 x 3 matrix from pixels to metres; for files in pixels.
        scale: Metres of a pixel, instead of a homography.
        image_size: Width and height of the picture, if the homography counts pixels from its upper left corner.
        layout: Robot, sizes, step time.
        episodes: How the suite divides the recording.
        overwrite: Replace files that exist.

    Raises:
        BridgeError: The file cannot be used, or no pedestrian is in the window. Nothing is written then.
        ArgumentError: An option does not fit the file, or no file is to be written.
        TargetError: The scenario or the suite exists.
    """
    path, window = Path(path), window or Window()
    layout, episodes = layout or Layout(path.name), episodes or Episodes()
    targets = [Path(target) for target in (out, suite) if target is not None]
    if not targets or len(set(targets)) < len(targets):
        raise ArgumentError("a scenario or a suite must be written, each to a file of its own", "give -o or --suite")
    for name, value in (
        ("fps", fps), ("scale", scale), ("length", episodes.length), ("step_time", layout.step_time),
        ("radius", layout.radius), ("windows", episodes.windows),
    ):  # fmt: skip
        if value is not None and not 1e-6 <= value <= 1e9:
            raise ArgumentError(f"{name} must be a positive number, got {value}", f"give a {name} from 1e-6 to 1e9")
    if episodes.windows > MAX_SCENARIOS:
        what = f"a suite has at most {MAX_SCENARIOS} windows, got {episodes.windows}"
        raise ArgumentError(what, "give fewer windows")
    if not (math.isfinite(layout.margin) and layout.margin >= 0):
        raise ArgumentError(f"margin must be 0 or more, got {layout.margin}", "give a margin in metres, such as 1")
    if layout.robot and BEHAVIORS.get(layout.behavior) is None:
        known = BEHAVIORS.names()
        fix = suggestion(layout.behavior, known, f"choose from {', '.join(known)}")
        raise ArgumentError(f"{clean(layout.behavior)!r} is not a behavior", fix)
    for target in targets:
        check_new(target, overwrite=overwrite)
    recording = read_recording(path, form)
    matrix = None if homography is None else read_homography(Path(homography))
    places = recording.place
    if recording.format == "vsp" and matrix is None and scale is None:
        what = "places of .vsp files are pixels, and nothing says how long a pixel is"
        raise ArgumentError(what, "give --homography FILE, or --scale with the metres of a pixel")
    if matrix is not None or scale is not None:
        places = pixels_to_metres(places, matrix, scale, image_size)
    rate = fps or frame_rate(recording)
    tracks, left_out = make_tracks(recording, places, rate, window)
    if not tracks:
        what = f"no pedestrian is in {path.name} for two rows, in this window of time and space"
        raise BridgeError("bridge-file", what, "widen --from, --to and --crop; times count from the first frame")
    texts: dict[Path, str] = {}
    made: SuiteText | None = None
    if out is not None:
        texts[Path(out)] = scenario_text(tracks, layout)
    if suite is not None:
        name = Path(suite).stem
        made = suite_text(recording, places, rate, window, layout, episodes, name)
        texts[Path(suite)] = made.text
    for target, text in texts.items():
        write_new(target, text, overwrite=overwrite)
    notes = []
    if made is not None and not made.whole:
        notes.append(f"the recording ends before the only window of the suite, which is {made.length:g} s long")
    if fps is None and recording.format != "vsp":
        notes.append(f"{rate:g} frames per second are assumed, so that 0.4 s are between rows; --fps says otherwise")
    if recording.unknown:
        notes.append(f"{recording.unknown} rows without a place (?) were left out")
    if left_out:
        notes.append(f"{left_out} with a single row in the window were left out")
    longest, name = max((float(np.diff(track.times).max()), track.name) for track in tracks)
    if recording.format != "vsp" and longest > _GAP:
        notes.append(f"{name} has no row for {longest:g} s, and goes on between those before and after it")
    if _between_steps(tracks, layout.step_time):
        notes.append("recorded times lie between steps: at the ends of steps, places are interpolated")
    return ImportedPedestrians(
        file=None if out is None else str(out),
        format=recording.format,
        pedestrians=len(tracks),
        rows=sum(len(track.times) for track in tracks),
        duration=max(float(track.times[-1]) for track in tracks),
        fps=rate,
        notes=notes,
        suite=None if suite is None else str(suite),
        windows=[] if made is None else made.starts,
        length=0.0 if made is None else made.length,
    )


def _between_steps(tracks: list[Track], step_time: float) -> bool:
    """Whether a recorded time is not at the end of a step."""
    steps = np.concatenate([track.times for track in tracks]) / step_time
    return bool(np.abs(steps - np.round(steps)).max() > _ON_STEP)
