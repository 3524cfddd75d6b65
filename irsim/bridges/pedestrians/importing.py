"""``irsim bridge import-pedestrians``: recorded pedestrians become a scenario, a benchmark suite, or both."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from irsim.benchmarks.suite import MAX_SCENARIOS
from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.into import merge
from irsim.bridges.pedestrians.scenario import Layout, scenario_text
from irsim.bridges.pedestrians.suite import Episodes, SuiteText, suite_text
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
from irsim.common.arguments import check_positive
from irsim.common.arrays import Floats
from irsim.common.files import check_new, write_new
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim.options.registry import BEHAVIORS

__all__ = ["ImportedPedestrians", "Placing", "import_pedestrians"]

_GAP = 2.0
"""Time without a row that is worth a note [s]; splines have long ones."""
_LARGEST = 1e9
"""Largest length, time and coordinate [m or s]."""
_ON_STEP = 1e-6
"""Steps by which a recorded time may miss the end of a step."""


@dataclass(frozen=True)
class ImportedPedestrians:
    """Result of an import.

    Attributes:
        file: The scenario; None if only a suite was written.
        into: The scene that the pedestrians were merged into; None for a scenario of their own.
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
    into: str | None = None


@dataclass(frozen=True)
class Placing:
    """Where the recording is in the world: it is turned about its origin, then moved.

    Attributes:
        rotate: Angle, counterclockwise [degrees].
        offset: x, y [m].
    """

    rotate: float = 0.0
    offset: tuple[float, float] = (0.0, 0.0)

    def applied(self, places: Floats) -> Floats:
        """(N, 2) places in the world of (N, 2) recorded places; unchanged to the last bit without a placing."""
        if self.rotate:
            cos, sin = math.cos(math.radians(self.rotate)), math.sin(math.radians(self.rotate))
            places = places @ np.array([[cos, sin], [-sin, cos]])
        return places + np.array(self.offset) if any(self.offset) else places


def import_pedestrians(
    path: str | Path,
    out: str | Path | None = None,
    *,
    suite: str | Path | None = None,
    into: str | Path | None = None,
    placing: Placing | None = None,
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
        out: The scenario to write; default with ``into``: that file itself.
        suite: The suite to write.
        into: A scene that gets the pedestrians, in place of a scenario of their own; its world, robots and obstacles
            stay, and of the layout only the size of pedestrians and the interpolation count.
        placing: Where the recording is in the world.
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
        ScenarioError: The scene has errors.
        ArgumentError: An option does not fit the file, or no file is to be written.
        TargetError: The scenario or the suite exists.
    """
    path, window, scene = Path(path), window or Window(), None if into is None else Path(into)
    layout, episodes = layout or Layout(path.name), episodes or Episodes()
    _check_options(layout, episodes, fps=fps, scale=scale)
    _check_coordinates(window, layout, placing or Placing(), image_size)
    if scene is not None and suite is not None:
        raise ArgumentError("a suite has scenes of its own", "leave out --suite, or --into")
    itself = scene is not None and (out is None or Path(out).resolve() == scene.resolve())
    out = scene if itself else out
    targets = [Path(target) for target in (out, suite) if target is not None]
    if not targets or len(set(targets)) < len(targets):
        raise ArgumentError("a scenario or a suite must be written, each to a file of its own", "give -o or --suite")
    for target in () if itself else targets:
        check_new(target, overwrite=overwrite)
    recording = read_recording(path, form)
    matrix = None if homography is None else read_homography(Path(homography))
    places = recording.place
    if recording.format == "vsp" and matrix is None and scale is None:
        what = "places of .vsp files are pixels, and nothing says how long a pixel is"
        raise ArgumentError(what, "give --homography FILE, or --scale with the metres of a pixel")
    if matrix is not None or scale is not None:
        places = pixels_to_metres(places, matrix, scale, image_size)
    places = (placing or Placing()).applied(places)
    rate = fps or frame_rate(recording)
    tracks, left_out = make_tracks(recording, places, rate, window)
    if not tracks:
        what = f"no pedestrian is in {path.name} for two rows, in this window of time and space"
        raise BridgeError("bridge-file", what, "widen --start, --end and --crop; times count from the first frame")
    texts: dict[Path, str] = {}
    made: SuiteText | None = None
    notes, step_time = list[str](), layout.step_time
    if out is not None and scene is not None:
        merged = merge(scene, Path(out), tracks, layout)
        texts[Path(out)], tracks, notes, step_time = merged.text, merged.tracks, merged.notes, merged.step_time
    elif out is not None:
        texts[Path(out)] = scenario_text(tracks, layout)
    if suite is not None:
        name = Path(suite).stem
        made = suite_text(recording, places, rate, window, layout, episodes, name)
        texts[Path(suite)] = made.text
    for target, text in texts.items():
        write_new(target, text, overwrite=overwrite or itself)
    notes += _remarks(recording, tracks, left_out, step_time, made, None if fps is not None else rate)
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
        into=None if scene is None else str(scene),
    )


def _check_options(layout: Layout, episodes: Episodes, **numbers: float | None) -> None:
    """Refuse options outside of their bounds, before anything is read."""
    check_positive(**numbers, length=episodes.length, step_time=layout.step_time, radius=layout.radius)
    check_positive(windows=episodes.windows)
    if episodes.windows > MAX_SCENARIOS:
        what = f"a suite has at most {MAX_SCENARIOS} windows, got {episodes.windows}"
        raise ArgumentError(what, "give fewer windows")
    if not 0 <= layout.margin <= _LARGEST:
        raise ArgumentError(f"margin must be 0 or more, got {layout.margin}", "give a margin in metres, such as 1")
    if layout.robot and BEHAVIORS.get(layout.behavior) is None:
        known = BEHAVIORS.names()
        fix = suggestion(layout.behavior, known, f"choose from {', '.join(known)}")
        raise ArgumentError(f"{clean(layout.behavior)!r} is not a behavior", fix)


def _check_coordinates(
    window: Window, layout: Layout, placing: Placing, image_size: tuple[float, float] | None
) -> None:
    """Refuse times, angles and coordinates that no world has."""
    values = {
        "from": (window.start,),
        "to": () if window.end == math.inf else (window.end,),
        "crop": window.box,
        "robot-start": layout.start,
        "robot-goal": layout.goal,
        "rotate": (placing.rotate,),
        "offset": placing.offset,
        "image-size": image_size,
    }
    for name, given in values.items():
        for value in given or ():
            if not abs(value) <= _LARGEST:
                raise ArgumentError(f"--{name} cannot be {value}", f"give numbers up to {_LARGEST:g}, or leave it out")


def _remarks(
    recording: Recording,
    tracks: list[Track],
    left_out: int,
    step_time: float,
    made: SuiteText | None,
    rate: float | None,
) -> list[str]:
    """Notes for the user about a recording; ``rate`` is given if it was assumed."""
    notes = []
    if made is not None and not made.whole:
        notes.append(f"the recording ends before the only window of the suite, which is {made.length:g} s long")
    if rate is not None and recording.format != "vsp":
        notes.append(f"{rate:g} frames per second are assumed, so that 0.4 s are between rows; --fps says otherwise")
    if recording.unknown:
        notes.append(f"{recording.unknown} rows without a place (?) were left out")
    if left_out:
        notes.append(f"{left_out} with a single row in the window were left out")
    longest, name = max((float(np.diff(track.times).max()), track.name) for track in tracks)
    if recording.format != "vsp" and longest > _GAP:
        notes.append(f"{name} has no row for {longest:g} s, and goes on between those before and after it")
    if _between_steps(tracks, step_time):
        notes.append("recorded times lie between steps: at the ends of steps, places are interpolated")
    return notes


def _between_steps(tracks: list[Track], step_time: float) -> bool:
    """Whether a recorded time is not at the end of a step."""
    steps = np.concatenate([track.times for track in tracks]) / step_time
    return bool(np.abs(steps - np.round(steps)).max() > _ON_STEP)
