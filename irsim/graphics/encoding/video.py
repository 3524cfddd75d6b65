"""MP4 and other videos through ffmpeg (the program that comes with imageio-ffmpeg)."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO, cast

from irsim.graphics.encoding.pixels import Pixels, even

__all__ = ["VIDEO_OPTIONS", "VIDEO_SUFFIXES", "VideoWriter"]

VIDEO_SUFFIXES = (".mp4", ".m4v", ".mov", ".mkv", ".webm", ".avi")
VIDEO_OPTIONS = ("codec", "quality", "bitrate", "pixelformat", "input_params", "output_params")
"""Options of the encoder, beside ``fps``."""

_CODECS = {".webm": "libvpx-vp9", ".avi": "mpeg4"}
_STREAMED = (".mp4", ".m4v", ".mov")
_QUALITY = 7.0
_WORST_CRF, _WORST_SCALE = 51, 31
_SECONDS_TO_FINISH = 120


class VideoWriter:
    """Streams frames to an encoder; use as a context, or ``close``.

    Args:
        path: File to write; its suffix chooses the format.
        fps: Frames per second.
        codec: Of ffmpeg; default: H.264, VP9 for webm, MPEG-4 for avi.
        quality: 0 to 10.
        bitrate: Bits per second, as ffmpeg writes them (``2M``); instead of ``quality``.
        pixelformat: Of the video.
        input_params, output_params: More arguments of ffmpeg, before and after its input.
    """

    def __init__(
        self,
        path: Path,
        *,
        fps: float = 10,
        codec: str | None = None,
        quality: float = _QUALITY,
        bitrate: str | int | None = None,
        pixelformat: str = "yuv420p",
        input_params: Sequence[str] = (),
        output_params: Sequence[str] = (),
    ) -> None:
        suffix = path.suffix.lower()
        codec = codec or _CODECS.get(suffix, "libx264")
        rate = ["-b:v", str(bitrate)] if bitrate is not None else _quality(codec, quality)
        start = ["-movflags", "+faststart"] if suffix in _STREAMED else []
        self._before = ["-r", f"{fps:g}", *input_params]
        self._after = ["-an", "-c:v", codec, "-pix_fmt", pixelformat, *rate, *start, *output_params, "-y", str(path)]
        self._process: subprocess.Popen[bytes] | None = None
        self._messages = cast(BinaryIO, tempfile.TemporaryFile())  # noqa: SIM115 (closed with the writer)
        self.frames = 0

    def add(self, pixels: Pixels) -> None:
        """Append a frame; all have the size of the first.

        Raises:
            RuntimeError: The encoder gave up.
        """
        frame = even(pixels)
        if self._process is None:
            self._process = self._start(frame.shape[1], frame.shape[0])
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(frame.tobytes())
        except OSError:
            self._process.wait(_SECONDS_TO_FINISH)
            raise self._failure() from None
        self.frames += 1

    def close(self, last_duration: float = 0.0) -> None:
        """Finish the file; all frames of a video last equally long.

        Raises:
            RuntimeError: The encoder gave up.
        """
        process = self._process
        if process is not None and process.stdin is not None:
            self._process = None
            with suppress(OSError):  # it has ended already, and says why
                process.stdin.close()
            if process.wait(_SECONDS_TO_FINISH) != 0:
                raise self._failure()
        self._messages.close()

    def abandon(self) -> None:
        """Stop the encoder; the file is of no use."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None
        self._messages.close()

    def _start(self, width: int, height: int) -> subprocess.Popen[bytes]:
        from imageio_ffmpeg import get_ffmpeg_exe  # type: ignore[import-untyped]

        source = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{width}x{height}", *self._before, "-i", "-"]
        command = [get_ffmpeg_exe(), "-hide_banner", "-loglevel", "error", *source, *self._after]
        return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=self._messages)

    def _failure(self) -> RuntimeError:
        self._messages.seek(0)
        said = self._messages.read().decode(errors="replace").strip()
        return RuntimeError(f"the video encoder failed: {said or 'ffmpeg gave no reason'}")


def _quality(codec: str, quality: float) -> list[str]:
    share = 1 - min(max(float(quality), 0.0), 10.0) / 10
    if codec in ("libx264", "libx265", "libvpx-vp9"):
        constant = ["-b:v", "0"] if codec == "libvpx-vp9" else []
        return ["-crf", str(round(share * _WORST_CRF)), *constant]
    return ["-qscale:v", str(max(1, round(share * _WORST_SCALE)))]
