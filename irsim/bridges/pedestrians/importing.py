"""``irsim bridge import-pedestrians``: a file of recorded pedestrians becomes a scenario."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.rows import FormatName, read_homography, read_recording
from irsim.bridges.pedestrians.scenario import Layout, scenario_text
from irsim.bridges.pedestrians.tracks import Window, frame_rate, make_tracks, pixels_to_metres
from irsim.common.files import write_new
from irsim.diagnostics.errors import ArgumentError

__all__ = ["ImportedPedestrians", "import_pedestrians"]

_GAP = 2.0
"""Time without a row that is worth a note [s]; splines have long ones."""
_ON_STEP = 1e-6
"""Steps by which a recorded time may miss the end of a step."""


@dataclass(frozen=True)
class ImportedPedestrians:
    """What was written.

    Attributes:
        file: The scenario.
        format: Format of the recording.
        pedestrians: Number of obstacles that are replayed.
        rows: Number of recorded places.
        duration: Time of the last one [s].
        fps: Frames per second that times were computed with.
        notes: What is worth knowing.
    """

    file: str
    format: str
    pedestrians: int
    rows: int
    duration: float
    fps: float
    notes: list[str] = field(default_factory=list)


def import_pedestrians(
    path: str | Path,
    out: str | Path,
    *,
    form: FormatName | None = None,
    fps: float | None = None,
    window: Window | None = None,
    homography: str | Path | None = None,
    scale: float | None = None,
    image_size: tuple[float, float] | None = None,
    layout: Layout | None = None,
    overwrite: bool = False,
) -> ImportedPedestrians:
    """Write a scenario in which recorded pedestrians walk as they did.

    Args:
        path: ETH's ``obsmat.txt``, UCY's ``.vsp``, or lines ``frame id x y``.
        out: The scenario to write.
        form: Format of the file; default: as suffix and columns say.
        fps: Frames per second; default: 25 for ``vsp``, else such that the usual step between frames takes 0.4 s.
        window: What is kept.
        homography: File with a 3 x 3 matrix from pixels to metres; for files in pixels.
        scale: Metres of a pixel, instead of a homography.
        image_size: Width and height of the picture, if the homography counts pixels from its upper left corner.
        layout: Robot, sizes, step time.
        overwrite: Replace a file that exists.

    Raises:
        BridgeError: The file cannot be used, or nobody is in the window. Nothing is written then.
        ArgumentError: An option does not fit the file.
        TargetError: The scenario exists.
    """
    path, window = Path(path), window or Window()
    layout = layout or Layout(path.name)
    for name, value in (("fps", fps), ("scale", scale), ("step_time", layout.step_time), ("radius", layout.radius)):
        if value is not None and not (math.isfinite(value) and value > 0):
            raise ArgumentError(f"{name} must be a positive number, got {value}", f"give a {name} above 0")
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
        what = f"nobody is in {path.name} for two rows, in this window of time and space"
        raise BridgeError("bridge-file", what, "widen --from, --to and --crop; times count from the first frame")
    text = scenario_text(tracks, layout)
    write_new(Path(out), text, overwrite=overwrite)
    notes = []
    if fps is None and recording.format != "vsp":
        notes.append(f"{rate:g} frames per second are assumed, so that 0.4 s are between rows; --fps says otherwise")
    if left_out:
        notes.append(f"{left_out} with a single row in the window were left out")
    longest, name = max((float(np.diff(track.times).max()), track.name) for track in tracks)
    if recording.format != "vsp" and longest > _GAP:
        notes.append(f"{name} has no row for {longest:g} s, and goes on between those before and after it")
    steps = np.concatenate([track.times for track in tracks]) / layout.step_time
    if np.abs(steps - np.round(steps)).max() > _ON_STEP:
        notes.append("recorded times lie between steps: at the ends of steps, places are interpolated")
    rows = sum(len(track.times) for track in tracks)
    duration = max(float(track.times[-1]) for track in tracks)
    return ImportedPedestrians(str(out), recording.format, len(tracks), rows, duration, rate, notes)
