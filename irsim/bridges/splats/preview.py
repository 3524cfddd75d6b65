"""Pictures and films of a recorded run among splats, made on the CPU."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from pydantic import Field

from irsim.bridges.base import BridgeError
from irsim.bridges.export.cameras import CameraFrame, CameraOptions
from irsim.bridges.frames import CAMERA_AXES, camera_pose, inverse
from irsim.bridges.splats.reading import read_splats
from irsim.bridges.splats.recording import Recording, body_splats, open_recording, path_splats
from irsim.bridges.splats.render import View, picture
from irsim.bridges.splats.splats import Splats, join_splats, moved
from irsim.common.arrays import Floats
from irsim.common.files import check_suffix, code_of, replacing
from irsim.common.text import clean
from irsim.graphics.encoding.animation import AnimationOptions, write_frames
from irsim.graphics.encoding.picture_files import MOVING_SUFFIXES
from irsim.graphics.encoding.pixels import from_image
from irsim.options.units import Count, Hertz, Meters
from irsim.runs.files import RunError
from irsim.runs.reading import Run
from irsim.scenario.limits import Limits

__all__ = ["PreviewFile", "PreviewOptions", "write_preview"]

SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", *MOVING_SUFFIXES)
_KEY_FRAMES = 6
_COLUMNS, _GAP_PX, _LINE_PX = 3, 8, 20
_CLOSE_M = 2.6
"""Distance from the eye behind a robot [m]; closer splats would hide the robot and are not drawn."""


class PreviewOptions(CameraOptions):
    """Size and view of a picture or film of a run among splats."""

    width: Annotated[Count, Field(ge=16, le=4096)] = 480
    """Pixels of a picture from left to right."""
    rows: Annotated[Count, Field(ge=16, le=4096)] = 320
    """Pixels of a picture from top to bottom."""
    view: Literal["robot", "behind", "above"] = "behind"
    """Where the eye is: on the robot, behind it, or above the whole run."""
    cut: Annotated[Meters, Field(gt=0)] = 1.9
    """Splats above this height are left out, so that no ceiling hides the robot; not in the view of the robot."""
    fps: Annotated[Hertz, Field(gt=0, le=100)] = 10.0
    """Pictures of a film in a second."""


@dataclass(frozen=True)
class PreviewFile:
    """A picture or film that was written.

    Attributes:
        file: Its path.
        frames: Number of pictures in it.
        splats: Number of splats of the scene.
        steps: First and last step that it shows.
        notes: Remarks for the user.
    """

    file: str
    frames: int
    splats: int
    steps: tuple[int, int]
    notes: list[str]

    def as_dict(self) -> dict[str, Any]:
        """The result as JSON types."""
        return dict(self.__dict__)


def write_preview(
    splats: str | Path,
    run: str | Path | Run,
    out: str | Path,
    *,
    options: PreviewOptions | None = None,
    robot: str | None = None,
    step: int | None = None,
    workspace: str | Path | None = None,
    limits: Limits | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> PreviewFile:
    """Write a picture or a film of a run among splats.

    A picture (``.png``, ``.jpg``, ``.webp``) has one step if one is given, else six steps of the run beside each other;
    a film (``.gif``, ``.apng``, ``.mp4`` …) has every step, or every so many.

    Args:
        splats: The ``.ply`` file of the scene.
        run: Id of the run, its folder, or ``last``.
        out: File to write; an existing one is replaced.
        options: Its size and view.
        robot: Name of the robot that the eye follows; default: the first one.
        step: The step of a single picture.
        workspace: Folder whose ``.irsim/runs`` holds the run.
        limits: Limits of the reader of the scenario.
        progress: Callback ``(frames_done, frames_total)``.

    Raises:
        BridgeError: The file of splats or the sidecar cannot be used, or there is no such robot.
        RunError: There is no such run or step, or the file cannot be written.
        TargetError: The file has an unsupported suffix.
    """
    target, chosen = Path(out), options or PreviewOptions()
    check_suffix(target, SUFFIXES)
    moving = target.suffix.lower() in MOVING_SUFFIXES
    recording = open_recording(run, chosen, every=1, workspace=workspace, limits=limits)
    rows = _rows(recording, moving, chosen.every, step)
    carrier = recording.index_of(robot)
    scene = read_splats(splats, harmonics=True)
    cinema = _Cinema(scene, recording, carrier, chosen)

    def frames() -> Iterator[tuple[int, NDArray[np.uint8]]]:
        for done, row in enumerate(rows):
            yield row, cinema.frame(row)
            progress(done + 1, len(rows))

    try:
        if moving:
            with write_frames(target, AnimationOptions(fps=chosen.fps)) as film:
                for _, pixels in frames():
                    film.add(from_image(Image.fromarray(pixels)))
        elif step is not None:
            [(_, pixels)] = frames()
            with replacing(target) as temporary:
                Image.fromarray(pixels).save(temporary)
        else:
            cells = [(f"t = {recording.time[row]:.1f} s", pixels) for row, pixels in frames()]
            _write_sheet(cells, target)
    except OSError as error:
        what = f"'{clean(target, 200)}' cannot be written: {error.strerror or error}"
        raise RunError(code_of(error), what, "name another file with -o") from None
    shown = (int(recording.step[rows[0]]), int(recording.step[rows[-1]]))
    return PreviewFile(str(target), len(rows), len(scene), shown, list(recording.world.notes))


def _rows(recording: Recording, moving: bool, every: int, step: int | None) -> list[int]:
    """The rows of the recording that are shown."""
    last = len(recording.step) - 1
    if step is not None:
        if moving or not 0 <= step <= last:
            what = "a film has no single step" if moving else f"there is no step {step}; {recording.run.extent}"
            raise RunError("bad-argument", what, "give another step, or leave it out", where="step")
        return [step]
    if moving:
        return list(range(0, last + 1, every))
    return sorted({round(last * number / (_KEY_FRAMES - 1)) for number in range(_KEY_FRAMES)})


@dataclass(frozen=True)
class _Cinema:
    """Draws the frames."""

    scene: Splats
    recording: Recording
    carrier: int
    options: PreviewOptions

    def frame(self, row: int) -> NDArray[np.uint8]:
        """(rows, width, 3) the picture of one step."""
        recording, options = self.recording, self.options
        eye, focal = self._eye(row), options.focal
        added = []
        for number, body in enumerate(recording.bodies):
            pose = recording.pose[row, number]
            own = number == self.carrier and options.view == "robot"
            if np.isfinite(pose).all() and not own:
                added.append(body_splats(body, pose))
            if body.role == "robot":
                added.append(path_splats(recording.pose[:, number, :2], body.color))
        world = recording.world
        shown = join_splats([self._visible(eye), *(moved(part, world.transform) for part in added)])
        return picture(shown, View(_in_scene(eye, world), options.width, options.rows, focal))

    def _eye(self, row: int) -> Floats:
        """(4, 4) camera-to-world matrix in the frame of irsim."""
        pose, options = self.recording.pose[row, self.carrier], self.options
        if not np.isfinite(pose).all():
            what = f"robot {self.recording.bodies[self.carrier].name} is not in the world at step {row}"
            raise BridgeError("bridge-mismatch", what, "choose another robot or step")
        if options.view == "robot":
            return camera_pose(pose, "colmap", options.height)
        if options.view == "behind":
            ahead = np.array([math.cos(pose[2]), math.sin(pose[2])])
            place = np.array([*(pose[:2] - 2.5 * ahead), options.height + 1.2])
            return _looking(place, np.array([*(pose[:2] + ahead), 0.4]))
        points = self.recording.pose[:, self.carrier, :2]
        low, high = np.nanmin(points, axis=0) - 1.5, np.nanmax(points, axis=0) + 1.5
        middle, size = (low + high) / 2, high - low
        height = options.focal * max(size[0] / options.width, size[1] / options.rows)
        result = np.eye(4)
        result[:3, :3] = np.diag([1.0, -1.0, -1.0])
        result[:3, 3] = [*middle, height]
        return result

    def _visible(self, eye: Floats) -> Splats:
        """The splats of the scene that do not hide the robot or, from above, the run."""
        if self.options.view == "robot":
            return self.scene
        to_irsim = inverse(self.recording.world.transform)
        height = self.scene.center @ to_irsim[2, :3] + to_irsim[2, 3]
        kept = height <= self.options.cut
        if self.options.view == "behind":
            to_eye = inverse(eye) @ to_irsim
            kept &= self.scene.center @ to_eye[2, :3] + to_eye[2, 3] >= _CLOSE_M
        return self.scene.take(kept)


def _looking(place: Floats, target: Floats) -> Floats:
    """(4, 4) camera-to-world matrix of a camera that looks from a point to another one, frame of irsim."""
    forward = (target - place) / np.linalg.norm(target - place)
    left = np.cross([0.0, 0.0, 1.0], forward)
    left /= np.linalg.norm(left)
    result = np.eye(4)
    result[:3, :3] = np.column_stack([forward, left, np.cross(forward, left)]) @ CAMERA_AXES["colmap"]
    result[:3, 3] = place
    return result


def _in_scene(matrix: Floats, world: CameraFrame) -> Floats:
    """A camera of irsim in the frame of the scene, as a rigid matrix."""
    result: Floats = world.transform @ matrix
    result[:3, :3] /= world.scale
    return result


def _write_sheet(cells: list[tuple[str, NDArray[np.uint8]]], target: Path) -> None:
    """Write pictures beside each other, each with a line of text below it."""
    rows, width = cells[0][1].shape[:2]
    columns = min(_COLUMNS, len(cells))
    lines = -(-len(cells) // columns)
    step = (width + _GAP_PX, rows + _LINE_PX + _GAP_PX)
    sheet = Image.new("RGB", (columns * step[0] + _GAP_PX, lines * step[1] + _GAP_PX), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(14)
    for number, (text, pixels) in enumerate(cells):
        left, top = (
            _GAP_PX + part * size for part, size in zip((number % columns, number // columns), step, strict=True)
        )
        sheet.paste(Image.fromarray(pixels), (left, top))
        draw.text((left + 2, top + rows + 1), text, fill="black", font=font)
    with replacing(target) as temporary:
        sheet.save(temporary)
