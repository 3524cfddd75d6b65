"""MP4 and other videos through ffmpeg (the program that comes with imageio-ffmpeg)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from irsim.render.pixels import Pixels, even

__all__ = ["VIDEO_OPTIONS", "VIDEO_SUFFIXES", "VideoWriter"]

VIDEO_SUFFIXES = (".mp4", ".m4v", ".mov", ".mkv", ".webm", ".avi")
VIDEO_OPTIONS = (
    "codec",
    "quality",
    "bitrate",
    "pixelformat",
    "macro_block_size",
    "input_params",
    "output_params",
    "ffmpeg_log_level",
    "ffmpeg_timeout",
    "audio_path",
    "audio_codec",
)
"""Options of the encoder that ``env.end(…)`` passes on."""

_CODECS = {".webm": "libvpx-vp9", ".avi": "mpeg4"}
_START_FAST = ["-movflags", "+faststart"]


class VideoWriter:
    """Streams frames to an encoder.

    Args:
        path: File to write; its suffix chooses the format.
        fps: Frames per second.
        **options: See :data:`VIDEO_OPTIONS`.
    """

    def __init__(self, path: Path, *, fps: float = 10, **options: Any) -> None:
        self._path, self._fps, self._options = path, fps, options
        self._sink: Any = None
        self.frames = 0

    def add(self, pixels: Pixels) -> None:
        """Append a frame; all have the size of the first.

        Raises:
            RuntimeError: The encoder gave up.
        """
        frame = even(pixels)
        if self._sink is None:
            self._sink = self._start(frame.shape[1], frame.shape[0])
        try:
            self._sink.send(frame)
        except OSError as error:
            raise RuntimeError(f"the video encoder failed: {error}") from error
        self.frames += 1

    def close(self, last_duration: float) -> None:
        """Finish the file; all frames of a video last equally long."""
        if self._sink is not None:
            self._sink.close()
            self._sink = None

    def _start(self, width: int, height: int) -> Any:
        import imageio_ffmpeg  # type: ignore[import-untyped]

        options = dict(self._options)
        suffix = self._path.suffix.lower()
        if "pixelformat" in options:
            options["pix_fmt_out"] = options.pop("pixelformat")
        if suffix in _CODECS:
            options.setdefault("codec", _CODECS[suffix])
        if suffix in (".mp4", ".m4v", ".mov"):
            options["output_params"] = [*_START_FAST, *options.get("output_params", [])]
        options.setdefault("macro_block_size", 1)
        sink = imageio_ffmpeg.write_frames(
            str(self._path), (width, height), pix_fmt_in="rgba", fps=self._fps, **options
        )
        sink.send(None)
        return sink
