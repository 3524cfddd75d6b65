"""Writes MP4 and other videos with ffmpeg: the program that the package imageio-ffmpeg includes, or one on the path."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import BinaryIO, cast

from irsim.common.extras import ExtraError
from irsim.graphics.encoding.pixels import Pixels, even

__all__ = ["VIDEO_OPTIONS", "VideoWriter"]

VIDEO_OPTIONS = ("codec", "quality", "bitrate", "pixelformat", "input_params", "output_params")
"""Options of the encoder besides ``fps``."""

_CODECS = {".webm": "libvpx-vp9", ".avi": "mpeg4"}
_FASTSTART_SUFFIXES = (".mp4", ".m4v", ".mov")
"""Formats whose index is moved to the start of the file, so that playing can begin during a download."""
_DEFAULT_QUALITY = 7.0
MAX_CRF = 51
"""Constant rate factor (H.264, H.265, VP9) of the lowest quality."""
MAX_QSCALE = 31
"""Quantizer scale (other codecs) of the lowest quality."""
_ENCODER_TIMEOUT_S = 120


class VideoWriter:
    """Streams frames to an encoder; call ``close`` at the end.

    Args:
        path: File to write; its suffix chooses the format.
        fps: Frames per second.
        codec: Codec of ffmpeg; default: H.264, VP9 for webm, MPEG-4 for avi.
        quality: Quality from 0 (lowest) to 10.
        bitrate: Bits per second in the notation of ffmpeg (``2M``); replaces ``quality``.
        pixelformat: Pixel format of the video.
        input_params, output_params: Additional ffmpeg arguments, before and after its input.

    Raises:
        ExtraError: There is no ffmpeg.
    """

    def __init__(
        self,
        path: Path,
        *,
        fps: float = 10,
        codec: str | None = None,
        quality: float = _DEFAULT_QUALITY,
        bitrate: str | int | None = None,
        pixelformat: str = "yuv420p",
        input_params: Sequence[str] = (),
        output_params: Sequence[str] = (),
    ) -> None:
        suffix = path.suffix.lower()
        codec = codec or _CODECS.get(suffix, "libx264")
        rate = ["-b:v", str(bitrate)] if bitrate is not None else _quality_arguments(codec, quality)
        start = ["-movflags", "+faststart"] if suffix in _FASTSTART_SUFFIXES else []
        self._ffmpeg = _ffmpeg(suffix)
        self._before = ["-r", f"{fps:g}", *input_params]
        self._after = ["-an", "-c:v", codec, "-pix_fmt", pixelformat, *rate, *start, *output_params, "-y", str(path)]
        self._process: subprocess.Popen[bytes] | None = None
        self._messages = cast(BinaryIO, tempfile.TemporaryFile())  # noqa: SIM115 (closed with the writer)
        self.frames = 0

    def add(self, pixels: Pixels) -> None:
        """Append a frame; all frames must have the size of the first.

        Raises:
            RuntimeError: The encoder failed.
        """
        frame = even(pixels)
        if self._process is None:
            self._process = self._start(frame.shape[1], frame.shape[0])
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(frame.tobytes())
        except OSError:
            self._process.wait(_ENCODER_TIMEOUT_S)
            raise self._failure() from None
        self.frames += 1

    def close(self, last_duration: float = 0.0) -> None:
        """Finish the file; ``last_duration`` is ignored, because all frames of a video last equally long.

        Raises:
            RuntimeError: The encoder failed.
        """
        process = self._process
        if process is not None and process.stdin is not None:
            self._process = None
            with suppress(OSError):  # the encoder has already ended; its exit status is checked below
                process.stdin.close()
            if process.wait(_ENCODER_TIMEOUT_S) != 0:
                raise self._failure()
        self._messages.close()

    def abandon(self) -> None:
        """Stop the encoder; the file stays incomplete."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None
        self._messages.close()

    def _start(self, width: int, height: int) -> subprocess.Popen[bytes]:
        source = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{width}x{height}", *self._before, "-i", "-"]
        command = [self._ffmpeg, "-hide_banner", "-loglevel", "error", *source, *self._after]
        return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=self._messages)

    def _failure(self) -> RuntimeError:
        self._messages.seek(0)
        message = self._messages.read().decode(errors="replace").strip()
        return RuntimeError(f"the video encoder failed: {message or 'ffmpeg gave no reason'}")


def _ffmpeg(suffix: str) -> str:
    """The program of the package imageio-ffmpeg, or else one on the path.

    Raises:
        ExtraError: There is neither.
    """
    if find_spec("imageio_ffmpeg") is not None:
        from imageio_ffmpeg import get_ffmpeg_exe  # type: ignore[import-untyped]

        return str(get_ffmpeg_exe())
    program = shutil.which("ffmpeg")
    if program is None:
        fix = "install the extra: pip install 'irsim-mcp[video]'; or write a .gif, which needs no encoder"
        raise ExtraError("missing-extra", f"videos such as {suffix} need ffmpeg, which is not installed", fix)
    return program


def _quality_arguments(codec: str, quality: float) -> list[str]:
    share = 1 - min(max(float(quality), 0.0), 10.0) / 10
    if codec in ("libx264", "libx265", "libvpx-vp9"):
        constant = ["-b:v", "0"] if codec == "libvpx-vp9" else []
        return ["-crf", str(round(share * MAX_CRF)), *constant]
    return ["-qscale:v", str(max(1, round(share * MAX_QSCALE)))]
