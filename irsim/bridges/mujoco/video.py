"""Videos of MuJoCo's scene, drawn without a window."""

from __future__ import annotations

import ctypes.util
import os
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.mujoco.mjcf import body_name
from irsim.bridges.mujoco.physics import Physics
from irsim.components.bridges.mujoco import Mujoco
from irsim.graphics.encoding.animation import ANIMATION_SUFFIXES, AnimationOptions, write_frames

if TYPE_CHECKING:
    import mujoco

__all__ = ["Film", "prepare_display"]

_MAX_FPS = 50.0


def prepare_display() -> None:
    """Choose how MuJoCo draws, before it is imported: without a window on Linux, unless the user has chosen."""
    if sys.platform != "linux" or os.environ.get("MUJOCO_GL") or "mujoco" in sys.modules:
        return
    for library, name in (("EGL", "egl"), ("OSMesa", "osmesa")):
        if ctypes.util.find_library(library):
            os.environ["MUJOCO_GL"] = name
            return


class Film:
    """Draws frames and writes them as a video.

    Args:
        physics: The model and its state.
        options: File, camera and size.
        step_time: Time between two frames [s].

    Raises:
        BridgeError: The file has a suffix that videos do not have, or MuJoCo cannot draw here.
    """

    def __init__(self, physics: Physics, options: Mujoco, step_time: float) -> None:
        assert options.video is not None
        self._target, self._stack = Path(options.video), ExitStack()
        if self._target.suffix.lower() not in ANIMATION_SUFFIXES:
            what = f"video: files of videos are {', '.join(ANIMATION_SUFFIXES)}; got {options.video!r}"
            raise BridgeError("bridge-mismatch", what, "video: run.mp4")
        self._physics, self._options = physics, options
        scene = physics.scene
        named = options.camera in scene.names and options.camera not in ("top", "corner")
        self._camera = f"{body_name(scene.agent(options.camera))}/camera" if named else options.camera
        self._renderer = self._drawer(options)
        fps = min(1 / step_time, _MAX_FPS)
        self._every = max(1, round(1 / step_time / fps))
        self._count = 0
        try:
            self._writer = self._stack.enter_context(write_frames(self._target, AnimationOptions(fps=fps)))
        except BaseException:
            self._renderer.close()
            raise

    def _drawer(self, options: Mujoco) -> mujoco.Renderer:
        import mujoco

        try:
            return mujoco.Renderer(self._physics.model, height=options.size[1], width=options.size[0])
        except Exception as error:
            what = f"MuJoCo cannot draw here: {error}"
            fix = "install libegl1 or libosmesa6 and set the environment variable MUJOCO_GL to egl or osmesa"
            raise BridgeError("bridge-failed", what, f"{fix}, or leave out video") from error

    def follow(self, physics: Physics) -> None:
        """Draw another model from now on."""
        self._renderer.close()
        self._physics = physics
        self._renderer = self._drawer(self._options)

    def take(self) -> None:
        """Add a frame of the present state."""
        if self._count % self._every == 0:
            import mujoco

            mujoco.mj_forward(self._physics.model, self._physics.data)
            self._renderer.update_scene(self._physics.data, camera=self._camera)
            pixels = self._renderer.render()
            opaque = np.full((*pixels.shape[:2], 1), 255, np.uint8)
            self._writer.add(np.concatenate([pixels, opaque], axis=2))
        self._count += 1

    def save(self) -> None:
        """Finish the file, which appears only now."""
        self._stack.close()

    def free(self) -> None:
        """Free what MuJoCo draws with; a second call does nothing."""
        self._renderer.close()
