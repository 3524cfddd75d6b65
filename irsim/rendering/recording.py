"""The animation of an environment: frames are stored while it runs and written when it ends."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from irsim.common.files import replacing
from irsim.graphics.encoding.animation import AnimationOptions, FrameBuffer, check_suffix
from irsim.graphics.encoding.pixels import Pixels
from irsim.graphics.encoding.png import png_bytes
from irsim.graphics.encoding.video import VIDEO_OPTIONS

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Pictured", "Recording"]

_FILE_OPTIONS = ("ani_name", "suffix", "rm_fig_path")
"""Options of the files rather than of playback or encoder."""


class Pictured(Protocol):
    """The part of an environment that drawing reads.

    ``path_param`` has the folders ``fig_path``, ``ani_path`` and ``ani_buffer_path``, ``logger`` has ``info`` and
    ``warning``, and ``ani_kwargs`` holds the default options of the animation.
    """

    path_param: Any
    logger: Any
    ani_kwargs: dict[str, Any]

    @property
    def simulation(self) -> Simulation:
        """The simulation, with state and scenario."""

    @property
    def status(self) -> str:
        """Status word, shown in the title."""


class Recording:
    """Stored frames of one environment.

    Attributes:
        crop: Box (left, top, right, bottom) that all frames are cut to [px]; None before the first frame.
        frames_written: Number of frames of the last saved animation.
    """

    def __init__(self, env: Pictured) -> None:
        self.env = env
        self.crop: tuple[int, int, int, int] | None = None
        self.frames_written = 0
        self._buffer: FrameBuffer | None = None

    @property
    def last_count(self) -> int | None:
        """Step number of the last stored frame, or None."""
        return self._buffer.counts[-1] if self._buffer is not None and self._buffer.counts else None

    def add(
        self,
        pixels: Pixels,
        colors: Callable[[], list[tuple[int, int, int]]],
        changed: Sequence[tuple[int, int, int, int]] | None = None,
    ) -> None:
        """Store a frame.

        Args:
            pixels: The frame.
            colors: Returns the (r, g, b) colours that a GIF must reproduce exactly; called for the first frame only.
            changed: Boxes (left, top, right, bottom) [px] outside of which the frame is as the one before; None if that
                is not known.
        """
        if self._buffer is None:
            defaults = self.env.ani_kwargs
            indexed = str(defaults.get("suffix", ".gif")).lower() == ".gif" and bool(defaults.get("rm_fig_path", True))
            play, _ = _animation_options(defaults)
            self._buffer = FrameBuffer(play, indexed=indexed, colors=colors())
        self._buffer.add(pixels, int(self.env.simulation.count[0]), changed)

    def save(
        self,
        path: str | Path | None = None,
        *,
        ani_name: str | None = None,
        suffix: str = ".gif",
        rm_fig_path: bool = True,
        **options: Any,
    ) -> Path | None:
        """Write the animation and drop the frames.

        Args:
            path: File to write; default ``<ani_path>/<ani_name><suffix>``.
            ani_name: File name; default ``animation_<world>``.
            suffix: ``.gif``, ``.apng``, ``.png`` or a video's: ``.mp4``, ``.webm``, …
            rm_fig_path: False also writes each frame as a PNG file to ``ani_buffer_path``.
            **options: ``fps`` (default 10), ``last_frame_duration`` (default 1 s), ``loop`` (default 0: without end)
                and the options of the video encoder.

        Returns:
            Path of the file; None, with a warning, if no frames are stored.

        Raises:
            ValueError: The suffix is not supported.
            RuntimeError: The video encoder failed.
        """
        paths, name = self.env.path_param, self.env.simulation.scenario.name
        if path is None:
            path = Path(paths.ani_path) / f"{ani_name or f'animation_{name}'}{suffix}"
        path = Path(path)
        check_suffix(path.suffix)
        play, unknown = _animation_options(options)
        if unknown:
            self.env.logger.warning(f"unknown options of the animation are ignored: {', '.join(unknown)}")
        buffer = self._buffer
        if buffer is None or not buffer.frames:
            self.env.logger.warning("no animation is saved, because no frames were stored")
            return None
        buffer.save(path, play)
        if not rm_fig_path:
            for count, pixels in zip(buffer.counts, buffer.read(), strict=True):
                with replacing(Path(paths.ani_buffer_path) / f"{name}_{count:04d}.png") as temporary:
                    temporary.write_bytes(png_bytes(pixels))
        self.frames_written = buffer.frames
        self.forget()
        self.env.logger.info(f"animation saved: {path}")
        return path

    def forget(self) -> None:
        """Drop the frames."""
        if self._buffer is not None:
            self._buffer.close()
        self._buffer = None
        self.crop = None


def _animation_options(options: Mapping[str, Any]) -> tuple[AnimationOptions, list[str]]:
    """Return the playback options, and the names of unknown options."""
    known = {key: options[key] for key in ("fps", "last_frame_duration", "loop") if options.get(key) is not None}
    video = {key: options[key] for key in VIDEO_OPTIONS if key in options}
    unknown = [key for key in options if key not in known and key not in video and key not in _FILE_OPTIONS]
    return AnimationOptions(**known, video=video), unknown
